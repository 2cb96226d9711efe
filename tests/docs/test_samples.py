"""What the README and the documentation show is what happens."""

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest

from rulec import compile_rulebook
from rulec.automata.bundle.bundle_file import to_json
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.monitoring.uncertainty.known_words import run
from rulec.rulebook.loader import parse_rulebook

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(language):
    for page in PAGES:
        for number, text in enumerate(
            re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)
        ):
            yield pytest.param(text, id=f"{page.name}-{number}")


@pytest.mark.parametrize("text", list(blocks("rulec")))
def test_rulebooks_check(text):
    if re.search(r"^rulebook ", text, re.MULTILINE):
        rulebook = parse_rulebook(text)
        run = run_rulebook_examples(rulebook, compile_rulebook(rulebook))
        assert [one.name for one in run.outcomes if not one.passed] == []


def test_the_run_of_a_compiled_machine_is_as_documented():
    page = (ROOT / "docs" / "compiled.md").read_text()
    names = {}
    exec(re.search(r"```python\n(.*?)```", page, re.DOTALL).group(1), names)
    rules = compile_rulebook("esterle2019")
    for rule, data in zip(rules.rules, json.loads(to_json(rules))["rules"], strict=True):
        machine = data["machine"]
        everything = range(len(machine["letters"]))
        for word in ([a, b, c] for a in everything for b in everything for c in everything):
            classes = [rule.machine.letters[letter] for letter in word]
            assert names["accepts"](machine, word) == run(rule.machine, classes)[0]


def test_the_loop_over_a_recording_goes_past_drives_that_cannot_be_judged(capsys):
    page = (ROOT / "docs" / "for_developers.md").read_text()
    (text,) = [one for one in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "Drive" in one]
    soon = "require always (speed > 3 m/s implies eventually[<= 1 s] speed > 5 m/s)"
    book = parse_rulebook(f"rulebook soon use road hard rule r {{ {soon} }}")
    exec(
        text.replace('"de").', "rules)."), {"rules": compile_rulebook(book, step_s=Fraction(1, 3))}
    )
    said = capsys.readouterr().out.splitlines()
    assert said
    assert all(line.startswith("not judged:") for line in said)


def anchors(text):
    """What GitHub calls the headings of a page, and so does the site."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    for heading in re.findall(r"^#+ (.*)", text, re.MULTILINE):
        yield re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


def test_every_link_between_pages_leads_somewhere(built_parts):
    texts = {page: built_parts.filled(page.read_text()) for page in PAGES}
    places = {page: frozenset(anchors(text)) for page, text in texts.items()}
    for page, text in texts.items():
        for target, place in re.findall(r"\]\((?!https?:)([^)#]*)#?([^)]*)\)", text, re.DOTALL):
            file = (page.parent / target).resolve() if target else page
            assert file.exists(), f"{page.name}: {target}"
            assert not place or place in places[file], f"{page.name}: {target}#{place}"

"""``rulec doc`` as its user meets it."""

import ast
import re
from pathlib import Path
from typing import get_args

import pytest

from rulec.analysis.audit.provision_coverage import ProvisionState
from rulec.analysis.lineage.rule_lineage import ConstantKind
from rulec.cli.main import main
from rulec.report.rulebooks import document_language as language_module
from rulec.report.rulebooks.document_language import document_language
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from support.builders import rulebook_family as island

SOURCES = Path(language_module.__file__).parent
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    island.write(tmp_path)
    return tmp_path


def written(capsys, *arguments):
    status = main(["doc", *arguments])
    captured = capsys.readouterr()
    assert status == 0, captured.err
    return captured.out


def section(page, heading):
    """What stands below a heading, up to the next one of its rank or above."""
    rank = len(heading.split()[0])
    (found,) = re.findall(
        rf"^{re.escape(heading)}\n(.*?)(?=^#{{1,{rank}}} |\Z)", page, re.MULTILINE | re.DOTALL
    )
    return found


@pytest.fixture
def page(folder, capsys):
    return written(capsys, "island.rules", "--format", "markdown", "--at", "2024-06-01")


def test_the_beginning(page):
    assert page.startswith("# Rules of the island\n\n**This is no legal advice.**")
    for row in (
        "| law | Island Act, as of 2024-01-01 |",
        "| shown as of | 2024-06-01 |",
        "| builds upon | `mainland` |",
        "| rules | 3 hard, 1 soft |",
        "| own law | 2 rules; 2 inherited, not confirmed |",
    ):
        assert f"\n{row}\n" in page


def test_a_rule_that_overrides(page):
    rule = section(page, "### Changed (§ 10a)")
    assert rule.startswith("\n> Be slow.\n\n")
    for line in (
        "- **Provision:** § 10a",
        "- **Rule:** `changed`",
        "- **Kind of rule:** hard, it must never be violated",
        "- **Certainty:** ◐ taken from a secondary source",
        "- **Origin:** overrides mainland: cite, source, require",
        # 3 s in steps of 1 s.
        "The states are 1 s apart.",
        "Changed: cite, source and require.",
        '-cite "§ 10"',
        '-source "a book"',
        '+cite "§ 10a"',
        "-require always slow",
        "+require always[<= 3 s] slow",
    ):
        assert f"\n{line}\n" in rule
    assert "```rulec\nrequire always[<= 3 s] slow\n```" in rule
    assert "```rulec\nrequire always[<= 3 s] speed < 20 km/h\n```" in rule
    assert "says" not in section(page, "### Changed (§ 10a)").split("```diff")[1]


def test_ones_own_rules_stand_before_those_that_are_inherited(folder, capsys):
    base = 'rulebook land\nuse road\nhard rule first { cite "1" require never tunnel }\n'
    own = 'rulebook town\nextends land\nlaw "T"\nhard rule second { require never lane_change }\n'
    (folder / "land.rules").write_text(base, encoding="utf-8")
    (folder / "town.rules").write_text(own, encoding="utf-8")
    page = written(capsys, "./town.rules", "--output-format", "markdown")
    assert re.findall(r"^### (\w+)", section(page, "## Rules"), re.MULTILINE) == ["Second"]
    inherited = section(page, "## Rules inherited, not confirmed")
    assert re.findall(r"^### (\w+)", inherited, re.MULTILINE) == ["First"]


def test_its_examples(page):
    rule = section(page, "### Changed (§ 10a)")
    assert "**Example 1: allowed ✔**\n\n| state | 0 |\n| --- | --- |\n| speed, km/h | 20 |" in rule
    assert (
        "**Example 2: forbidden ✘**\n\n| state | 0 |\n| --- | --- |\n| speed, km/h | 40 |" in rule
    )


def test_inherited_and_softened(page):
    kept = section(page, "### Kept (§ 9)")
    assert "\n- **Provision:** § 9 of: Mainland Act; inherited, not confirmed\n" in kept
    assert "\n- **Origin:** inherited from mainland, not confirmed\n" in kept
    assert "\n- **Certainty:** ✔ verified in the law itself; that is mainland's\n" in kept
    # As written and as meant it is the same.
    assert kept.count("```rulec") == 1
    softer = section(page, "### Softer (§ 2)")
    assert "\n- **Kind of rule:** soft, it may yield; weight 2\n" in softer
    assert "\n- **Origin:** softened, not confirmed, because only recommended\n" in softer
    assert "#### Examples\n\nNone.\n" in softer


def test_confirmed(page):
    agreed = section(page, "### Agreed (§ 11, custom)")
    assert "\n- **Provision:** § 11, custom\n" in agreed
    assert "\n- **Certainty:** ✔ verified in the law itself\n" in agreed
    assert "\n- **Origin:** confirms mainland: cite, source, certainty, examples\n" in agreed
    assert '-cite "§ 3"\n' in agreed


def test_the_articles_of_its_law(page):
    articles = section(page, "## Articles of the law")
    assert "Dealt with: 50 % ██████████░░░░░░░░░░ 1 of 2: 1 covered, 0 silent, " in articles
    assert "\n| § 10a | Slowness | covered by changed |\n| § 12 | Fees | to do |\n" in articles


def test_exceptions_are_said_one_by_one(folder, capsys):
    (folder / "excepted.rules").write_text(
        "rulebook excepted\nuse road\n"
        "define passes(v: vehicle, side) =\n"
        "  behind(v) then beside(v) and side(v) then in_front_of(v)\n"
        "hard rule r (v: vehicle) {\n"
        "  require never passes(v, right_of)\n"
        "  unless congested\n"
        "  unless built_up at start\n"
        "}\n"
    )
    rule = section(written(capsys, "excepted.rules", "--format", "markdown"), "### R")
    assert (
        "```rulec\n"
        "require never passes(v, right_of)\n"
        "unless congested\n"
        "unless built_up at start\n"
        "```\n\n"
        "With definitions, options and parameters put in:\n\n"
        "```rulec\n"
        "require never (behind(v) then beside(v) and right_of(v) then in_front_of(v))\n"
        "unless congested throughout\n"
        "unless built_up at start\n"
        "```\n"
    ) in rule


def test_a_definition_is_under_the_head_of_its_own_book(folder, capsys):
    words = "type car\nsignal near(c: car), p default false\n"
    define = "define d(c: car) = near(c)\nhard rule a (c: car) { require never d(c) }\n"
    Path("old.rules").write_text(f"rulebook old\n{words}{define}")
    Path("new.rules").write_text("rulebook new\nextends old\nredefine d(v: car) = near(v) and p\n")
    page = written(capsys, "./new.rules", "--format", "markdown")
    definitions = section(page, "## Definitions")
    assert "`d` is defined by `new`. It was in `old` `d(c: car) = near(c)`.\n" in definitions
    assert "```rulec\ndefine d(v: car) = near(v) and p\n```" in definitions


def test_the_provision_that_a_number_and_a_definition_are_from(folder, capsys):
    words = "quantity speed in km/h default 0\n"
    own = 'param pace : speed = 7 km/h cite "s. 4(2)"  # on foot\n'
    define = 'define slow = speed <= pace cite "s. 4(1)"\nhard rule a { require always slow }\n'
    Path("old.rules").write_text(f"rulebook old\n{words}{own}{define}")
    Path("new.rules").write_text(
        'rulebook new\nextends old\nset pace = 6 km/h in force from 2020-01-01 cite "by-law 1"\n'
    )
    page = written(capsys, "./new.rules", "--format", "markdown")
    values = section(page, "## Options and parameters")
    assert "| `7 km/h` |  | always | `old` | s. 4(2) | on foot |" in values
    assert "| `6 km/h` | ✔ | from 2020-01-01 | `new` | by-law 1 |  |" in values
    assert "`slow` is defined by `old`. s. 4(1).\n" in section(page, "## Definitions")


def test_what_stands_behind_the_rules(page):
    values = section(page, "## Options and parameters")
    assert (
        "\n| `pace` | parameter | `25 km/h` |  | from 2022-01-01 | `mainland` |  |  |\n" in values
    )
    assert "\n| `pace` | parameter | `20 km/h` | ✔ | always | `island` |  |  |\n" in values
    assert "| until 2021-12-31 | `mainland` |  | What signs said. |\n" in values
    # No rule speaks of it.
    assert "strict" not in values
    definitions = section(page, "## Definitions")
    assert "`slow` is defined by `island`. It was in `mainland` `speed <= pace`.\n" in definitions
    assert "never_used" not in definitions
    assert "```rulec\ndefine slow = speed < pace\n```" in definitions
    out = section(page, "## What this rulebook leaves out")
    assert "\n| `taken_out` | dropped by `island` | there are no sirens |\n" in out
    assert "\n| `parking` | `island` is silent on it | left to the villages |\n" in out
    words = section(page, "## Vocabulary")
    assert "\n| `horn` | the world | yes or (no) |  |\n" in words
    assert "\n| `speed` | the world | a number of `km/h` (0) |  |\n" in words
    assert "unused_word" not in words


def test_the_index_leads_to_the_rules(page):
    index = section(page, "## Index of provisions")
    places = [index.index(one) for one in ("Island Act:", "§ 10a", "Mainland Act:", "§ 2", "§ 9")]
    assert places == sorted(places)
    assert "| § 9 | [Kept](#kept--9) |" in index
    assert "\n  - [Kept (§ 9)](#kept--9)\n" in section(page, "## Contents")


def test_a_rule_that_is_not_in_force(folder, capsys):
    page = written(capsys, "village.rules", "--format", "markdown", "--at", "2024-05-31")
    out = section(page, "## What this rulebook leaves out")
    assert "\n| `own` | not in force on 2024-05-31 | in force from 2024-06-01 |\n" in out
    assert "### Own" not in page


def test_words_with_their_descriptions(capsys):
    page = written(capsys, "esterle2019", "--format", "markdown")
    words = section(page, "## Vocabulary")
    described = re.findall(
        r"^\| `CONGESTED` \| the world \| yes or \(no\) \| (.+) \|$", words, re.M
    )
    assert len(described) == 1
    assert described[0].strip()


@pytest.mark.parametrize("book", ["island.rules", "village.rules", "esterle2019", "vienna", "de"])
def test_every_link_of_the_page_leads_somewhere(folder, book, capsys):
    page = written(capsys, book)
    assert page.startswith("<!DOCTYPE html>\n")
    names = re.findall(r' id="([^"]*)"', page)
    links = re.findall(r' href="#([^"]*)"', page)
    assert len(set(names)) == len(names)
    assert set(links) <= set(names)
    assert len(links) >= 4


@pytest.mark.parametrize(
    ("name", "options", "beginning"),
    [
        ("b.html", [], "<!DOCTYPE html>\n"),
        ("b.md", [], "# Rules of the island\n"),
        ("b.txt", ["--output-format", "html"], "<!DOCTYPE html>\n"),
        ("b", ["--format", "markdown"], "# Rules of the island\n"),
    ],
)
def test_a_file(folder, name, options, beginning, capsys):
    assert written(capsys, "island.rules", "-o", name, *options) == f"wrote {name}\n"
    assert (folder / name).read_text(encoding="utf-8").startswith(beginning)


def test_german_and_french(capsys):
    """Sentences, headings and titles are in the language, what the author wrote is as it is."""
    german = written(capsys, "de", "--language", "de", "--format", "markdown")
    rule = section(german, "### Überholt werden (§ 5(6) s. 1)")
    assert "\n- **Art der Regel:** hart, sie darf nie verletzt werden\n" in rule
    assert (
        "\n#### In Worten\n\nNie kommt vor: beides: Ego wird überholt und Ego wird schneller."
        in rule
    )
    assert "**Beispiel 1" in rule
    assert "\n## Verzeichnis der Vorschriften\n" in german
    french = written(capsys, "de", "--language", "fr")
    assert french.startswith('<!DOCTYPE html>\n<html lang="fr">')
    assert "Jamais ceci : les deux à la fois : ego est dépassé et ego accélère." in french
    assert '<nav aria-label="Sommaire">' in french


def test_numbers_have_the_comma_of_their_language(folder, capsys):
    (folder / "slow.rules").write_text(
        "rulebook slow\nuse road\nhard rule r { require always speed < 1.5 km/h\n"
        "  accept { speed = 0.25 km/h } }\n"
    )
    page = written(capsys, "slow.rules", "--language", "de", "--format", "markdown")
    rule = section(page, "### R")
    assert "Immer gilt: Egos Geschwindigkeit beträgt weniger als 1,5 km/h." in rule
    assert "| speed, km/h | 0,25 |" in rule
    # A formula is what it is.
    assert "```rulec\nrequire always speed < 1.5 km/h\n```" in rule


def test_examples_are_drawn_where_there_is_something_to_see(folder, capsys):
    (folder / "drawn.rules").write_text(
        "rulebook drawn\nuse road\n"
        "hard rule passes (v: vehicle) {\n"
        "  require never (behind(v) then beside(v) and right_of(v) then in_front_of(v))\n"
        '  accept "one is there" { behind(v) and right_of(v) and speed = 30 km/h }\n'
        '  reject "passed" {\n'
        "    behind(v) and same_lane(v); beside(v) and right_of(v);\n"
        "    in_front_of(v) and same_lane(v)\n"
        "  }\n"
        "}\n"
        "hard rule light {\n"
        "  require never red_light accept { speed = 1 km/h } reject { red_light }\n"
        "}\n"
    )
    page = written(capsys, "drawn.rules")
    assert page.count('<svg aria-label="Example ') == 3
    label = re.escape("Example 2 (passed): forbidden ✘")
    (passing,) = re.findall(rf'<svg aria-label="{label}".*?</svg>', page)
    # Ego and v in each of the three states; v is ahead, then at ego's left, then behind.
    assert passing.count('class="ego"') == 3
    places = re.findall(r'class="other" x="([\d.]+)" y="([\d.]+)"', passing)
    (x1, y1), (x2, y2), (x3, y3) = [(float(x), float(y)) for x, y in places]
    assert y1 < y2 < y3
    assert x2 < x1 == x3
    assert 'class="light red"' in page
    markdown = written(capsys, "drawn.rules", "--format", "markdown")
    assert "![" not in markdown
    assert "<svg" not in markdown


@pytest.mark.parametrize("language", ["de", "fr"])
def test_every_text_and_title_is_there_in_each_language(language):
    """What documents say in English, rules and topics that ship: all is said in the others."""
    texts = document_language(load_rulebook("vienna"), language)
    said, constants = set(), {*get_args(ProvisionState), *get_args(ConstantKind)}
    for name in (
        "document/book_document",
        "document/book_rule",
        "document_language",
        "audit_report",
    ):
        for node in ast.walk(ast.parse((SOURCES / f"{name}.py").read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant):
                constants.add(node.value)
            elif isinstance(node, ast.Call) and "say" in ast.unparse(node.func).split("."):
                inner = ast.walk(node.args[0])
                said |= {one.value for one in inner if isinstance(one, ast.Constant)}
    assert len(said) > 80
    assert said <= texts.texts.keys() <= constants
    for text, instead in texts.texts.items():
        assert text.count("{}") == instead.count("{}"), text
    # The paper's rules have numbers, and beliefs are no law. What stands in the files is enough:
    # to load all takes long.
    files = (ROOT / "rulebooks").glob("*/*.rules")
    sources = [
        x.read_text(encoding="utf-8") for x in files if x.stem not in ("esterle2019", "believable")
    ]
    rules = {name for x in sources for name in re.findall(r"^(?:hard|soft) rule (\w+)", x, re.M)}
    assert len(rules) > 100
    assert rules - texts.titles.keys() == set()
    topics = {topic.name for topic in load_rulebook("vienna").topics}
    assert topics == texts.topics.keys()


def test_no_path_of_this_machine_is_in_it(folder, capsys):
    whole = str(folder / "village.rules")
    for output_format in ("html", "markdown"):
        page = written(capsys, whole, "--format", output_format)
        assert str(folder) not in page
        assert str(Path(__file__).resolve().parents[2]) not in page


def test_it_is_the_same_every_time(folder, capsys):
    assert written(capsys, "island.rules") == written(capsys, "island.rules")


def test_a_rulebook_without_rules(folder, capsys):
    (folder / "single.rules").write_text(
        "rulebook single signal p hard rule r { require always p }\n"
    )
    (folder / "empty.rules").write_text('rulebook empty\nextends single\ndrop rule r because ""\n')
    page = written(capsys, "empty.rules", "--format", "markdown")
    assert page.startswith("# empty\n")
    assert section(page, "## Rules") == "\nNone.\n\n"
    assert section(page, "## Index of provisions").startswith("\nNo provision is cited.\n")


def test_hostile_texts_stay_texts(folder, capsys):
    text = island.BASE.replace("Do not sound the horn.", "<script>alert(1)</script> | *x* ]]>")
    (folder / "odd.rules").write_text(text.replace("§ 9", "<b onclick=x>"), encoding="utf-8")
    page = written(capsys, "odd.rules")
    assert "<script" not in page
    assert "<b " not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; | *x* ]]&gt;" in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["none"], "there is no rulebook `none`"),
        (["bad.rules"], "R0201"),
        (["x.json"], "`x.json` is compiled and cannot be made a document of"),
        (["island.rules", "-o", "no/b.html"], "R0702"),
        (["island.rules", "-o", "b.PDF"], "A browser prints the page and saves it as PDF."),
    ],
)
def test_what_cannot_be_done(folder, arguments, words, capsys):
    (folder / "bad.rules").write_text("rulebook bad hard rule r (v: car) { require true }")
    assert main(["doc", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert words in captured.err
    assert not (folder / "no").exists()

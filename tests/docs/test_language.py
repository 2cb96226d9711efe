"""docs/language.md: its samples are read as they stand there, its list of words is whole."""

import re
from pathlib import Path

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.resolve import resolve_vocabulary
from rulec.syntax import parse
from rulec.syntax.keywords import RESERVED

PAGE = (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+(?: \w+)?)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def blocks(kind):
    found = [text for name, text in BLOCKS if name == kind]
    assert found, kind
    return found


@pytest.mark.parametrize("text", blocks("rulec vocabulary"), ids=lambda text: text.split()[1])
def test_vocabularies(text):
    tree, mistakes = parse(Source("page", text))
    vocabulary, more = resolve_vocabulary(tree)
    assert (*mistakes, *more) == ()
    assert vocabulary is not None
    assert list(vocabulary.types) == ["road_user", "vehicle", "bus", "pedestrian"]


def test_the_two_spellings_mean_the_same():
    (text,) = (text for text in blocks("rulec") if "rule symbols" in text)
    words, symbols = parse_rulebook(text).rules
    assert words.formula == symbols.formula


def test_the_words_that_cannot_be_names_are_all_listed():
    quoted = "".join(line[2:] for line in PAGE.splitlines(keepends=True) if line.startswith("> "))
    assert set(quoted.replace("`", " ").split()) == RESERVED


def test_the_mistake_looks_as_shown():
    lines = ["rulebook example", "use paper", "hard rule r (v: vehicle) {", '  says "no"']
    text = "\n".join([*lines, "  require CONGESTED => f_v", "}"])
    with pytest.raises(RulecError) as caught:
        parse_rulebook(text, "example.rules")
    (shown,) = blocks("text")
    assert render_diagnostics(caught.value.diagnostics) == f"{shown}\n1 error\n"

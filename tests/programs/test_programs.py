"""Rulebooks in the language itself: good ones load, bad ones say what NAME.expected says.

``RULEC_REFRESH=1 pytest tests/programs`` rewrites the expected files; read the difference before it
is committed. A bad file's first line says how many mistakes it has: one error for each. The
vocabularies that bad files use are in ``bad/vocabulary``, the rulebooks that files extend in
folders of their own.
"""

import os
import re
from pathlib import Path

import pytest

from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.diagnostics import Diagnostic, RulecError
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.syntax import decode, parse
from support.builders.printed_files import print_file

HERE = Path(__file__).parent
GOOD = sorted((HERE / "good").rglob("*.rules"))
BAD = sorted((HERE / "bad").glob("*.rules"))


def diagnostics_of(path: Path) -> tuple[Diagnostic, ...]:
    try:
        return read_rulebook(path).warnings
    except RulecError as error:
        return error.diagnostics


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_good_file_has_no_mistakes_and_prints_as_itself(path: Path) -> None:
    tree, mistakes = parse(decode(path.name, path.read_bytes()))
    assert mistakes == ()
    for style in ("words", "symbols"):
        again, _ = parse(decode("again", print_file(tree, style).encode()))
        assert again == tree
    if tree.kind == "rulebook":
        loaded = read_rulebook(path)
        assert loaded.warnings == ()
        assert loaded.rulebook.name == path.stem


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_a_good_rulebooks_examples_come_out_as_they_say(path: Path) -> None:
    tree, _ = parse(decode(path.name, path.read_bytes()))
    if tree.kind == "rulebook":
        rulebook = read_rulebook(path).rulebook
        outcomes = run_rulebook_examples(rulebook, compile_rulebook(rulebook)).outcomes
        assert [one for one in outcomes if not one.passed] == []


@pytest.mark.parametrize("path", BAD, ids=lambda path: path.stem)
def test_a_bad_file_says_what_is_expected(path: Path) -> None:
    found = diagnostics_of(path)
    text = render_diagnostics(found).replace(f"{HERE}/", "")
    text = re.sub(r"(?<=::: |--> ).*/rulebooks/", "rulebooks/", text)
    text = re.sub(r"available: `another_vocabulary`[^)\n]*", "available: …", text)
    expected = path.with_suffix(".expected")
    if os.environ.get("RULEC_REFRESH"):
        expected.write_text(text, encoding="utf-8")
    declared = re.match(r"# mistakes: (\d+)", path.read_text(encoding="utf-8"))
    assert declared is not None
    assert len(found) == int(declared[1]), text
    assert text == expected.read_text(encoding="utf-8")
    assert all(one.place is not None and one.place.line is not None for one in found)

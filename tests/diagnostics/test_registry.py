"""Codes: each is defined once, used, asked for by a test and explained by the page on codes."""

import pickle
import re
from functools import cache
from pathlib import Path

import pytest

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation, Span
from rulec.diagnostics.code import Code
from rulec.report.findings.code_registry import all_codes
from rulec.resources import codes_page
from support.source_modules import PACKAGE, source_modules

ROOT = Path(__file__).resolve().parents[2]
CODES = all_codes()


@cache
def texts_of_tests():
    """The text of all tests."""
    return "".join(
        path.read_text()
        for pattern in ("*.py", "*.expected")
        for path in (ROOT / "tests").rglob(pattern)
    )


@cache
def defined():
    """Code -> the name that it is bound to, and the module that does so."""
    return {
        text: (name, PACKAGE / module.name)
        for module in source_modules()
        for text, name in module.codes.items()
    }


@cache
def loaded():
    """Every name that is read somewhere."""
    return frozenset[str]().union(*(module.loaded for module in source_modules()))


def test_each_code_stands_in_the_sources_once():
    lines = [line for module in source_modules() for line in module.lines]
    literals = [text for line in lines for text in re.findall(r'"(R\d{4})"', line)]
    assert sorted(literals) == sorted(defined())
    assert sum(module.called.get("Code", 0) for module in source_modules()) == len(defined())


def test_the_page_explains_what_is_defined_in_order():
    assert list(CODES) == sorted(defined())


def test_the_page_says_nothing_that_is_not_read():
    sections = re.findall(r"^### .*", codes_page().read_text(encoding="utf-8"), re.MULTILINE)
    assert sections == [f"### {code.code}: {code.title}" for code in CODES.values()]


@pytest.mark.parametrize("code", CODES.values(), ids=CODES)
def test_an_explanation_is_a_paragraph_and_two_examples(code):
    blocks = re.sub(r"```.*?```", "```", code.markdown, flags=re.DOTALL).split("\n\n")
    assert code.title
    assert code.why
    if code.kind == "circumstance":
        assert len(blocks) == 1
        assert (code.bad, code.good) == ("", "")
    else:
        assert blocks[2:] == ["```", "Corrected:", "```"]
        assert code.bad != code.good


def test_every_name_is_given_once():
    names = [name for name, _ in defined().values()]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("text", CODES)
def test_a_code_is_used_and_tested(text):
    name, _ = defined()[text]
    assert name in loaded()
    assert text in texts_of_tests()


def test_diagnostics_are_made_by_codes():
    made = {module.name for module in source_modules() if "Diagnostic" in module.called}
    assert made == {"diagnostics/code.py"}


BROKEN = Code("R9999")


def test_a_code_makes_diagnostics():
    place = SourceLocation("a.rules", 1, 1)
    made = BROKEN.at(place, "this is broken", expected="expected more", help="mend it")
    assert made == Diagnostic("R9999", "this is broken", place, "expected more", "mend it")
    assert BROKEN.at(None, "this is broken", severity="warning").severity == "warning"


def test_a_span_is_a_place():
    span = Span(Source("a.rules", "one\ntwo"), 4, 7)
    assert BROKEN.at(span, "this is broken").place == span.place


def test_a_code_makes_an_error():
    error = BROKEN.error(None, "this is broken", notes=("at night",))
    assert isinstance(error, RulecError)
    assert error.diagnostics == (BROKEN.at(None, "this is broken", notes=("at night",)),)


def test_an_error_says_what_was_expected_and_each_way_out_once():
    said = [
        Diagnostic("R0703", "there is no `DE`", help="did you mean `de`?"),
        Diagnostic("R0703", "there is no `de `", help="did you mean `de`?"),
        Diagnostic("R0701", "it cannot be read"),
        Diagnostic("R0617", "`side` is `up`", expected="expected `left`, `right`"),
    ]
    error = pickle.loads(pickle.dumps(RulecError(said)))
    assert str(error).splitlines() == [
        "; ".join(f"{one.message} [{one.code}]" for one in said),
        "help: did you mean `de`?",
        "expected `left`, `right`",
    ]
    assert str(RulecError(said[2])) == "it cannot be read [R0701]"
    both = Diagnostic("R0780", "it has shape (2,)", expected="expected (3,)", help="transpose it")
    assert str(RulecError(both)) == "it has shape (2,) [R0780]\nexpected (3,)\nhelp: transpose it"

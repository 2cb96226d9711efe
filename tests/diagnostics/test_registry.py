"""The registry of codes: each is defined once, beside its pass, used, and asked for by a test."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation, Span
from rulec.diagnostics.code import Code
from rulec.report.findings.code_registry import all_codes, code_named, message_files

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {path: path.read_text() for path in (ROOT / "src").rglob("*.py")}
TREES = {path: ast.parse(text) for path, text in SOURCES.items()}
TESTS = "".join(
    path.read_text()
    for pattern in ("*.py", "*.expected")
    for path in (ROOT / "tests").rglob(pattern)
)


def calls(tree, name):
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name
    ]


def definitions():
    """Code -> the name that it is bound to, and the module that does so."""
    return {
        node.value.args[0].value: (node.targets[0].id, path)
        for path, tree in TREES.items()
        for node in tree.body
        if isinstance(node, ast.Assign) and calls(node, "Code")
    }


DEFINED = definitions()
CODES = all_codes()
LOADED = {
    node.id if isinstance(node, ast.Name) else node.attr
    for tree in TREES.values()
    for node in ast.walk(tree)
    if isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Load)
}


def test_each_code_stands_in_the_sources_once():
    literals = [text for source in SOURCES.values() for text in re.findall(r'"(R\d{4})"', source)]
    assert sorted(literals) == sorted(DEFINED)
    assert sum(len(calls(tree, "Code")) for tree in TREES.values()) == len(DEFINED)


def test_the_registry_has_what_is_defined():
    assert list(CODES) == sorted(DEFINED)
    assert {path for _, path in DEFINED.values()} <= set(message_files())


def test_every_name_is_given_once():
    names = [name for name, _ in DEFINED.values()]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("text", CODES)
def test_what_is_read_is_what_is_imported(text):
    name, path = DEFINED[text]
    module = path.relative_to(ROOT / "src").with_suffix("")
    assert getattr(import_module(".".join(module.parts)), name) == CODES[text]


@pytest.mark.parametrize("text", CODES)
def test_a_code_is_found_by_itself(text):
    assert code_named(text) == CODES[text]


def test_what_is_no_code_is_not_found():
    assert code_named("R9999") is None
    assert code_named("title") is None


@pytest.mark.parametrize("text", CODES)
def test_a_code_is_used_and_tested(text):
    name, _ = DEFINED[text]
    assert name in LOADED
    assert text in TESTS


def test_diagnostics_are_made_by_codes():
    made = {path.relative_to(ROOT).as_posix() for path in TREES if calls(TREES[path], "Diagnostic")}
    assert made == {
        "src/rulec/diagnostics/code.py",
        "src/rulec/rulebook/batch/check_cache.py",  # reads what one has made
    }


BROKEN = Code("R9999", title="something is broken", why="It is.")


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

"""The parser's tables: of this grammar, the same wherever they are made, and dispensable."""

import json
from functools import cache
from pathlib import Path

import lark
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.resources import grammar_file
from rulec.syntax import grammar as at_work
from rulec.syntax import parse_formula, parser_tables
from rulec.syntax.tree_printer import print_whole
from support.generators.syntax_trees import formulas

GRAMMAR = grammar_file("rulec.lark").read_text(encoding="utf-8")
FILE = grammar_file("rulec.tables.json").read_text(encoding="utf-8")


def test_the_tables_are_up_to_date():
    version, _, digest = json.loads(FILE)["made_of"].partition(" ")
    again = ".ci/task regenerate"
    assert parser_tables.stamp(GRAMMAR, "").strip() == digest, again
    if version == lark.__version__:
        assert at_work.tables_of(GRAMMAR) == FILE, again


def test_the_tables_are_those_in_use():
    assert parser_tables.from_text(FILE, json.loads(FILE)["made_of"]) is not None
    assert (
        parser_tables.from_text(FILE, parser_tables.stamp(f"{GRAMMAR}\n", lark.__version__)) is None
    )


@cache
def anew():
    return at_work._made(GRAMMAR)


@given(formulas, st.data())
def test_both_parsers_read_and_refuse_alike(formula, data):
    text = print_whole(formula)
    assert at_work._lark().parse(text, start="formula") == anew().parse(text, start="formula")
    some = text[: data.draw(st.integers(0, len(text)))]
    assert outcome(at_work._lark(), some) == outcome(anew(), some)


def outcome(parser, text):
    try:
        return parser.parse(text, start="formula")
    except lark.exceptions.UnexpectedInput as error:
        return type(error), error.pos_in_stream


@pytest.mark.parametrize("content", [None, "", "{", "[]", "{}", '{"made_of": "1.0.0 abc"}'])
def test_without_usable_tables_the_grammar_is_read(content, tmp_path, monkeypatch):
    def file(name):
        return Path(tmp_path, name)

    file("rulec.lark").write_text(GRAMMAR, encoding="utf-8")
    if content is not None:
        file("rulec.tables.json").write_text(content, encoding="utf-8")
    before = parse_formula("p until q")
    monkeypatch.setattr(at_work, "grammar_file", file)
    at_work._lark.cache_clear()
    try:
        assert parse_formula("p until q") == before
    finally:
        at_work._lark.cache_clear()

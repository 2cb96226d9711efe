"""Every token of the grammar has its words; nobody reads the grammar's own names."""

import re

import pytest
from lark import Lark

from rulec.resources import grammar_file
from rulec.syntax.messages.parse_context import in_words

GRAMMAR = Lark(
    grammar_file("rulec.lark").read_text(encoding="utf-8"),
    parser=None,
    lexer="basic",
    start="file",
)
TOKENS = {one.name: one for one in GRAMMAR.terminals if one.name not in GRAMMAR.ignore_tokens}
PHRASES = {
    "NAME": "expected a name",
    "STRING": "expected a text in double quotes",
    "DATE": "expected a date such as 2006-03-28",
    "NUMBER": "expected a number",
    "UNIT": "expected a unit such as km/h",
    "$END": "expected nothing more",
}


@pytest.mark.parametrize("name", sorted({*TOKENS, "$END"}))
def test_a_token_is_named_as_it_is_written(name):
    words = in_words({name})
    if name in PHRASES:
        assert words == PHRASES[name]
    else:
        (spelt,) = re.fullmatch(r"expected `(.+)`", words).groups()
        assert re.fullmatch(TOKENS[name].pattern.to_regexp(), spelt)


def test_many_at_once_are_few_words():
    everything = in_words(TOKENS)
    assert "an operator such as `and`" in everything
    assert "a scope such as `throughout`" in everything
    assert "at_" not in everything
    assert "lsqb" not in everything.lower()

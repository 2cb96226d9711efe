"""Words in their place only are names everywhere else; the reserved ones never are."""

import re

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.resources import grammar_file
from rulec.syntax import parse, parse_formula, print_formula
from rulec.syntax.keywords import CONTEXTUAL, RESERVED
from support.builders.printed_files import print_file

GRAMMAR = grammar_file("rulec.lark").read_text(encoding="utf-8")
BOOK = """\
rulebook {0}
use {0}
extends {0}
traffic left
semantics finite
priority {0} > {0} = other
type {0}
signal {0}, other({0}: {0})
{0}(v: {0}) is one of {0}, other default {0}
fact {0} or other({0})
option {0} = on
param {0} : {0} = {0} + 2 s in force from 2020-01-01
define {0}({0}: {0}) = {0} and some {0}: {0} (other({0}))
drop rule {0} because "a"
soften rule {0} in {0} weight 2
silent on {0} because "b"
hard rule {0} ({0}: {0}) in {0} weight 2 {{
  certainty verified
  in force from 2020-01-01
  when {0}
  require always[<= {0}] {0} until[{0}] {0}
  unless {0} at start
  unless {0}
  accept ({0}: {0}) {{ {0} and not {0}; {0} = 3 m }}
}}
"""


def test_the_grammar_s_contextual_words_are_known():
    alone = set(re.findall(r"^[A-Z_]+\.1: /(\w+)\\b/", GRAMMAR, re.MULTILINE))
    assert alone | {"at"} == CONTEXTUAL
    assert not CONTEXTUAL & RESERVED


@pytest.mark.parametrize("word", sorted(CONTEXTUAL))
def test_a_contextual_word_may_be_any_name(word):
    file, mistakes = parse(Source("a.rules", BOOK.format(word)))
    assert mistakes == ()
    expected, _ = parse(Source("a.rules", BOOK.format("some_name")))
    assert print_file(file) == re.sub(r"\bsome_name\b", word, print_file(expected))


@pytest.mark.parametrize("word", sorted(CONTEXTUAL))
def test_a_contextual_word_may_begin_a_line_of_a_formula(word):
    formula = parse_formula(f"p and\n{word}\nor q and (\n{word}(v))")
    assert print_formula(formula) == f"p and {word} or q and {word}(v)"
    text = f"rulebook a\nsignal {word}\nhard rule r {{\n  require p and\n  {word}\n}}\n"
    assert parse(Source("a.rules", text))[1] == ()


@pytest.mark.parametrize("word", sorted(RESERVED))
def test_a_reserved_word_is_no_name(word):
    _, mistakes = parse(
        Source("a.rules", f"rulebook a\nsignal p, {word}\nhard rule r {{require p}}")
    )
    assert len(mistakes) == 1
    with pytest.raises(RulecError):
        parse_formula(f"p(v, {word})")


def test_names_and_units_leave_out_exactly_the_reserved_words():
    (names,) = re.findall(r"^NAME: /\(\?!\(\?:([^)]*)\)", GRAMMAR, re.MULTILINE)
    (units,) = re.findall(r"^UNIT: /\(\?!\(\?:([^)]*)\)", GRAMMAR, re.MULTILINE)
    assert set(names.split("|")) == RESERVED
    assert set(units.split("|")) == RESERVED - {"step"}


@pytest.mark.parametrize("unit", ["step", "steps", "s", "min", "h"])
def test_a_bound_counts_in(unit):
    assert parse_formula(f"next[1 {unit}] p").bound.low.unit == unit
    text = f"rulebook a\nsignal p\ndefine d = next[1 {unit}] p\nhard rule r {{ require d }}\n"
    assert parse(Source("a.rules", text))[1] == ()


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("on", "on"),
        ("(on)", "(on)"),
        ("(off + 1 m)", "(off + 1 m)"),
        ("(off) + 1 m", "(off + 1 m)"),
        ("(off(v))", "(off(v))"),
        ("(online)", "online"),
    ],
)
def test_a_setting_that_begins_with_a_switch_s_word_keeps_its_parentheses(written, printed):
    file, mistakes = parse(Source("a.rules", f"rulebook a\nset x = {written}\n"))
    assert mistakes == ()
    assert f"set x = {printed}\n" in print_file(file)

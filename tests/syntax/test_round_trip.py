"""What is printed is read back as the same tree, and prints as itself again."""

import re

from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError, Source
from rulec.syntax import parse, parse_formula, print_formula
from rulec.syntax.tree import Aggregate, AtomUse, NumberLiteral, TruthLiteral
from rulec.syntax.tree_printer import print_whole
from support.builders.printed_files import print_file
from support.generators.syntax_trees import files, formulas

styles = st.sampled_from(["words", "symbols", "written"])


@given(formulas, styles)
def test_a_printed_formula_is_read_as_the_same_tree(formula, style):
    text = print_whole(formula, style)
    again = parse_formula(text)
    assert again == formula
    assert print_whole(again, style) == text


@given(formulas, st.sampled_from(["words", "symbols"]))
def test_parentheses_are_fewest(formula, style):
    text = print_whole(formula, style)
    for opening in (at for at, sign in enumerate(text) if sign == "("):
        if re.search(r"\w ?$", text[:opening]) and belongs(text, opening):
            continue
        closing = _closing(text, opening)
        without = f"{text[:opening]} {text[opening + 1 : closing]} {text[closing + 1 :]}"
        try:
            again = parse_formula(without)
        except RulecError:
            continue
        assert again != formula


def belongs(text, opening):
    """Are they an atom's parentheses, or those of ``some x: type (…)``?"""
    if text[opening - 1] != " ":
        return True
    return re.search(r"\b(some|every|count) \w+: \w+ $", text[:opening]) is not None


def _closing(text, opening):
    depth = 0
    for at in range(opening, len(text)):
        depth += (text[at] == "(") - (text[at] == ")")
        if depth == 0:
            return at
    raise AssertionError(text)


@given(files, styles)
def test_a_printed_file_is_read_as_the_same_tree(file, style):
    text = print_file(file, style)
    again, mistakes = parse(Source("printed", text))
    assert mistakes == ()
    assert again == file
    assert print_file(again, style) == text


@given(formulas)
def test_a_formula_s_span_is_its_text(formula):
    text = f"  ( {print_formula(formula)} )  # and a comment"
    again = parse_formula(text)
    assert parse_formula(f"({again.span.text})") == formula


@given(formulas, st.sampled_from(["words", "symbols"]))
def test_what_is_written_stays_as_it_is(formula, style):
    """The style `written` keeps the file's spelling, and its parentheses around an operator."""
    text = f"({print_formula(formula, style)}) and p"
    again = parse_formula(text)
    written = print_formula(again, "written")
    assert parse_formula(written) == again
    needless = isinstance(formula, AtomUse | TruthLiteral | NumberLiteral | Aggregate)
    assert written == (f"{print_formula(formula, style)} and p" if needless else text)

"""What is printed is read back as the same tree, and prints as itself again."""

from hypothesis import given
from hypothesis import strategies as st
from syntax_trees import files, formulas

from rulec.diagnostics import Source
from rulec.syntax import parse, parse_formula, print_file, print_formula

styles = st.sampled_from(["words", "symbols"])


@given(formulas, styles)
def test_a_printed_formula_is_read_as_the_same_tree(formula, style):
    text = print_formula(formula, style)
    again = parse_formula(text)
    assert again == formula
    assert print_formula(again, style) == text


@given(formulas, styles)
def test_parentheses_are_fewest(formula, style):
    text = print_formula(formula, style)
    for opening in (at for at, sign in enumerate(text) if sign == "("):
        if opening and (text[opening - 1].isalnum() or text[opening - 1] == "_"):
            continue  # an atom's own parentheses
        closing = _closing(text, opening)
        without = f"{text[:opening]} {text[opening + 1 : closing]} {text[closing + 1 :]}"
        assert parse_formula(without) != formula


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
    assert parse_formula(again.span.text) == formula

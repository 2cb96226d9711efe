"""A formula over several lines is the same formula."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.printing import formula_text
from rulec.report.text.formula_lines import formula_lines
from support.generators.random_formulas import formulas


@given(formulas, st.integers(10, 60))
def test_only_line_breaks_are_added(formula, width):
    text = formula_text(formula)
    lines = formula_lines(text, width)
    joined = " ".join(line.strip() for line in lines)
    assert re.sub(r"\( ", "(", joined).replace(" )", ")") == text
    binary = r" (and|or|implies|iff|xor|then|until|release|since) "
    assert len(lines) > 1 or len(text) <= width or not re.search(binary, text)


@given(formulas)
def test_what_can_be_broken_is_no_wider_than_asked_for(formula):
    for line in formula_lines(formula_text(formula), 40):
        # Names and unary operators cannot be broken, nor can what they stand before.
        assert len(line) <= 40 or not re.search(r" (and|or|implies|iff|xor|then) ", line.strip())


@pytest.mark.parametrize(
    ("text", "width", "lines"),
    [
        ("p and q", 7, ["p and q"]),
        ("p and q", 6, ["p", "  and q"]),
        ("p and q or r", 10, ["p and q", "  or r"]),
        ("p weak until[<= 3 s] q", 20, ["p", "  weak until[<= 3 s] q"]),
        ("always (p and q)", 12, ["always (", "  p and q", ")"]),
        ("pp until (q or r)", 16, ["pp", "  until (q or r)"]),
        ("always[<= 3 s] (p or q)", 16, ["always[<= 3 s] (", "  p or q", ")"]),
    ],
)
def test_breaks(text, width, lines):
    assert formula_lines(text, width) == lines

"""Constants are folded away, and nothing else changes."""

import pytest
from hypothesis import given

from rulec.logic.fold import fold_constants
from rulec.logic.formula import Binary, BinaryOperator, Constant, Unary, UnaryOperator
from rulec.logic.printing import formula_text
from rulec.logic.semantics import truth_values
from rulec.rulebook.loader import parse_rulebook
from support.generators.random_formulas import formulas, letters, parts_of, words

JOINING = {BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES}


@given(formulas, words)
def test_the_meaning_stays(formula, word):
    assert truth_values(fold_constants(formula), letters(word)) == truth_values(
        formula, letters(word)
    )


@given(formulas)
def test_no_constant_is_joined_or_denied(formula):
    for part in parts_of(fold_constants(formula)):
        match part:
            case Unary(UnaryOperator.NOT, operand):
                assert not isinstance(operand, Constant)
            case Binary(operator, left, right) if operator in JOINING:
                assert not isinstance(left, Constant)
                assert not isinstance(right, Constant)


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("never (no and p)", "never false"),
        ("never (yes and p)", "never p"),
        ("always (p or no)", "always p"),
        ("always (yes or p)", "always true"),
        ("always (no implies p)", "always true"),
        ("always (yes implies p)", "always p"),
        ("always (p implies no or not yes)", "always not p"),
        ("p iff yes", "p iff true"),
    ],
)
def test_what_is_left(written, expected):
    options = "option yes = on\noption no = off\n"
    book = parse_rulebook(f"rulebook a\nsignal p\n{options}hard rule r {{ require {written} }}")
    assert formula_text(fold_constants(book.rules[0].formula)) == expected

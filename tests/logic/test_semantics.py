"""The meaning of the operators, against the paper's Table I and against each other."""

import pytest
from hypothesis import given
from words import formulas, letters, words

from rulec.logic.formula import Atom, Binary, BinaryOperator, Constant, Unary, UnaryOperator
from rulec.logic.semantics import holds, truth_values

X, Y = Atom("x"), Atom("y")

# Table I: x = T F T T, y = F T F F, and so on with the last one for ever.
TABLE_I_WORD = [frozenset({X}), frozenset({Y}), frozenset({X}), frozenset({X})]
TABLE_I = {
    "next x": (Unary(UnaryOperator.NEXT, X), "FTTT"),
    "always x": (Unary(UnaryOperator.ALWAYS, X), "FFTT"),
    "eventually y": (Unary(UnaryOperator.EVENTUALLY, Y), "TTFF"),
    "y until x": (Binary(BinaryOperator.UNTIL, Y, X), "TTTT"),
}


@pytest.mark.parametrize("row", TABLE_I)
def test_table_i_of_the_paper(row):
    formula, expected = TABLE_I[row]
    assert truth_values(formula, TABLE_I_WORD) == [value == "T" for value in expected]


def test_the_last_letter_goes_on_for_ever():
    assert truth_values(Unary(UnaryOperator.NEXT, Y), [frozenset({Y})]) == [True]
    assert truth_values(Unary(UnaryOperator.ALWAYS, Y), [frozenset(), frozenset({Y})]) == [
        False,
        True,
    ]


def test_an_empty_word_has_no_meaning():
    with pytest.raises(ValueError, match="empty"):
        holds(X, [])


def fixpoint(formula, word):
    """An evaluation that shares nothing with the one under test: unfold each operator by its
    expansion law, and iterate over the instants until nothing changes any more."""
    n = len(word)
    following = [min(i + 1, n - 1) for i in range(n)]

    def solve(start, update):
        values = [start] * n
        while True:
            renewed = [update(i, values[following[i]]) for i in range(n)]
            if renewed == values:
                return values
            values = renewed

    match formula:
        case Atom():
            return [formula in letter for letter in word]
        case Constant(value):
            return [value] * n
        case Unary(operator, operand):
            a = fixpoint(operand, word)
            return {
                "not": lambda: [not v for v in a],
                "next": lambda: [a[following[i]] for i in range(n)],
                "weak next": lambda: [a[following[i]] for i in range(n)],
                "always": lambda: solve(True, lambda i, later: a[i] and later),
                "eventually": lambda: solve(False, lambda i, later: a[i] or later),
            }[operator.value]()
        case Binary(operator, left, right):
            a, b = fixpoint(left, word), fixpoint(right, word)
            return {
                "and": lambda: [a[i] and b[i] for i in range(n)],
                "or": lambda: [a[i] or b[i] for i in range(n)],
                "implies": lambda: [b[i] if a[i] else True for i in range(n)],
                "iff": lambda: [a[i] is b[i] for i in range(n)],
                "xor": lambda: [a[i] is not b[i] for i in range(n)],
                "until": lambda: solve(False, lambda i, later: b[i] or (a[i] and later)),
                "weak until": lambda: solve(True, lambda i, later: b[i] or (a[i] and later)),
                "release": lambda: solve(True, lambda i, later: b[i] and (a[i] or later)),
                "strong release": lambda: solve(False, lambda i, later: b[i] and (a[i] or later)),
            }[operator.value]()


@given(formulas, words)
def test_evaluation_agrees_with_the_expansion_laws(formula, word):
    assert truth_values(formula, letters(word)) == fixpoint(formula, letters(word))

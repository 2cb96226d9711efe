"""Formulas as text mean what they are."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Count,
    QuantityTerm,
    Same,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.printing import formula_text, number_in_words, term_text, time_in_words
from rulec.rulebook.loader import parse_rulebook
from support.generators.random_formulas import VOCABULARY, formulas
from support.generators.timed_formulas import comparison

DECLARATIONS = """
rulebook printed
type thing
type car is thing
place(t: thing) is one of near, far, gone
light is one of red, green default red
signal p default false
signal q
"""


@given(formulas)
def test_words_can_be_read_back(formula):
    variables = "(x: thing)" if any(atom.arguments for atom in atoms_of(formula)) else ""
    text = f"{DECLARATIONS}\nhard rule A {variables} {{ require {formula_text(formula)} }}"
    (rule,) = parse_rulebook(text).rules
    assert rule.formula == formula


def test_the_declarations_are_those_of_the_formulas():
    vocabulary = parse_rulebook(f"{DECLARATIONS}\nhard rule A {{ require p }}").vocabulary
    assert vocabulary.declarations == VOCABULARY.declarations
    assert str(Atom("place", ("x",), "near")) == "near(x)"


P, Q = Atom("p"), Atom("q")


def bound(low, high, unit="s"):
    return Bound(Fraction(low), None if high is None else Fraction(high), unit)


@pytest.mark.parametrize(
    ("formula", "text"),
    [
        (Unary(UnaryOperator.EVENTUALLY, P, bound(0, 3)), "eventually[<= 3 s] p"),
        (Unary(UnaryOperator.ALWAYS, P, bound(1, 4)), "always[1 s .. 4 s] p"),
        (Unary(UnaryOperator.NEVER, P, bound("0.5", 1)), "never[0.5 s .. 1 s] p"),
        (Unary(UnaryOperator.NEXT, P, bound(2, 2, "steps")), "next[2 steps] p"),
        (Unary(UnaryOperator.WEAK_NEXT, P, bound(1, 1, "steps")), "weak next[1 step] p"),
        (Unary(UnaryOperator.PREVIOUSLY, P, bound(0, 0, "steps")), "previously[0 steps] p"),
        (Unary(UnaryOperator.ONCE, P, bound(2, None, "steps")), "once[>= 2 steps] p"),
        (Unary(UnaryOperator.ONCE, P, bound(2, 2, "steps")), "once[2 steps .. 2 steps] p"),
        (Unary(UnaryOperator.ONCE, P, bound(0, 1, "steps")), "once[<= 1 step] p"),
        (Binary(BinaryOperator.UNTIL, P, Q, bound(0, 3)), "p until[<= 3 s] q"),
        (Binary(BinaryOperator.WEAK_UNTIL, P, Q, bound(0, 3)), "p weak until[<= 3 s] q"),
        (
            Binary(
                BinaryOperator.AND,
                Binary(BinaryOperator.THEN, P, Q, bound(1, "1.5")),
                Unary(UnaryOperator.NOT, comparison("speed", ">=", 3)),
            ),
            "(p then[1 s .. 1.5 s] q) and not speed >= 3",
        ),
        (
            Unary(UnaryOperator.ALWAYS, Binary(BinaryOperator.OR, comparison("speed", "<", 1), P)),
            "always (speed < 1 or p)",
        ),
        (Unary(UnaryOperator.NOT, Same("x", "y")), "not x = y"),
    ],
)
def test_bounds_and_numbers_in_words(formula, text):
    assert formula_text(formula) == text


def test_terms_in_words():
    assert term_text(QuantityTerm("speed")) == "speed"
    assert term_text(QuantityTerm("gap", ("v", "w"))) == "gap(v, w)"
    count = Count("c", "car", Binary(BinaryOperator.AND, P, Same("c", "v")))
    assert term_text(count) == "count c: car (p and c = v)"


def test_times_in_words():
    assert time_in_words(Fraction(1), "s") == "1 s"
    assert time_in_words(Fraction(1), "steps") == "1 step"
    assert time_in_words(Fraction(0), "steps") == "0 steps"
    assert number_in_words(Fraction(5, 18)) == "5/18"
    assert number_in_words(Fraction(-1, 8)) == "-0.125"
    assert number_in_words(Fraction(1200)) == "1200"
    assert number_in_words(Fraction(2001, 20)) == "100.05"


@given(st.fractions())
def test_numbers_in_words_are_exact(number):
    assert Fraction(number_in_words(number)) == number

"""What decides a formula's value is enough for it, and no more than a reader would name."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.causes import instants_among
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator, atoms_of
from rulec.logic.semantics import holds
from rulec.monitoring.explain.observed_states import ObservedWord, bits_of
from support.generators.random_formulas import formulas, letters, words
from support.generators.timed_formulas import letters_of, timed_formulas, timed_words

P, Q = Atom("p"), Atom("q")


def deciding(formula, word, semantics="stutter", since=0):
    truths = {atom: bits_of([atom in own for own in word]) for atom in set(atoms_of(formula))}
    known = ObservedWord(truths, len(word), semantics).parts(formula)
    decides = instants_among(known, formula, len(word), semantics, since)
    assert decides.keys() == known.keys()
    return decides


def check(formula, word, semantics, chance):
    decides = deciding(formula, word, semantics, chance.randrange(len(word)))
    assert decides[formula][0]
    # Elsewhere the atoms may be as they like.
    other = [
        frozenset(
            atom
            for atom in set(atoms_of(formula))
            if (atom in letter if decides[atom][instant] else chance.random() < 0.5)
        )
        for instant, letter in enumerate(word)
    ]
    assert holds(formula, other, semantics) == holds(formula, word, semantics)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formula=formulas, word=words, chance=st.randoms(use_true_random=False))
def test_the_value_stays_as_long_as_what_decides_does(semantics, formula, word, chance):
    check(formula, letters(word), semantics, chance)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formula=timed_formulas, word=timed_words, chance=st.randoms(use_true_random=False))
def test_the_same_with_bounds_and_a_past(semantics, formula, word, chance):
    check(formula, letters_of(formula, word), semantics, chance)


def test_the_first_failure_decides_or_the_first_from_an_instant_on():
    always = Unary(UnaryOperator.ALWAYS, P)
    word = word_of("FTFTF", "FFFFF")
    assert [deciding(always, word, since=n)[P].index(True) for n in range(5)] == [0, 2, 2, 4, 4]
    never = Unary(UnaryOperator.NEVER, P)
    assert [deciding(never, word, since=n)[P].index(True) for n in range(5)] == [1, 1, 3, 3, 1]


def binary(operator, left, right):
    return Binary(BinaryOperator(operator), left, right)


def unary(operator, operand):
    return Unary(UnaryOperator(operator), operand)


def word_of(p, q):
    return [
        frozenset(atom for atom, value in ((P, a), (Q, b)) if value == "T")
        for a, b in zip(p, q, strict=True)
    ]


# The instants at which p and q decide what holds at the first one, worked out by hand.
CASES = {
    "of two false operands the first": (binary("and", P, Q), "FT", "FT", "x.", ".."),
    "both true ones": (binary("and", P, Q), "TT", "TT", "x.", "x."),
    "the first failure": (unary("always", P), "TFTF", "FFFF", ".x..", "...."),
    "the first that must never be": (unary("never", P), "FFTT", "FFFF", "..x.", "...."),
    "all that hold": (unary("always", P), "TTT", "FFF", "xxx", "..."),
    "all that fail": (unary("eventually", P), "FFF", "FFF", "xxx", "..."),
    "the way there": (binary("until", P, Q), "TTFT", "FFTT", "xx..", "..x."),
    "where the way breaks": (binary("until", P, Q), "TFTT", "FFTT", ".x..", "xx.."),
    "it never comes": (binary("until", P, Q), "TTT", "FFF", "...", "xxx"),
    "all of the way will do": (binary("weak until", P, Q), "TTT", "FFF", "xxx", "..."),
    "what frees, and what it frees from": (binary("release", P, Q), "FTF", "TTF", ".x.", "xx."),
    "a first phase takes an instant": (binary("then", P, Q), "TTF", "TFT", "xx.", "..x"),
    "what was before": (unary("eventually", unary("previously", P)), "FTF", "FFF", ".x.", "..."),
}


@pytest.mark.parametrize("case", CASES)
def test_nothing_else_decides(case):
    formula, p, q, of_p, of_q = CASES[case]
    decides = deciding(formula, word_of(p, q))
    none = [False] * len(p)
    assert decides.get(P, none) == [one == "x" for one in of_p]
    assert decides.get(Q, none) == [one == "x" for one in of_q]

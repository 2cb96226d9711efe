"""What a formula reads of numbers, and what is known of its propositions."""

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import assume, given

from rulec.automata.alphabet import (
    count_letters,
    knowledge,
    letters_with,
    names_of,
    propositions_of,
    reads_of,
)
from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.logic.formula import Atom, Binary, BinaryOperator, Constant
from rulec.logic.printing import formula_text
from rulec.logic.semantics import holds
from support.generators.timed_formulas import (
    CARS,
    SUMS,
    TIMED_VOCABULARY,
    comparison,
    is_true,
    letter_number,
    timed_formulas,
    timed_states,
)


def all_of(*formulas):
    joined = formulas[0]
    for one in formulas[1:]:
        joined = Binary(BinaryOperator.AND, joined, one)
    return joined


def thresholds(of, *relations):
    """Of the one number that these comparisons, each `>= 3` or the like, read."""
    formula = all_of(*(comparison(of, *reversed(text)) for text in map(parts, relations)))
    (read,) = reads_of(formula, TIMED_VOCABULARY)
    assert isinstance(read, NumberRead)
    assert read.terms == SUMS[of]
    return [(">=" if one.inclusive else ">") + f" {one.limit}" for one in read.thresholds]


def parts(text):
    relation, limit = text.split()
    return Fraction(limit), relation


def test_a_relation_needs_the_side_of_its_limit_that_it_asks_about():
    assert thresholds("speed", "< 3") == thresholds("speed", ">= 3") == [">= 3"]
    assert thresholds("speed", "<= 3") == thresholds("speed", "> 3") == ["> 3"]
    assert thresholds("speed", "= 3") == thresholds("speed", "!= 3") == [">= 3", "> 3"]
    assert thresholds("speed", "> 5", "> 3/2", "= 3", "<= 3") == ["> 3/2", ">= 3", "> 3", "> 5"]


CARS_TEXT = "count y: car (near(y))"


def test_a_count_is_a_whole_number():
    assert thresholds(CARS_TEXT, "<= 2") == thresholds(CARS_TEXT, "< 3") == [">= 3"]
    assert thresholds(CARS_TEXT, "> 5/2") == thresholds(CARS_TEXT, ">= 5/2") == [">= 3"]
    assert thresholds(CARS_TEXT, "= 2") == [">= 2", ">= 3"]
    assert thresholds(CARS_TEXT, "= 0") == thresholds(CARS_TEXT, "> 0") == [">= 1"]
    # Always, or never, so.
    assert thresholds(CARS_TEXT, ">= 0", "< -1/2") == []


def test_comparisons_of_one_number_share_a_read():
    formula = all_of(
        comparison("speed", ">", 50),
        Atom("p"),
        comparison("speed", "<", 30),
        comparison(CARS_TEXT, ">=", 2),
    )
    speed, p, cars = reads_of(formula, TIMED_VOCABULARY)
    assert speed.thresholds == (
        Threshold(Fraction(30), inclusive=True),
        Threshold(Fraction(50), inclusive=False),
    )
    assert (speed.size, p.size, cars.size) == (3, 2, 2)
    assert cars.terms == ((1, CARS),)
    digits = [speed.digit(Fraction(n)) for n in (29, 30, 50, 51)]
    assert digits == [0, 1, 1, 2]


@given(timed_formulas, timed_states)
def test_a_states_letter_has_the_propositions_that_are_true_in_it(formula, state):
    propositions = propositions_of(formula)
    reads = reads_of(formula, TIMED_VOCABULARY)
    sets = letters_with(reads, propositions)
    number = letter_number(reads, state)
    for one in propositions:
        assert bool(sets[one] >> number & 1) == is_true(one, state)
        assert sets[one] >> count_letters(reads) == 0


@given(timed_formulas)
def test_what_is_known_is_just_what_letters_have_in_common(formula):
    """Every letter fulfils it, and whatever fulfils it is a letter."""
    propositions = propositions_of(formula)
    reads = reads_of(formula, TIMED_VOCABULARY)
    assume(count_letters(reads) < 200)
    axioms = knowledge(reads, propositions)
    sets = letters_with(reads, propositions)
    letters = {
        frozenset(one for one in propositions if sets[one] >> number & 1)
        for number in range(count_letters(reads))
    }
    for values in product((False, True), repeat=len(propositions)):
        letter = frozenset(one for one, value in zip(propositions, values, strict=True) if value)
        assert holds(axioms, [letter]) == (letter in letters)


def known(*comparisons):
    formula = all_of(*comparisons)
    return formula_text(knowledge(reads_of(formula, TIMED_VOCABULARY), propositions_of(formula)))


def test_faster_than_50_is_faster_than_30_and_no_more_is_said():
    limits = [comparison("speed", ">", limit) for limit in (50, 30, 70, 10)]
    axioms = known(*limits).replace("(", "").replace(")", "").split(" and ")
    assert sorted(axioms) == [
        "speed > 30 implies speed > 10",
        "speed > 50 implies speed > 30",
        "speed > 70 implies speed > 50",
    ]
    assert known(comparison("speed", "<", 3), comparison("speed", ">=", 3)) in (
        "speed >= 3 iff not speed < 3",
        "not speed < 3 iff speed >= 3",
    )
    assert known(comparison("speed", ">", 3)) == "true"
    assert known(comparison(CARS_TEXT, ">=", 0)) == f"{CARS_TEXT} >= 0"


def test_names_are_texts_unless_two_have_the_same():
    slow, fast = comparison("speed", "<", 1), comparison("speed", ">", 1)
    like_slow = type(fast)(fast.terms, fast.relation, fast.limit, slow.text)
    assert list(names_of([slow, Atom("p"), fast]).values()) == ["speed < 1", "p", "speed > 1"]
    assert list(names_of([slow, slow, like_slow]).values()) == ["speed < 1", "speed < 1 (2)"]


@pytest.mark.parametrize("value", [True, False])
def test_a_constant_reads_nothing(value):
    assert reads_of(Constant(value), TIMED_VOCABULARY) == ()
    assert knowledge((), ()) == Constant(True)
    assert count_letters(()) == 1

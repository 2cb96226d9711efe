"""Synthesised states are read back, and numbers near thresholds are near them."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic.formula import Atom, Count, QuantityTerm
from rulec.vocabulary.vocabulary_model import default_value
from rulec.witnesses.state_synthesis import (
    JointState,
    are_consistent,
    default_digit,
    float_values,
    numbers_near_thresholds,
    solve_numbers,
    subjects_of,
    value_literal,
    value_of,
)
from support.generators.random_reads import (
    GAP,
    NUMBERS,
    SPEED,
    VOCABULARY,
    digit,
    exact_values,
    number_reads,
)

described = st.lists(
    st.tuples(number_reads, st.integers(0, 2)), min_size=1, max_size=3, unique_by=lambda one: one[0]
)


@given(described)
def test_numbers_have_the_digits_and_none_are_missed(pairs):
    digits = [(read, min(number, read.size - 1)) for read, number in pairs]
    met = any(all(digit(read, state) == wanted for read, wanted in digits) for state in NUMBERS)
    numbers = solve_numbers(digits, VOCABULARY, {})
    assert (numbers is not None) >= met
    assert are_consistent(digits) is (numbers is not None)
    near = numbers_near_thresholds(digits, VOCABULARY)
    assert (near is not None) >= met
    if numbers is not None:
        state = JointState(float_values(numbers))
        assert all(digit(read, exact_values(state)) == wanted for read, wanted in digits)
    if near is not None:
        values = {(term.name, term.arguments): Fraction(str(near[term])) for term in near}
        assert all(digit(read, values) == wanted for read, wanted in digits)


def passing(*limits, inclusive=True):
    return tuple(Threshold(Fraction(limit), inclusive) for limit in limits)


@pytest.mark.parametrize(
    ("term", "limits", "inclusive", "number", "expected"),
    [
        (SPEED, ["50"], True, 0, 49),
        (SPEED, ["50"], True, 1, 50),
        (SPEED, ["50"], False, 0, 50),
        (SPEED, ["50"], False, 1, 51),
        (SPEED, ["0.5"], True, 0, 0),
        (SPEED, ["0.5"], True, 1, 1),
        (GAP, ["0.5", "0.75"], True, 1, 0.5),
        (GAP, ["0.52", "0.55"], False, 1, 0.53),
    ],
)
def test_a_number_near_a_threshold_is_the_roundest_one_beside_it(
    term, limits, inclusive, number, expected
):
    read = NumberRead(((Fraction(1), term),), passing(*limits, inclusive=inclusive))
    assert numbers_near_thresholds([(read, number)], VOCABULARY) == {term: expected}


def test_others_of_a_sum_have_their_defaults():
    read = NumberRead(((Fraction(1), GAP), (Fraction(-2), SPEED)), passing(10))
    assert numbers_near_thresholds([(read, 1)], VOCABULARY) == {GAP: 12.0, SPEED: 1.0}
    turned = NumberRead(((Fraction(1), SPEED), (Fraction(-2), GAP)), passing(10))
    # Nothing is the default of a gap, so it is zero.
    assert numbers_near_thresholds([(turned, 1)], VOCABULARY) == {SPEED: 10.0, GAP: 0.0}


def test_what_no_float_is_cannot_be_near():
    read = NumberRead(((Fraction(1), SPEED),), passing("1e400"))
    assert numbers_near_thresholds([(read, 1)], VOCABULARY) is None


def test_defaults_are_taken_where_they_fit():
    read = NumberRead(((Fraction(1), SPEED),), passing(1))
    assert solve_numbers([(read, 1)], VOCABULARY, {}) == {SPEED: 1}
    assert solve_numbers([(read, 0)], VOCABULARY, {}) == {SPEED: 0}
    below = NumberRead(((Fraction(1), SPEED),), passing(-3))
    assert solve_numbers([(below, 0)], VOCABULARY, {}) == {SPEED: -4}


def test_counts_are_whole_and_as_many_as_count_already():
    count = Count("o", "thing", Atom("place", ("o",), "near"))
    read = NumberRead(((Fraction(1), count),), passing(2, 4))
    assert solve_numbers([(read, 1)], VOCABULARY, {count: 3}) == {count: 3}
    assert solve_numbers([(read, 0)], VOCABULARY, {count: 3}) is None
    halves = NumberRead(((Fraction(2), count),), passing(1, 2))
    assert solve_numbers([(halves, 1)], VOCABULARY, {count: 0}) is None
    assert not are_consistent([(halves, 1)])
    low = NumberRead(((Fraction(1), count),), passing(0))
    assert not are_consistent([(low, 0)])


def test_values_of_digits():
    rest = Read("place", ("x",), ("near",), others=True)
    assert value_of(rest, 0, VOCABULARY) == "near"
    # Of the others the default stands for all.
    assert value_of(rest, 1, VOCABULARY) == "far"
    without = Read("place", ("x",), ("far",), others=True)
    assert value_of(without, 1, VOCABULARY) == "near"
    assert value_of(Read("p", ()), 1, VOCABULARY) is True


def test_defaults():
    assert default_value(VOCABULARY.declarations["q"]) is False
    assert default_value(VOCABULARY.declarations["gap"]) == 0.0
    assert default_value(VOCABULARY.declarations["place"]) == "far"
    assert default_digit(Read("p", ()), VOCABULARY) == 1
    assert default_digit(Read("q", ("x",)), VOCABULARY) is None
    own = NumberRead(((Fraction(3), SPEED),), passing(2, 4))
    assert default_digit(own, VOCABULARY) == 1
    assert default_digit(NumberRead(((Fraction(1), GAP),), passing(2)), VOCABULARY) is None


def test_subjects_are_all_that_a_state_could_say():
    subjects = [subject for subject, _ in subjects_of(VOCABULARY, {"x": "thing", "y": "thing"})]
    assert subjects == [
        ("p", ()),
        *(("q", (name,)) for name in "xy"),
        *(("place", (name,)) for name in "xy"),
        ("speed", ()),
        *(("gap", (name,)) for name in "xy"),
    ]
    objects, names = {"x": "thing"}, frozenset({"gap", "p", "nobody's"})
    some = [subject for subject, _ in subjects_of(VOCABULARY, objects, names)]
    assert some == [("p", ()), ("gap", ("x",))]
    assert QuantityTerm("speed") == SPEED


@given(described, described)
def test_sums_that_share_no_term_are_solved_as_if_alone(pairs, others):
    own = [(read, min(number, read.size - 1)) for read, number in pairs]
    terms = {term for read, _ in own for _, term in read.terms}
    apart = [
        (read, min(number, read.size - 1))
        for read, number in others
        if terms.isdisjoint(term for _, term in read.terms)
    ]
    found, alone, rest = (solve_numbers(x, VOCABULARY, {}) for x in (own + apart, own, apart))
    assert (found is None) == (alone is None or rest is None)
    if found is not None and min(found.values(), default=0) >= 0:
        assert found == alone | rest


def test_values_as_an_example_says_them():
    said = {("p", ()): True, ("q", ("x",)): False, ("place", ("x",)): "far"}
    said |= {("gap", ("x",)): 0.1}
    declared = VOCABULARY.declarations
    literals = [
        value_literal(subject, value, declared[subject[0]]) for subject, value in said.items()
    ]
    assert literals == ["p", "not q(x)", "far(x)", "gap(x) = 0.1 m"]

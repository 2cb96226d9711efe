"""Numbers count as they are written, and the fast way to compare them is the exact one."""

from fractions import Fraction
from math import inf, nextafter

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.automata.thresholds import bound_in_floats, exact, floor_of, scale
from rulec.logic.formula import Comparison, Constant, Count, QuantityTerm
from rulec.logic.linear_comparison import stands

floats = st.floats(allow_nan=False, allow_infinity=False)
SPEED = QuantityTerm("speed", ("v",))


@st.composite
def limits(draw):
    """Any fraction, a decimal that a float stands for, or one that hardly differs from it."""
    near = Fraction(repr(draw(floats)))
    little = draw(st.sampled_from([Fraction(0), Fraction(1, 10**30), Fraction(-1, 10**30)]))
    return draw(st.fractions() | st.just(near + little) | st.just(near * 10**20))


@st.composite
def scales(draw):
    ascending = sorted(set(draw(st.lists(st.tuples(limits(), st.booleans()), max_size=4))))
    # Where limits are equal, what the limit itself passes comes first.
    ascending.sort(key=lambda one: (one[0], not one[1]))
    thresholds = tuple(Threshold(limit, inclusive) for limit, inclusive in ascending)
    return NumberRead(((Fraction(1), SPEED),), thresholds)


def test_a_number_is_the_decimal_that_is_written():
    assert exact(0.1) == Fraction(1, 10)
    assert exact(-0.0) == 0
    assert exact(1e23) == 10**23
    # What 1e23 is to the machine is another number, and so is the whole number that it is.
    assert exact(99999999999999991611392) == 99999999999999991611392
    assert exact(10**400) == 10**400


def test_a_subclass_of_float_is_read_as_its_value():
    class Own(float):
        def __repr__(self):
            return "Own"

    assert exact(Own(0.1)) == Fraction(1, 10)


@given(limits(), st.sampled_from(["<", "<=", ">=", ">"]), floats, st.booleans())
@example(Fraction(1, 10), "<", 0.1, False)
@example(Fraction(1, 10), ">", 0.1, False)
@example(Fraction(10**400), "<", 0.1, False)
def test_a_bound_of_floats_is_that_of_their_decimals(limit, relation, value, near):
    if near and abs(limit) < 10**300:
        value = float(limit)
    found = bound_in_floats(Comparison(((Fraction(1), SPEED),), relation, limit))
    assert found is not None
    term, is_met = found
    assert term == SPEED
    assert is_met(value) is stands(exact(value), relation, limit)


def test_equality_and_sums_have_no_bound_of_floats():
    assert bound_in_floats(Comparison(((Fraction(1), SPEED),), "=", Fraction(1))) is None
    assert bound_in_floats(Comparison(((Fraction(1), SPEED),) * 2, "<", Fraction(1))) is None


@given(scales(), floats | st.integers())
@example(NumberRead(((Fraction(1), SPEED),), (Threshold(Fraction(1, 10), True),)), 0.1)
@example(NumberRead(((Fraction(1), SPEED),), (Threshold(Fraction(1, 10), False),)), 0.1)
@example(NumberRead(((Fraction(1), SPEED),), (Threshold(Fraction(2**53 + 1), True),)), 2**53 + 1)
@example(NumberRead(((Fraction(1), SPEED),), (Threshold(Fraction(10**23), True),)), 10**23 - 1)
def test_the_fast_way_is_the_exact_way(read, value):
    assert scale(read).quantity == SPEED
    assert scale(read).digit(value) == read.digit(exact(value))


@given(scales(), st.data())
def test_the_fast_way_is_the_exact_way_beside_the_limits(read, data):
    """Where the two would differ, if they did."""
    for threshold in read.thresholds:
        value = floor_of(threshold)
        for _ in range(data.draw(st.integers(0, 3))):
            value = nextafter(value, data.draw(st.sampled_from([inf, -inf])))
        if abs(value) < inf:
            assert scale(read).digit(value) == read.digit(exact(value))


@given(limits(), st.booleans())
def test_a_floor_passes_and_what_is_below_does_not(limit, inclusive):
    threshold = Threshold(limit, inclusive)
    read = NumberRead((), (threshold,))
    floor = floor_of(threshold)
    if abs(floor) < inf:
        assert read.digit(exact(floor)) == 1
    below = nextafter(floor, -inf)
    if abs(below) < inf:
        assert read.digit(exact(below)) == 0


@pytest.mark.parametrize("limit", [Fraction(10**400), Fraction(-(10**400))])
def test_limits_beyond_all_floats(limit):
    passes = limit < 0
    assert floor_of(Threshold(limit, True)) == (-inf if passes else inf)
    read = NumberRead(((Fraction(1), SPEED),), (Threshold(limit, True),))
    for value in (1.7976931348623157e308, -1.7976931348623157e308, 0.0):
        assert scale(read).digit(value) == passes


def test_what_a_number_depends_on():
    near = Count("x", "car", Constant(True))
    gap = QuantityTerm("gap", ("v", "w"))
    read = NumberRead(((Fraction(1), near), (Fraction(2), gap), (Fraction(-1), SPEED)), ())
    assert scale(read).variables == ("v", "w")
    assert scale(read).quantity is None
    # Twice a quantity is no quantity.
    assert scale(NumberRead(((Fraction(2), gap),), ())).quantity is None

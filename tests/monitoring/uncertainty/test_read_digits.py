"""Digits of sums in floats are those of exact numbers, or left to these."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.vocabulary.partial_values import UNKNOWN, Interval

FACTORS = st.sampled_from([Fraction(x) for x in ("1", "-1", "9/5", "-1/2", "1/3", "-5/18", "100")])
TENTHS = st.integers(-500, 500).map(lambda n: n / 10)
NUMBERS = st.one_of(TENTHS, TENTHS.map(lambda x: x + 1e-9), st.sampled_from([1e-300, 1e200]))
VALUES = st.one_of(NUMBERS, st.tuples(NUMBERS, NUMBERS).map(lambda x: Interval(min(x), max(x))))


@st.composite
def sums(draw):
    """A read of two quantities or three, and their values."""
    factors = draw(st.lists(FACTORS, min_size=2, max_size=3))
    terms = [(own, ltl.QuantityTerm(f"q{n}", ())) for n, own in enumerate(factors)]
    values = [draw(VALUES) for _ in factors]
    ends = [ends_of(value)[0] * own for value, own in zip(values, factors, strict=True)]
    # Among the limits is what the sum may come to, and what is close to it
    near = st.sampled_from([sum(ends), sum(ends) + Fraction(1, 10**8), Fraction(3, 7)])
    limits = draw(st.lists(st.one_of(near, TENTHS.map(exact)), min_size=1, max_size=3, unique=True))
    inclusive = draw(st.booleans())
    thresholds = tuple([Threshold(own, inclusive) for own in sorted(limits)])
    return NumberRead(tuple(terms), thresholds), values


def ends_of(value):
    ends = (value.low, value.high) if isinstance(value, Interval) else (value, value)
    return tuple(map(exact, ends))


@given(sums())
def test_the_digits_of_a_sum_are_exact_or_left_open(drawn):
    read, values = drawn
    found = read_digits(read).of_sum(values)
    if found is None:
        return
    low = high = Fraction(0)
    for (factor, _), value in zip(read.terms, values, strict=True):
        ends = [factor * end for end in ends_of(value)]
        low, high = low + min(ends), high + max(ends)
    digits = range(read.digit(low), read.digit(high) + 1)
    assert found == sum(1 << digit for digit in digits)


def test_what_is_near_no_limit_takes_no_exact_numbers():
    gap, speed = ltl.QuantityTerm("gap", ()), ltl.QuantityTerm("speed", ())
    read = NumberRead(
        ((Fraction(1), gap), (Fraction(-1, 2), speed)), (Threshold(Fraction(0), True),)
    )
    ready = read_digits(read)
    assert ready.summands == (("gap", ()), ("speed", ()))
    assert ready.of_sum([30.0, 50.0]) == 0b10
    assert ready.of_sum([20.0, 50.0]) == 0b01
    assert ready.of_sum([Interval(20.0, 30.0), 50.0]) == 0b11
    assert ready.of_sum([25.0, 50.0]) is None
    assert ready.of_sum([UNKNOWN, 50.0]) is None
    assert ready.of_sum([1e308, -1.7e308]) is None

"""Bounds in seconds as steps."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.bounds import (
    Range,
    between_instants,
    has_seconds,
    in_steps,
    operations_of,
    range_of,
    total_bound,
)
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator
from rulec.logic.printing import formula_text
from support.generators.timed_formulas import formulas_in, timed_formulas

P, Q = Atom("p"), Atom("q")
QUARTER = Fraction(1, 4)


def within(low, high, unit="s"):
    high = None if high is None else Fraction(high)
    return Bound(Fraction(low), high, unit)


def test_seconds_become_steps():
    formula = Binary(
        BinaryOperator.UNTIL,
        Unary(UnaryOperator.ONCE, P, within("0.5", None)),
        Unary(UnaryOperator.NEXT, Q, within(2, 2, "steps")),
        within(0, 3),
    )
    assert has_seconds(formula)
    steps = in_steps(formula, QUARTER)
    assert not has_seconds(steps)
    assert formula_text(steps) == "once[>= 2 steps] p until[<= 12 steps] next[2 steps] q"
    assert total_bound(steps) == 2 + 2 + 12


def test_a_bound_between_two_states_is_named():
    formula = Binary(
        BinaryOperator.AND,
        Unary(UnaryOperator.ALWAYS, P, within(0, "3.25")),
        Unary(UnaryOperator.ALWAYS, P, within("0.1", 3)),
    )
    assert between_instants(formula, Fraction(1, 2)) == (Fraction(13, 4), None)
    assert between_instants(formula, QUARTER) == (Fraction(1, 10), None)
    assert between_instants(formula, Fraction(1, 20)) is None


ends = st.fractions(0, 20)


@given(ends, st.none() | ends, st.fractions(Fraction(1, 100), 3), st.integers(0, 2000))
def test_a_bound_holds_the_states_whose_distance_in_seconds_is_in_it(low, high, step, away):
    bounded = Unary(UnaryOperator.ONCE, P, Bound(low, high, "s"))
    steps = range_of(in_steps(bounded, step))
    is_in = low <= away * step and (high is None or away * step <= high)
    assert is_in is (steps.low <= away and (steps.high is None or away <= steps.high))


@pytest.mark.parametrize("step", [Fraction(0), Fraction(-1, 2)])
def test_a_step_takes_time(step):
    with pytest.raises(ValueError, match="more than 0 s"):
        in_steps(P, step)


def test_ranges():
    assert range_of(Unary(UnaryOperator.NEXT, P)) == Range(1, 1)
    assert range_of(Unary(UnaryOperator.ALWAYS, P)) == Range(0, None)
    assert range_of(Binary(BinaryOperator.THEN, P, Q)) == Range(1, None)
    assert range_of(Binary(BinaryOperator.THEN, P, Q, within(0, 2, "steps"))) == Range(1, 2)
    for bound in (within(1, 2), within("0.5", 2, "steps"), within(1, "1.5", "steps")):
        with pytest.raises(ValueError, match="step"):
            range_of(Unary(UnaryOperator.ALWAYS, P, bound))


steps = st.fractions(Fraction(1, 100), 10)


@given(st.data(), steps)
def test_as_many_steps_as_there_are_in_the_seconds(data, step):
    seconds = data.draw(formulas_in("s", step))
    assert not has_seconds(in_steps(seconds, step))
    coarse, fine = (in_steps(seconds, one) for one in (step, step / 3))
    for one, finer in zip(operations_of(coarse), operations_of(fine), strict=True):
        if one.bound is not None:
            assert finer.bound.low == 3 * one.bound.low
            assert finer.bound.high == (None if one.bound.high is None else 3 * one.bound.high)


@given(timed_formulas, steps)
def test_bounds_in_steps_are_the_same_for_any_step(formula, step):
    assert not has_seconds(formula)
    assert in_steps(formula, step) == formula

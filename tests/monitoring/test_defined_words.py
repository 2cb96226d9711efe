"""Words by their meanings: by arrays, by states, in a monitor, and calculated by hand."""

from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from regression import ledger_traces
from rulec import (
    UNKNOWN,
    Interval,
    Monitor,
    RulecError,
    Trace,
    compile_rulebook,
    load_rulebook,
    parse_rulebook,
    verify,
)
from rulec.monitoring.batch.by_states import verify_by_states

BOOK = compile_rulebook(
    parse_rulebook(
        """rulebook b
type car
quantity speed in km/h default 0
quantity gap(c: car) in m default 1000
quantity speed_of(c: car) in km/h default 0
signal behind(c: car) default false
signal slow default false
signal close(c: car) default false
param reaction : time = 1 s
param braking : acceleration = 8 m/s^2
define close(c: car) = behind(c) and
  gap(c) < reaction * speed + (speed * speed - speed_of(c) * speed_of(c)) / (2 * braking)
define slow = historically[<= 2 s] speed < 30 km/h and some c: car (close(c))
hard rule keeps(c: car) { require always not close(c) }
hard rule flows { require always not slow }
hard rule headway(c: car) { require always (behind(c) implies gap(c) / speed >= 1 s) }
"""
    )
)
BASES = frozenset({"speed", "gap", "speed_of", "behind", "car"})
TOLD = (None, BASES, BASES - {"speed_of"}, BASES | {"slow"})


def numbers(most):
    """Halves up to ``most``, some known only as an interval, some unknown."""
    halves = st.integers(0, 2 * most).map(lambda n: n / 2)
    widths = st.sampled_from((0.5, 2.0, 10.0))
    between = st.tuples(halves, widths).map(lambda x: Interval(x[0], x[0] + x[1]))
    huge = st.sampled_from((1e160, 1e200, 3e200, 1.7e308))
    return st.one_of(halves, halves, halves, between, huge, st.just(UNKNOWN))


PARTLY = compile_rulebook(
    parse_rulebook(
        """rulebook p
type car
quantity gap(c: car) in m default 1000
signal behind(c: car), hurries default false
signal close(c: car), clings(c: car), jostles default false
define close(c: car) = behind(c) and gap(c) < 10 m
define clings(c: car) = close(c) since[>= 1 s] true
define jostles = hurries and some c: car (close(c))
hard rule keeps(c: car) { require always not close(c) }
hard rule parts(c: car) { require always not clings(c) }
hard rule calm { require always not jostles }
hard rule catches_up(c: car) { require always (hurries implies close(c)) }
"""
    )
)


@pytest.mark.parametrize(
    ("behind", "violated", "still_open", "asked"),
    [(False, {"catches_up"}, set(), ()), (True, set(), {"catches_up"}, ("keeps", "calm"))],
)
def test_what_is_not_told_matters_where_it_decides(behind, violated, still_open, asked):
    """Who is not behind is not close, whatever the gap; that somebody is close nobody can know.

    Nor can anybody have been close for a second, in a single state.
    """
    told = frozenset({"behind", "hurries", "car"})
    trace = Trace("t", 1.0, {"o": "car"}, ({"hurries": True, "behind": {"o": behind}},), told=told)
    verdict = verify(trace, PARTLY)
    assert verdict == verify_by_states(trace, PARTLY)
    assert {own.rule for own in verdict.violations} == violated
    assert {own.rule for own in verdict.open} == still_open
    lacking = {own.rule: own.untold for own in verdict.not_judged}
    assert lacking == dict.fromkeys(asked, ("gap",))
    assert {*verdict.kept_regardless, *lacking} == {"keeps", "parts", "calm"}
    monitor = Monitor(PARTLY, 1.0, told=told, cut=False)
    assert {*monitor.not_judged} == {"keeps", "parts", "calm"}


TRUTHS = st.sampled_from((True, True, False, UNKNOWN))


@st.composite
def traces(draw, numbers=numbers, truths=TRUTHS):
    objects = {f"o{n}": "car" for n in range(draw(st.integers(1, 3)))}
    n_states, told = draw(st.integers(1, 5)), draw(st.sampled_from(TOLD))
    present = {}
    if len(objects) > 1 and draw(st.booleans()):
        present["o1"] = (draw(st.integers(0, n_states - 1)), n_states - 1)
    states = []
    for n in range(n_states):
        there = [x for x in objects if present.get(x, (0, 0))[0] <= n]
        state = {
            "speed": draw(numbers(100)),
            "gap": {x: draw(numbers(60)) for x in there},
            "behind": {x: draw(truths) for x in there},
        }
        if told is None or "speed_of" in told:
            state["speed_of"] = {x: draw(numbers(100)) for x in there}
        if told is not None and "slow" in told:
            state["slow"] = draw(truths)
        states.append(state)
    step_s, ends = (
        draw(st.sampled_from((1.0, 0.5, 0.7))),
        draw(st.sampled_from(("complete", "cut"))),
    )
    return Trace("t", step_s, objects, tuple(states), present, ends=ends, told=told)


@given(traces())
def test_arrays_and_states_agree(trace):
    assert verify(trace, BOOK) == verify_by_states(trace, BOOK)


@given(traces())
def test_a_monitor_finds_what_one_state_shows(trace):
    """What a meaning says of the past is unknown there, so `flows` is left out."""
    monitor = Monitor(BOOK, trace.step_s, told=trace.told, cut=trace.ends == "cut")
    for state, objects in trace.steps():
        monitor.step(state, objects)

    def found(violations):
        return {(x.rule, *x.binding.values(), x.step) for x in violations if x.rule != "flows"}

    assert found(monitor.violations) == found(verify(trace, BOOK).violations)


def ends_of(value):
    return (value.low, value.high) if isinstance(value, Interval) else (value, value)


def is_close(speed, gap, other):
    """As the book says, in m and s, by fractions."""
    own, theirs = (Fraction(x) * 5 / 18 for x in (speed, other))
    return Fraction(gap) < own + (own * own - theirs * theirs) / 16


KNOWN = st.integers(0, 200).map(lambda n: n / 2)


@given(KNOWN, KNOWN, KNOWN)
def test_a_known_state_is_calculated_by_hand(speed, gap, other):
    state = {"speed": speed, "gap": {"c": gap}, "speed_of": {"c": other}, "behind": {"c": True}}
    trace = Trace("t", 1.0, {"c": "car"}, (state,), told=BASES)
    verdict = verify(trace, BOOK)
    lost = {x.rule for x in verdict.violations}
    assert ("keeps" in lost) == is_close(speed, gap, other)
    assert ("flows" in lost) == (speed < 30 and is_close(speed, gap, other))
    if speed:
        assert ("headway" in lost) == (Fraction(gap) < Fraction(speed) * 5 / 18)
    else:  # nothing can be divided by 0
        assert [x.rule for x in verdict.open] == ["headway"]


@given(numbers(100), numbers(60), numbers(100))
def test_what_is_partly_known_holds_for_all_that_it_may_be(speed, gap, other):
    """All corners of the intervals, and the speeds at which the difference turns."""
    state = {"speed": speed, "gap": {"c": gap}, "speed_of": {"c": other}, "behind": {"c": True}}
    verdict = verify(Trace("t", 1.0, {"c": "car"}, (state,), told=BASES), BOOK)
    is_lost = "keeps" in {x.rule for x in verdict.violations}
    is_open = "keeps" in {x.rule for x in verdict.open}
    if UNKNOWN in (speed, gap, other):
        assert is_open
        return
    # Closer with more speed, a smaller gap and a slower one ahead: the corners decide
    corners = {is_close(*x) for x in product(*map(ends_of, (speed, gap, other)))}
    assert (is_lost, is_open) == (corners == {True}, len(corners) == 2)


def test_a_told_value_wins():
    """Also in one state only, for one object only."""
    state = {"speed": 100, "gap": {"c": 1}, "behind": {"c": True}, "close": {"c": False}}
    assert "keeps" not in {x.rule for x in verify(trace_of(state), BOOK).violations}
    # A table that does not say what it tells takes the default, as before
    del state["close"]
    assert "keeps" not in {x.rule for x in verify(trace_of(state), BOOK).violations}


def trace_of(*states):
    return Trace("t", 1.0, {"c": "car"}, states)


def test_a_national_book_by_arrays_and_by_states():
    """Its rules are of every kind; where arrays do not tell, a trace is looked at by its states."""
    book = compile_rulebook(load_rulebook("de"))
    told = frozenset({*book.vocabulary.declarations, *book.vocabulary.types})
    told -= {"safe_gap", "can_stop_at_once"}
    known = [*ledger_traces.examples("de"), *ledger_traces.cases("de")]
    judged = 0
    for number, trace in enumerate(ledger_traces.randomized("de", known, 60)):
        states = [{k: v for k, v in x.items() if k in told} for x in trace.states]
        for state in states:
            state.setdefault("speed", float(7 * number % 130))
        trace = replace(trace, states=tuple(states), told=told)
        with suppress(RulecError):  # a state that contradicts a fact
            assert verify(trace, book) == verify_by_states(trace, book)
            judged += 1
    assert judged > 40


def test_numbers_whose_squares_floats_do_not_hold():
    """A metre behind who is slower is too close, however fast both are."""
    own = {"speed": 3e200, "behind": {"o": True}, "speed_of": {"o": 1e200}, "gap": {"o": 1.0}}
    trace = Trace("t", 1.0, {"o": "car"}, (own,), told=BASES)
    verdict = verify(trace, BOOK)
    assert verdict == verify_by_states(trace, BOOK)
    assert {own.rule for own in verdict.violations} >= {"keeps"}

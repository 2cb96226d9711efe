"""For how long others have been ahead in ego's lane, also before anybody saw them."""

from math import sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.api.rulebook_compilation import machines
from rulec.extraction.presences import presence_cells
from rulec.extraction.signals.measured_numbers import LONGEST_S
from rulec.extraction.signals.participants import following_signals
from support.builders.drive_contexts import context_of, steady
from support.builders.drive_verdicts import violated
from support.builders.recordings import recording, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import bounds_of
from support.words import words_of

MPS, STEP_S, PLACE_M = 10.0, 0.5, 0.05
GERMAN = machines("de")


def times(*others, steps=4, **thresholds):
    """At least and at most (s), by state, of the first of the others; ego is at x = 0 first."""
    context = context_of(recording(lanes(2), [steady(7, 0, 0, steps=steps), *others]), **thresholds)
    least, most = map(
        presence_cells(context).laid, bounds_of(words_of(following_signals)(context), "ahead_for")
    )
    return least[0].tolist(), most[0].tolist()


def drifting(number, x, ys):
    """Ahead at ego's speed, at places across the road."""
    return vehicle(number, {k: (x + MPS * STEP_S * k, y) for k, y in enumerate(ys)}, speed=MPS)


def test_who_is_steady_in_the_lane_has_been_there_for_a_while():
    """From 0.3 m clear of ego's side it has come 2.3 m, known to 5 cm, on either side."""
    least, most = times(steady(8, 30, 0))
    came = sqrt(2 * 2.0 * (2.3 - PLACE_M)) / 2.0
    # And its motion sideways is known no better than its speed
    assert came - 0.15 < least[0] < came
    assert np.diff(least).tolist() == pytest.approx([STEP_S] * 3)
    assert most == [LONGEST_S] * 4


def test_who_may_be_slowed_down_harder_may_have_come_later():
    (gently, *_), _ = times(steady(8, 30, 0))
    (hard, *_), _ = times(steady(8, 30, 0), cutting_in_mps2=8.0)
    assert hard == pytest.approx(gently / 2, abs=0.05)


def test_who_comes_in_is_known_to_have_just_come():
    """Its side is 0.5 m clear of ego's, at y = 1, in state 2, and 0.6 m beyond it in state 3."""
    least, most = times(drifting(8, 30, [4.0, 3.25, 2.5, 1.4, 1.0, 0.25]), steps=6)
    assert least == [0, 0, 0, 0, 0.5, 1.0]
    assert most == [0, 0, 0, 0.5, 1.0, 1.5]


def test_when_it_came_in_is_known_no_better_than_places():
    """At y = 2.3 it is 0.3 m clear: in a lane by as little or not, and so for half a second."""
    least, most = times(drifting(8, 30, [4.0, 3.0, 2.3, 1.4, 1.0, 0.25]), steps=6)
    assert least == [0, 0, 0, 0, 0.5, 1.0]
    assert most == [0, 0, 0.5, 1.0, 1.5, 2.0]


def test_who_is_only_just_in_the_lane_may_have_come_this_moment():
    """Its side is 0.55 m in ego's way, and 0.85 m from where it would be clear of it."""
    least, most = times(drifting(8, 30, [1.45, 1.45, 1.45, 1.45]))
    assert 0 < least[0] < sqrt(2 * 2.0 * (0.85 - PLACE_M)) / 2.0
    assert most[0] == LONGEST_S


def test_who_reaches_into_the_lane_only_may_be_at_its_side():
    """Its middle is 0.2 m beyond the mark, and its side 0.2 m clear of ego's."""
    assert times(drifting(8, 30, [2.2, 2.2])) == ([0] * 4, [LONGEST_S] * 2 + [0] * 2)


def test_who_comes_into_sight_later_was_somewhere_before():
    """At 15 m/s from 160 m on ego comes within 150 m of it after two seconds."""
    ego = steady(7, 0, 0, speed=15.0, steps=8)
    context = context_of(recording(lanes(2), [ego, steady(8, 162, 0, steps=8)]))
    first = int(np.flatnonzero(context.relevant[0])[0])
    assert first > 0
    assert bounds_of(words_of(following_signals)(context), "ahead_for")[1][0] == LONGEST_S


def test_who_stands_beside_or_behind_has_not_been_ahead():
    assert times(steady(8, 30, 4)) == ([0] * 4, [0] * 4)
    assert times(steady(8, -30, 0)) == ([0] * 4, [0] * 4)


@given(ends=st.floats(0.3, 2.2), speed=st.floats(0.0, 2.0), slows=st.floats(0.1, 2.0))
def test_nobody_who_slows_down_no_harder_came_earlier_than_said(ends, speed, slows):
    """It got from where it was 0.3 m clear of ego, at y = 2.3, to where it is in so much time."""
    way = 2.3 - ends
    took = (sqrt(speed**2 + 2 * slows * way) - speed) / slows
    least, _ = times(drifting(8, 30, [ends - speed * STEP_S * k for k in range(3)]))
    assert least[0] <= took + 0.01


@pytest.mark.parametrize(("states", "sure"), [(3, False), (5, True)])
def test_a_steady_tailgater_is_one_though_nobody_knows_what_was_before(states, sure):
    """Centred at first sight, it came 1.5 s before at least: after 1.5 s that makes three."""
    cars = [steady(7, 0, 0, speed=28.0, steps=states), steady(8, 10, 0, speed=28.0, steps=states)]
    found = violated(recording(lanes(2), cars), GERMAN, defaults=False)
    assert ("following_distance" in found["7"]) is sure


def test_who_comes_towards_ego_is_not_followed():
    ego, other = steady(7, 0, 0, steps=8), steady(8, 90, 0.5, speed=-2.0, steps=8)
    found = violated(recording(lanes(2), [ego, other]), GERMAN, defaults=False, egos=("7",))
    assert "following_distance" not in found["7"]


@pytest.mark.parametrize("backs", [True, False])
def test_who_backs_towards_ego_is_not_followed(backs):
    """It comes from 18 m ahead to 2 m, or ego draws near to one that slows down; 3 m are too few.

    One that backs has come by itself, whatever ego does.
    """
    start, mps = (18.0, [-2.0] * 9) if backs else (6.5, np.linspace(2.0, 0.4, 9))
    places = start + np.concatenate(([0.0], np.cumsum(mps[:-1]) * STEP_S))
    other = vehicle(8, {k: (x, 0.0) for k, x in enumerate(places)}, speed=2.0, heading=0.0)
    ego = steady(7, 0, 0, speed=2.0, steps=9)
    found = violated(recording(lanes(2), [ego, other]), GERMAN, defaults=False, egos=("7",))
    assert ("following_distance" in found["7"]) is not backs

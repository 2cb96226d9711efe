"""One that slows down for a reason of its own is only perhaps held up by ego at a junction."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import priority_signals
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
EAST = [
    straight(1, -60, -4, successors=(2,)),
    straight(2, -4, 4, predecessors=(1,), successors=(3,), **INSIDE),
    straight(3, 4, 90, predecessors=(2,)),
]
NORTH = [
    lanelet(4, [(0, -90), (0, -4)], successors=(5,)),
    lanelet(5, [(0, -4), (0, 4)], predecessors=(4,), successors=(6,), **INSIDE),
    lanelet(6, [(0, 4), (0, 90)], predecessors=(5,)),
]
TIMES = np.arange(20) / 2
SIDE = "conflict_from_right"
TO_NORTH = [(0.0, -90.0), (0.0, 90.0)]


def told(road, places, path=TO_NORTH, others=()):
    """Whether one that comes from the right is surely in conflict with ego, and whether perhaps.

    Ego goes east at 10 m/s, its front in the other's way at 2 s, its rear past it at 2.5 s.
    ``places``: where the other is along the y axis, every half second.
    """
    ego = vehicle(7, {k: (-20 + 10 * t, 0) for k, t in enumerate(TIMES)}, speed=10)
    other = along(8, np.array(path), np.asarray(places) + 90)
    found = replace(recording([*EAST, *road], [ego, other, *others]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    return bool(values_of(signals, SIDE).any()), bool(unknown_in(signals, SIDE).any())


def slowed(at_2_s, mps, slow_mps, until_s=10.0, then_mps=10.0):
    """Places of one that is as slow as ``slow_mps`` from 2 s until a time."""
    before, slow = np.minimum(TIMES - 2, 0), np.clip(TIMES - 2, 0, until_s - 2)
    return at_2_s + mps * before + slow_mps * slow + then_mps * np.maximum(TIMES - until_s, 0)


# Brakes from 8 to 4 m/s at 2 s, its front 6.3 m before ego's way: at 8 m/s it would be there at
# 2.8 s, half a second after ego has left, and it comes at 3.6 s
HARD = slowed(-10.0, 8, 4)


def test_one_that_brakes_hard_is_held_up_if_nothing_else_tells_it_to():
    assert told(NORTH, HARD) == (True, False)
    gently = -28.0 + np.cumsum(np.concatenate(([0], np.interp(TIMES[:-1], [1, 3.5], [8, 5]) / 2)))
    assert told(NORTH, gently) == (False, True)


def test_one_may_brake_for_its_bend():
    """Beyond ego's way its own one bends, 8 m wide."""
    turns = np.linspace(0, np.pi / 2, 19)
    bend = np.stack([8 * np.cos(turns) - 8, 4 + 8 * np.sin(turns)], axis=1)
    road = [*NORTH[:2], lanelet(6, [*bend, (-90, 12)], predecessors=(5,))]
    assert told(road, HARD, [(0, -90), *bend, (-90, 12)]) == (False, True)


def test_one_may_brake_where_it_drives_aside_and_back_as_onto_a_ring():
    path = [TO_NORTH[0], (0, -12), (3, -7), (0, -2), TO_NORTH[1]]
    assert told(NORTH, HARD, path) == (False, True)


def test_one_may_brake_for_its_sign():
    road = [replace(NORTH[0], signs=frozenset({"YIELD"})), *NORTH[1:]]
    assert told(road, HARD) == (False, True)


@pytest.mark.parametrize(("mps", "at_2_s", "known"), [(1, 8, False), (10, 24, True)])
def test_one_may_brake_for_a_slower_one_ahead_of_it(mps, at_2_s, known):
    """That one is through the junction already."""
    places = {k: (0, at_2_s + mps * (t - 2)) for k, t in enumerate(TIMES)}
    ahead = vehicle(9, places, speed=mps, heading=np.pi / 2)
    assert told(NORTH, HARD, others=(ahead,)) == (known, not known)


@pytest.mark.parametrize(("limit_mps", "known"), [(None, True), (9, True), (5, False), (4, False)])
def test_one_may_brake_for_a_lower_limit_beyond(limit_mps, known):
    road = [*NORTH[:2], replace(NORTH[2], limit_mps=limit_mps)]
    assert told(road, HARD) == (known, not known)


def test_one_may_brake_for_a_limit_that_the_map_does_not_tell():
    road = [*NORTH[:2], replace(NORTH[2], untold_signs=frozenset({"MAX_SPEED"}))]
    assert told(road, HARD) == (False, True)


@pytest.mark.parametrize(("late_s", "known"), [(0.2, True), (0.8, True), (1.2, False)])
def test_one_that_comes_at_once_is_endangered_whatever_it_slows_down_for(late_s, known):
    """It brakes for its sign from 5 to 4 m/s and comes to ego's way, 3 m before the middle."""
    road = [replace(NORTH[0], signs=frozenset({"YIELD"})), *NORTH[1:]]
    assert told(road, slowed(-3 - 4 * (0.5 + late_s), 5, 4)) == (known, not known)


@pytest.mark.parametrize(
    ("mps", "sure"),
    # At 5 m/s it is 1.4 s behind ego all along; at 10 m/s it catches up with it after the bend
    [(5.0, False), (10.0, True)],
)
def test_one_that_joins_ahead_of_a_slow_one_does_not_disturb_it(mps, sure):
    """Ego turns right at 6 m/s, into a road on which another one comes from its left.

    The place where their ways join is 8 m long. As ego leaves it, at 6 s, the other one is just
    before it, and goes on as fast as ever: its body comes where ego's was only later.
    """
    turns = np.linspace(0, np.pi / 2, 19)
    bend = np.stack([8 - 8 * np.cos(turns), 8 * np.sin(turns) - 8], axis=1)
    roads = [
        lanelet(1, [(0, -60), (0, -8)], successors=(2,)),
        lanelet(2, bend, predecessors=(1,), successors=(3,), **INSIDE),
        lanelet(3, [(8, 0), (90, 0)], predecessors=(2, 5)),
        lanelet(4, [(-90, 0), (-8, 0)], successors=(5,)),
        lanelet(5, [(-8, 0), (8, 0)], predecessors=(4,), successors=(3,), **INSIDE),
    ]
    leaves_at_m = 52 + 8 * np.pi / 2 + 2
    ego = along(7, np.array([(0, -60), *bend, (90, 0)]), leaves_at_m + 6 * (TIMES - 6))
    # Its front is at x = 0.5, before the bend comes into its lane, a quarter of a second later
    other = along(8, np.array([(-90, 0), (90, 0)]), 90 - 1.5 + mps * (TIMES - 6.25))
    found = replace(recording(roads, [ego, other]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    side = "conflict_from_left"
    assert bool(values_of(signals, side).any()) == sure
    assert bool(unknown_in(signals, side).any()) != sure

"""One that slows down for a reason of its own is only perhaps held up by ego at a junction."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map.priority_signals import priority_signals
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of

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
WEST = [
    lanelet(11, [(60, 3), (4, 3)], successors=(12,)),
    lanelet(12, [(4, 3), (-4, 3)], predecessors=(11,), successors=(13,), **INSIDE),
    lanelet(13, [(-4, 3), (-60, 3)], predecessors=(12,)),
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
    signals = priority_signals(context_of(found, route=("1", "2", "3")))
    return bool(values_of(signals, SIDE).any()), bool(unknown_in(signals, SIDE).any())


def slowed(at_2_s, mps, slow_mps, until_s=10.0, then_mps=10.0):
    """Places of one that is as slow as ``slow_mps`` from 2 s until a time."""
    before, slow = np.minimum(TIMES - 2, 0), np.clip(TIMES - 2, 0, until_s - 2)
    return at_2_s + mps * before + slow_mps * slow + then_mps * np.maximum(TIMES - until_s, 0)


@pytest.mark.parametrize(("until_s", "known"), [(10.0, False), (3.0, True)])
def test_one_that_brakes_for_its_bend_drives_it_no_faster(until_s, known):
    """Beyond ego's way its own one bends: 8 m wide, 3 m/s² across at 5 m/s."""
    turns = np.linspace(0, np.pi / 2, 19)
    bend = np.stack([8 * np.cos(turns) - 8, 4 + 8 * np.sin(turns)], axis=1)
    road = [*NORTH[:2], lanelet(6, [*bend, (-90, 12)], predecessors=(5,))]
    places = slowed(-10.5, 10, 5, until_s)
    assert told(road, places, [(0, -90), *bend, (-90, 12)]) == (known, not known)


@pytest.mark.parametrize(("radius", "known"), [(6, True), (12, False)])
def test_one_that_has_just_driven_a_sharper_bend_does_not_brake_for_the_next(radius, known):
    """It comes round a bend at 6.5 m/s, is at 4.5 m/s from 2 s on, and then drives one of 8 m."""
    turns = np.linspace(0, np.pi / 2, 19)
    bend = np.stack([radius * np.sin(turns) - radius, -10 - radius * np.cos(turns)], axis=1)
    before = [(-90, -10 - radius), *bend]
    beyond = [*np.stack([8 * np.cos(turns) - 8, 4 + 8 * np.sin(turns)], axis=1), (-90, 12)]
    road = [
        lanelet(4, [*before, (0, -4)], successors=(5,)),
        NORTH[1],
        lanelet(6, beyond, predecessors=(5,)),
    ]
    path = np.array([*before, (0, 0), *beyond])
    to_middle = np.hypot(*np.diff(np.array([*before, (0, 0)]), axis=0).T).sum()
    places = slowed(-9.3, 6.5, 4.5) + to_middle - 90
    assert told(road, places, path) == (known, not known)


@pytest.mark.parametrize(("at_2_s", "mps", "known"), [(-13, 8, False), (-10, 14, True)])
def test_one_that_brakes_for_its_own_line_could_stop_there(at_2_s, mps, known):
    """Its front is at the line 6 m before the middle: 7 m away at 8 m/s, or 4 m at 14 m/s."""
    road = [replace(NORTH[0], signs=frozenset({"YIELD"})), *NORTH[1:]]
    places = slowed(at_2_s, mps, 4)
    assert told(road, places) == (known, not known)
    # Without a sign it has nothing to brake for
    assert told(NORTH, places) == (True, False)


@pytest.mark.parametrize(("at_2_s", "mps", "known"), [(-13, 8, False), (-10, 14, True)])
def test_one_may_brake_for_those_from_its_own_near_side(at_2_s, mps, known):
    """Nothing orders the junction, and a road joins from its right, on which nobody is."""
    assert told([*NORTH, *WEST], slowed(at_2_s, mps, 4)) == (known, not known)


@pytest.mark.parametrize(("mps", "known"), [(1, False), (4, True), (10, True)])
def test_one_may_brake_for_somebody_ahead_of_it(mps, known):
    """That one is 14 m ahead at 2 s, through the junction already, and the other brakes by 3 m/s².

    For one at 1 m/s it has to brake by half as much, for one at 4 m/s hardly at all.
    """
    ahead = vehicle(
        9, {k: (0, 4 + mps * (t - 2)) for k, t in enumerate(TIMES)}, speed=mps, heading=np.pi / 2
    )
    assert told(NORTH, slowed(-10, 8, 5), others=(ahead,)) == (known, not known)


@pytest.mark.parametrize(("limit_mps", "known"), [(None, True), (9, True), (5, False), (4, False)])
def test_one_gets_no_slower_than_the_limit_beyond_asks(limit_mps, known):
    """It brakes from 8 to 5 m/s."""
    road = [*NORTH[:2], replace(NORTH[2], limit_mps=limit_mps)]
    assert told(road, slowed(-10, 8, 5)) == (known, not known)


def test_one_may_brake_for_a_limit_that_the_map_does_not_tell():
    road = [*NORTH[:2], replace(NORTH[2], untold_signs=frozenset({"MAX_SPEED"}))]
    assert told(road, slowed(-10, 8, 5)) == (False, True)


@pytest.mark.parametrize(("late_s", "known"), [(0.2, True), (0.65, True), (0.8, False)])
def test_one_that_comes_at_once_is_endangered_whatever_it_slows_down_for(late_s, known):
    """It brakes for its sign from 8 to 4 m/s and comes to ego's way, 3 m before the middle."""
    road = [replace(NORTH[0], signs=frozenset({"YIELD"})), *NORTH[1:]]
    assert told(road, slowed(-3 - 4 * (0.5 + late_s), 5, 4)) == (known, not known)


@pytest.mark.parametrize(
    ("aside", "conflict"),
    [([], True), ([(0, -30), (-4, -25), (0, -20)], False)],
    ids=["straight on", "aside and back, as onto a ring"],
)
def test_one_that_brakes_before_ego_decides_does_so_for_ego_only_if_straight_on(aside, conflict):
    """At 1 s it brakes from 16 to 6 m/s, so that it comes later than a second after ego."""
    places = -37 + 16 * np.minimum(TIMES, 1) + 6 * np.maximum(TIMES - 1, 0)
    path = [TO_NORTH[0], *aside, TO_NORTH[1]]
    assert told(NORTH, places, path) == (conflict, False)


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
    signals = priority_signals(context_of(found, route=("1", "2", "3")))
    side = "conflict_from_left"
    assert bool(values_of(signals, side).any()) == sure
    assert bool(unknown_in(signals, side).any()) != sure

"""Who had to brake for ego at a junction though it gets there long after, and whom ego hits."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import priority_signals
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
ROADS = [
    straight(1, -60, -4, successors=(2,)),
    straight(2, -4, 4, predecessors=(1,), successors=(3,), **INSIDE),
    straight(3, 4, 190, predecessors=(2,)),
    lanelet(4, [(0, -90), (0, -4)], successors=(5,)),
    lanelet(5, [(0, -4), (0, 4)], predecessors=(4,), successors=(6,), **INSIDE),
    lanelet(6, [(0, 4), (0, 90)], predecessors=(5,)),
]
STEP_S, STEPS = 0.1, 80


def from_the_right(y, roads=ROADS, kind="car", word="conflict_from_right", others=()):
    """T, F or ? of whether it is in conflict with ego, which goes east at 10 m/s.

    Ego drives into the junction at 1.4 s; its front is in the other's way at 1.7 s, as wide as that
    is, and its rear past it at 2.3 s. The other one is 3 m before its middle as it gets there.
    """
    ego = vehicle(7, {k: (-20 + k, 0) for k in range(STEPS)}, speed=10)
    places = {k: (0, float(y[k])) for k in range(STEPS)}
    other = vehicle(8, places, kind, speed=10, heading=np.pi / 2)
    found = recording(roads, [ego, other, *others], step_s=STEP_S)
    found = replace(found, complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    return "?" if unknown_in(told, word).any() else "FT"[int(values_of(told, word).any())]


def driven(begin, times, speeds):
    """Places at these speeds (m/s) at these times (s), in steps of 0.1 s, from ``begin`` on."""
    mps = np.interp(np.arange(STEPS) * STEP_S, times, speeds)
    return begin + np.concatenate(([0.0], np.cumsum(mps[:-1]) * STEP_S))


@pytest.mark.parametrize(("mps2", "conflict"), [(4.0, "T"), (1.2, "?")])
def test_who_brakes_hard_as_ego_comes_is_held_up_though_it_is_slow_when_ego_drives_in(
    mps2, conflict
):
    """At 10 m/s it would be there at 3.0 s, 0.7 s after ego has left; it comes by 5.2 s or 3.5 s.

    It brakes down to 5.5 m/s, or 8, from 0.2 s on: if gently, for ego or anything else.
    """
    slowest = 5.5 if conflict == "T" else 8.0
    y = driven(-33.0, [0.2, 0.2 + (10 - slowest) / mps2], [10.0, slowest])
    assert from_the_right(y) == conflict


# Brakes by 4 m/s² to 5.5 m/s, and comes at 5.2 s, 2.9 s after ego has left
HARD = driven(-33.0, [0.2, 1.3], [10.0, 5.5])


def with_light(colour):
    light = Light(0, ((colour, 1000),))
    return [replace(x, lights=(light,)) if x.id == "4" else x for x in ROADS]


@pytest.mark.parametrize(
    ("roads", "conflict"),
    [
        (with_light("green"), "T"),
        (with_light("red"), "?"),
        ([replace(x, signs=frozenset({"YIELD"})) if x.id == "4" else x for x in ROADS], "?"),
    ],
    ids=["green", "red", "sign"],
)
def test_who_brakes_hard_where_a_sign_or_a_light_stops_it_may_do_so_for_that(roads, conflict):
    assert from_the_right(HARD, roads) == conflict


@pytest.mark.parametrize(("begin", "conflict"), [(-10.0, "?"), (60.0, "T")])
def test_who_brakes_hard_behind_another_one_may_do_so_for_that(begin, conflict):
    """The other one goes before it over the junction, before ego comes; or it is past."""
    ahead = vehicle(9, {k: (0, begin + k) for k in range(STEPS)}, speed=10, heading=np.pi / 2)
    assert from_the_right(HARD, others=[ahead]) == conflict


@pytest.mark.parametrize(("gap_s", "conflict"), [(0.4, "T"), (1.4, "F")])
def test_who_passes_clear_of_ego_as_fast_as_before_is_not_disturbed(gap_s, conflict):
    """Ego's rear is past its side at x = 1 at 2.3 s; the other's front comes to y = -1 after that.

    The bodies are 2 m wide, so that they follow each other as fast as that on the place between.
    """
    y = 10 * (np.arange(STEPS) * STEP_S - 2.3 - gap_s) - 3
    assert from_the_right(y) == conflict


@pytest.mark.parametrize(("mps", "conflict"), [(10.0, "T"), (3.0, "F")])
def test_who_could_not_have_come_that_soon_was_not_held_up(mps, conflict):
    """It brakes by 4 m/s² down to half its speed, 26 m away when ego was to drive in."""
    assert from_the_right(driven(-33.0, [0.2, 0.2 + mps / 9], [mps, 0.55 * mps])) == conflict


@pytest.mark.parametrize(("middle_s", "conflict"), [(1.3, "F"), (1.4, "?"), (1.5, "T"), (1.8, "T")])
def test_who_drives_into_the_rear_of_one_that_is_nearly_past_hits_it(middle_s, conflict):
    """Their corners are 0.4 m apart, or overlap by 0.2 m, 0.7 m, or ego hits its middle.

    It is at most 0.3 s in ego's way, and deepest between two states.
    """
    assert from_the_right(10 * (np.arange(STEPS) * STEP_S - middle_s)) == conflict


WIDE = [
    straight(1, -60, -10, successors=(2,)),
    straight(2, -10, 10, predecessors=(1,), successors=(3,), **INSIDE),
    straight(3, 10, 190, predecessors=(2,)),
    lanelet(4, [(0, -90), (0, -10)], successors=(5,)),
    lanelet(5, [(0, -10), (0, 10)], predecessors=(4,), successors=(6,), **INSIDE),
    lanelet(6, [(0, 10), (0, 90)], predecessors=(5,)),
]


@pytest.mark.parametrize(
    ("begin", "times", "speeds", "conflict"),
    [
        (-26.0, [0.6, 3.1], [10.0, 0.0], "?"),
        (-47.0, [0.0, 2.7, 5.2], [10.0, 10.0, 0.0], "F"),
        (-23.0, [0.0], [2.0], "F"),
    ],
    ids=["for ego", "once ego is gone", "slow anyway"],
)
def test_one_that_still_stands_in_the_junction_at_the_end_may_have_braked_for_ego(
    begin, times, speeds, conflict
):
    """Its front is 5 m before ego's way at last; ego has left that at 2.4 s of 8."""
    y = driven(begin, times, speeds)
    assert -10 < y[-1] < -6
    assert from_the_right(y, roads=WIDE) == conflict


def test_one_that_is_nearly_there_at_the_end_may_come_at_once():
    """At 10 m/s its front is 2 m before ego's way at 2.5 s, when the recording ends."""
    steps = range(26)
    ego = vehicle(7, {k: (-20 + k, 0) for k in steps}, speed=10)
    other = vehicle(8, {k: (0, -31.0 + k) for k in steps}, speed=10, heading=np.pi / 2)
    found = replace(recording(WIDE, [ego, other], step_s=STEP_S), complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert unknown_in(told, "conflict_from_right").any()
    assert not values_of(told, "conflict_from_right").any()


@pytest.mark.parametrize(("begin", "conflict"), [(-4.5, "T"), (-12.0, "F")])
def test_one_that_is_slow_is_in_the_way_if_ego_runs_into_it(begin, conflict):
    """At 1.5 m/s it has its front in ego's way, and ego drives into its side; or it is far yet."""
    assert from_the_right(driven(begin, [0.0], [1.5])) == conflict


@pytest.mark.parametrize(("comes_s", "crossing", "tram"), [(4.3, "T", "F"), (6.0, "F", "F")])
def test_a_train_is_in_conflict_with_who_drives_onto_a_level_crossing_shortly_before(
    comes_s, crossing, tram
):
    """It comes at 10 m/s, 2 s or 3.7 s after ego has left; in a street that is far enough."""
    y = driven(-3.0 - 10 * comes_s, [0.0], [10.0])
    rails = [replace(x, types=x.types | {"rail"}) if x.id in "456" else x for x in ROADS]
    over = [replace(x, types=x.types | {"level_crossing"}) if x.id == "2" else x for x in rails]
    for roads, conflict in ((over, crossing), (rails, tram)):
        assert from_the_right(y, roads, "train", "conflict_with_rail") == conflict

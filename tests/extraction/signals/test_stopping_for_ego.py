"""Who comes to a stand for ego in a junction: in its way, or shortly before it, having set off.

Ego goes east through a junction that begins 10 m before its middle; the other one comes from its
right, or from its left where one drives on the left. Both are 4 m long and 2 m wide.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import priority_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
STEPS_S = pytest.mark.parametrize("step_s", [0.04, 0.1, 0.25, 0.5])
EAST, NORTH = np.array([(-200.0, 0.0), (200.0, 0.0)]), np.array([(0.0, -200.0), (0.0, 200.0)])


def driven(begin_m, speeds, step_s):
    """Places so far before the middle of the junction at first, at speeds (s, m/s), for 16 s."""
    fine = np.arange(0, 16.001, 0.01)
    mps = np.interp(fine, *zip(*speeds, strict=True))
    way = np.concatenate(([0.0], np.cumsum((mps[1:] + mps[:-1]) / 2 * 0.01)))
    return 200.0 - begin_m + np.interp(np.arange(0, 16, step_s), fine, way)


def told(ego, other, step_s=0.1, sign=None, words=("conflict_from_right",)):
    """T, F or ? of whether all words are true at once at some time, the same on either side."""
    signs = {"signs": frozenset({sign} - {None})}
    roads = [
        straight(1, -200, -10, successors=(2,), **signs),
        straight(2, -10, 10, predecessors=(1,), successors=(3,), **INSIDE),
        straight(3, 10, 200, predecessors=(2,)),
        lanelet(4, [(0, -200), (0, -10)], successors=(5,), **signs),
        lanelet(5, [(0, -10), (0, 10)], predecessors=(4,), successors=(6,), **INSIDE),
        lanelet(6, [(0, 10), (0, 200)], predecessors=(5,)),
    ]
    bodies = [along(7, EAST, driven(*ego, step_s)), along(8, NORTH, driven(*other, step_s))]
    found = replace(recording(roads, bodies, step_s=step_s), complete=frozenset({"YIELD", "STOP"}))
    mirrored = [word.replace("right", "left") for word in words]
    right = words_of(priority_signals)(context_of(found, ("1", "2", "3")))
    left = words_of(priority_signals)(
        context_of(mirrored_recording(found), ("1", "2", "3"), "left")
    )
    for word, other_word in zip(words, mirrored, strict=True):
        assert values_of(right, word).tolist() == values_of(left, other_word).tolist()
        assert unknown_in(right, word).tolist() == unknown_in(left, other_word).tolist()
    sure = np.all([values_of(right, word) & ~unknown_in(right, word) for word in words], axis=0)
    maybe = np.all([values_of(right, word) | unknown_in(right, word) for word in words], axis=0)
    return "T" if sure.any() else "?" if maybe.any() else "F"


def braking(from_m, least_mps, mps2=5.0, begins_s=2.5):
    """One at 10 m/s that is so far away at first, and brakes for 3 s and the time that it takes."""
    slow_s = begins_s + (10.0 - least_mps) / mps2
    speeds = [(begins_s, 10.0), (slow_s, least_mps), (slow_s + 3, least_mps), (slow_s + 6, 8.0)]
    return from_m, speeds


@STEPS_S
@pytest.mark.parametrize(
    ("from_m", "least_mps", "conflict"),
    [
        (35.5, 0.0, "T"),
        (37.0, 0.0, "T"),
        (37.0, 0.5, "T"),
        # Its front is at ego's side
        (37.95, 0.0, "?"),
    ],
)
def test_who_brakes_in_ego_s_way_has_not_waited_there(step_s, from_m, least_mps, conflict):
    """Ego is there at 4.2 s, at 10 m/s, when the other one is slower than 3 m/s or stands."""
    assert told((45.0, [(0, 10)]), braking(from_m, least_mps), step_s) == conflict


@STEPS_S
@pytest.mark.parametrize("ego_mps", [5.0, 8.0, 14.0])
def test_however_fast_ego_is(step_s, ego_mps):
    """Its front is there at 4.2 s, and drives into the junction 9 m before."""
    assert told((3 + 4.2 * ego_mps, [(0, ego_mps)]), braking(36.0, 0.0), step_s) == "T"


@pytest.mark.parametrize(
    ("stood_s", "conflict"), [(2.5, "F"), (-0.5, "?"), (-2.0, "T")], ids=["long", "just", "not yet"]
)
def test_who_stood_there_before_ego_came_near_may_be_in_a_queue(stood_s, conflict):
    """It stands in ego's way from so long before on as ego, seen 1 s earlier, drives in at 8 s.

    Ego brakes no more than before; or the other one has just come to a stand.
    """
    stands_s = {2.5: 4.5, -0.5: 7.5, -2.0: 9.0}[stood_s]
    other = (10 * (stands_s - 2.0) + 10.0, [(stands_s - 2.0, 10.0), (stands_s, 0.0)])
    assert told((92.0, [(0, 10)]), other) == conflict


def test_who_hits_one_and_stands_there_has_driven_in():
    """Ego is stopped by the collision, at 4.6 s."""
    ego = 45.0, [(0, 10), (4.6, 10), (4.8, 0)]
    assert told(ego, braking(36.0, 0.0)) == "?"


def test_who_stops_before_one_that_brakes_there_lets_it_pass():
    """Ego's front stays 1 m away from its side."""
    assert told((30.0, [(1.0, 10), (4.2, 0)]), braking(36.0, 0.0)) == "F"


def setting_off(sets_off_s, mps2, fastest_mps, brakes_mps2, least_mps=0.0):
    """One that stands, its front a metre before the junction; sets off and brakes; then goes on."""
    fast_s = sets_off_s + fastest_mps / mps2
    slow_s = fast_s + (fastest_mps - least_mps) / brakes_mps2
    speeds = [(sets_off_s, 0.0), (fast_s, fastest_mps), (slow_s, least_mps)]
    return 13.0, [*speeds, (slow_s + 1.5, least_mps), (slow_s + 4.5, 7.0)]


SETS_OFF = 13.0, [(4.0, 0), (8.0, 8.0)]
"""Ego stands, its front a metre before the junction; is out of the other's way at 8.1 s."""


@STEPS_S
@pytest.mark.parametrize(
    ("other", "conflict"),
    [
        (setting_off(4.0, 2.0, 3.5, 4.0), "?"),
        (setting_off(4.3, 2.0, 3.5, 4.0, 0.5), "?"),
        (setting_off(4.0, 1.5, 3.0, 3.0), "?"),
        # It waits for ego and sets off when that is past
        (setting_off(7.5, 2.0, 7.0, 4.0, 7.0), "F"),
        # It rolls on as slowly as it has set off
        ((13.0, [(4.0, 0.0), (5.0, 1.0), (6.0, 0.6), (9.5, 0.6), (12.0, 7.0)]), "F"),
    ],
    ids=["to a stand", "nearly to a stand", "gently", "later", "slowly"],
)
def test_who_has_set_off_and_stops_again_would_have_come_sooner(step_s, other, conflict):
    assert told(SETS_OFF, other, step_s) == conflict


@STEPS_S
@pytest.mark.parametrize("fastest_mps", [4.0, 6.0])
def test_who_speeds_up_to_a_junction_and_brakes_for_ego_would_have_come_sooner(step_s, fastest_mps):
    """It brakes at 6 s, and is no slower than half, but hard; or slower than that."""
    before_m = 15.5 + (1.0 + fastest_mps) / 2 * 2.0
    least = fastest_mps / 4
    speeds = [(4.0, 1.0), (6.0, fastest_mps), (7.0, least), (9.0, least), (11.0, 8.0)]
    assert told(SETS_OFF, (before_m + 4.0, speeds), step_s) == "?"


def test_who_sets_off_so_far_away_that_ego_is_past_before_it_comes():
    """At 2 m/s² it would be there at 10.5 s, more than 2 s after ego has left."""
    far = setting_off(4.0, 2.0, 3.5, 4.0)
    assert told(SETS_OFF, (45.0, far[1])) == "F"


def both_stop(ego_s, other_s):
    """Ego and the other stop at the junction at these times, and set off together at 8 s.

    The other one brakes for ego to a stand.
    """
    before = 13.0 + 4.5
    ego, other = (
        (before + 9 * (at_s - 1.0), [(at_s - 1.0, 9.0), (at_s, 0.0)]) for at_s in (ego_s, other_s)
    )
    return (
        (ego[0], [*ego[1], (8.0, 0.0), (12.0, 8.0)]),
        (other[0], [*other[1], (8.2, 0.0), (9.8, 3.2), (10.6, 0.0), (12.0, 0.0), (14.0, 6.0)]),
    )


@STEPS_S
@pytest.mark.parametrize(
    ("ego_s", "other_s", "conflict"), [(5.0, 3.0, "?"), (5.0, 5.2, "F"), (3.0, 6.0, "F")]
)
def test_where_all_have_to_stop_who_stops_first_may_have_arrived_first(
    step_s, ego_s, other_s, conflict
):
    words = "conflict_from_right", "other_arrived_first"
    assert told(*both_stop(ego_s, other_s), step_s, "STOP_4_WAY", words) == conflict


@pytest.mark.parametrize(("ego_s", "other_s", "sure"), [(5.0, 5.2, True), (3.0, 6.0, False)])
def test_who_stopped_later_may_not_have_arrived_together(ego_s, other_s, sure):
    """Ego is slow, so that the other one, which does not brake, comes at once after it."""
    ego, other = both_stop(ego_s, other_s)
    other = other[0], [*other[1][:3], (12.0, 6.5)]
    words = "conflict_from_right", "arrived_together"
    assert told(ego, other, 0.1, "STOP_4_WAY", words) == ("T" if sure else "?")
    # Elsewhere it counts who enters when
    assert told(ego, other, 0.1, None, words) == "T"

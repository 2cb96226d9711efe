"""Who leaves a ring from its inner lane, over the outer one on which another goes on round.

The ring has two lanes; traffic keeps to the right. The junction of an exit is on its east side,
from 0° to 40°, where a way from the inner lane leads out over the outer one.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.conduct import turning_conflicts
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording
from support.signal_arrays import possible_in, unknown_in, values_of
from support.words import words_of

OUTER_M, INNER_M, STEP_S = 30.0, 26.4, 0.2
TIMES = np.arange(0, 12, STEP_S)
INSIDE, ROUND = {"junction": "exit"}, frozenset({"roundabout"})


def arc(radius, first, last, count=25):
    turns = np.radians(np.linspace(first, last, count))
    return radius * np.stack((np.cos(turns), np.sin(turns)), axis=1)


def exit_way(radius, outside):
    """From 0° on the ring to a place of the road that leads away, to the north-east."""
    t = np.linspace(0, 1, 15)[:, None]
    start, end = np.array([radius, 0.0]), np.array(outside, dtype=float)
    bends = np.add(start, (0, 10)), end - 7
    shares = (1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t**2, t**3
    return sum(x * y for x, y in zip(shares, (start, *bends, end), strict=True))


OUT = np.array([(38.0, 26.0), (98.0, 86.0)])
LANES = [
    lanelet("o", arc(OUTER_M, 40, 360), 3.6, successors=("oo",), left_of="i", types=ROUND),
    lanelet("i", arc(INNER_M, 40, 360), 3.6, successors=("ii", "ix"), right_of="o", types=ROUND),
    lanelet("oo", arc(OUTER_M, 0, 40), 3.6, predecessors=("o",), successors=("o",), **INSIDE),
    lanelet("ii", arc(INNER_M, 0, 40), 3.6, predecessors=("i",), successors=("i",), **INSIDE),
    lanelet("ix", exit_way(INNER_M, OUT[0]), 3.6, predecessors=("i",), successors=("x",), **INSIDE),
    lanelet("x", OUT, 3.6, predecessors=("ix",)),
]
LANES = [replace(x, types=x.types | ROUND) if x.id in ("oo", "ii") else x for x in LANES]
LEAVES = np.concatenate((arc(INNER_M, 180, 360, 60), exit_way(INNER_M, OUT[0])[1:], OUT[1:]))
ROUNDABOUT = arc(OUTER_M, 180, 700, 300)


def seen(behind_m, brakes_mps2, own_mps=7.0, mps=7.0):
    """Ego is at the exit after 6 s; another one on the outer lane so far behind or ahead of it.

    It brakes from 0.4 s before that until it is as slow as 2 m/s.
    """
    ego = along(7, LEAVES, np.pi * INNER_M + own_mps * (TIMES - 6.0))
    speed = np.clip(mps - brakes_mps2 * np.clip(TIMES - 5.6, 0, None), 2.0, None)
    way = np.concatenate(([0.0], np.cumsum(speed[:-1] * STEP_S)))
    way += np.pi * OUTER_M - behind_m - np.interp(6.0, TIMES, way)
    other = along(8, ROUNDABOUT, way)
    found = recording(LANES, [ego, other], step_s=STEP_S)
    return replace(found, complete=frozenset({"roundabout", "YIELD"}))


def told(found, side):
    route = ("i", "ix", "x")
    context = context_of(found, route, side)
    words = (
        words_of(lane_change_signals, indicator_signals)(context),
        words_of(turning_conflicts)(context),
    )
    unknown = [
        unknown_in(words[0], "lane_change"),
        unknown_in(words[0], "lane_is_clear"),
        unknown_in(words[1], "turns_in_way_of").any(axis=0),
    ]
    assert not values_of(words[0], "lane_change").any()
    assert possible_in(words[0], "lane_is_clear").all()
    assert not values_of(words[1], "turns_in_way_of").any()
    return [bool(x.any()) for x in unknown]


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("behind_m", "brakes_mps2", "crossed"),
    [(2.0, 5.0, True), (5.0, 5.0, True), (40.0, 0.0, False), (-25.0, 0.0, False)],
    ids=["beside", "a little behind", "far behind", "gone"],
)
def test_who_leaves_a_ring_over_another_lane_may_be_in_its_way(
    side, behind_m, brakes_mps2, crossed
):
    found = seen(behind_m, brakes_mps2)
    found = found if side == "right" else mirrored_recording(found)
    assert told(found, side) == [crossed] * 3

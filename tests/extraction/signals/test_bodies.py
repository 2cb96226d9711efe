"""How soon after ego's body another one comes to where ego's was."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.signals.map.right_of_way.bodies import gap_s
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
ROADS = [
    straight(1, -200, -4, successors=(2,)),
    straight(2, -4, 4, predecessors=(1,), successors=(3,), **INSIDE),
    straight(3, 4, 200, predecessors=(2,)),
    lanelet(4, [(0, -200), (0, -4)], successors=(5,)),
    lanelet(5, [(0, -4), (0, 4)], predecessors=(4,), successors=(6,), **INSIDE),
    lanelet(6, [(0, 4), (0, 200)], predecessors=(5,)),
]
TIMES = np.arange(30) / 2
MEETS = 14
"""The column in which ego's middle is where the ways cross."""


def gap(mps, other_mps, late_s, comes=None):
    """The gap of one that crosses ego's way at a right angle, each so fast, its middle so late."""
    ego = vehicle(7, {k: (mps * (t - 7), 0) for k, t in enumerate(TIMES)}, speed=mps)
    other = vehicle(
        8,
        {k: (0, other_mps * (t - 7 - late_s)) for k, t in enumerate(TIMES)},
        speed=other_mps,
        heading=np.pi / 2,
    )
    context = context_of(recording(ROADS, [ego, other]), route=("1", "2", "3"))
    through = context.surroundings.passages.of_row
    (own,), (foe,) = through[0], through[1]
    until = MEETS + round(2 * late_s) if comes is None else comes
    return gap_s(context, (own.row, foe.row), (MEETS - 1, until))


@given(st.floats(4, 14), st.floats(4, 14), st.floats(1.5, 3))
def test_it_is_from_ego_s_rear_to_the_others_front(mps, other_mps, late_s):
    """Bodies of 4 m by 2 m: ego's rear is gone 3 m beyond the middle, the other comes 3 m short."""
    exact = late_s - 3 / mps - 3 / other_mps
    assert gap(mps, other_mps, late_s) == pytest.approx(exact, abs=0.11)


def test_bodies_that_overlap_have_no_gap():
    assert gap(10, 10, 0) == 0


def test_one_whose_body_is_not_yet_there_is_endlessly_far_behind():
    """Its way meets ego's, and it comes only three seconds after the time looked at."""
    assert gap(10, 10, 3, comes=MEETS) == np.inf

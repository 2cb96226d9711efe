"""Who rides round a ring in ego's lane, at its outer edge, and goes on where ego leaves it.

The lane is 5 m wide, its middle 20 m from the ring's; traffic keeps to the right. The junction of
an exit is from 0° to 40°. Ego drives 0.5 m farther in than the lane's middle, at 6 m/s, and is at
the exit after 6 s.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.signals.conduct import turning_conflicts
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

LANE_M, OWN_M, EDGE_M, STEP_S = 20.0, 19.5, 22.0, 0.1
TIMES = np.arange(0, 12, STEP_S)
EXIT_S = 6.0
ROUND = frozenset({"roundabout"})
INSIDE = {"junction": "exit"}
OUT = np.array([(29.0, 18.0), (89.0, 78.0)])


def arc(radius, first, last, count=30):
    turns = np.radians(np.linspace(first, last, count))
    return radius * np.stack((np.cos(turns), np.sin(turns)), axis=1)


def exit_way(radius):
    """From 0° on the ring to the road that leads away, to the north-east."""
    t = np.linspace(0, 1, 15)[:, None]
    start, end = np.array([radius, 0.0]), OUT[0]
    shares = (1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t**2, t**3
    bends = np.add(start, (0, 8)), end - 5
    return sum(x * y for x, y in zip(shares, (start, *bends, end), strict=True))


LANES = [
    lanelet("r", arc(LANE_M, 40, 360), 5.0, successors=("rr", "rx"), types=ROUND),
    lanelet(
        "rr", arc(LANE_M, 0, 40), 5.0, predecessors=("r",), successors=("r",), types=ROUND, **INSIDE
    ),
    lanelet("rx", exit_way(LANE_M), 5.0, predecessors=("r",), successors=("x",), **INSIDE),
    lanelet("x", OUT, 5.0, predecessors=("rx",)),
]
LEAVES = np.concatenate((arc(OWN_M, 180, 360, 60), exit_way(OWN_M)[1:], OUT[1:]))


def seen(behind_m, mps, brakes_mps2, radius=EDGE_M, kind="bicycle"):
    """Ego and a cycle, so far behind it (m along its own way) when ego is at the exit.

    It brakes from 0.4 s after that until it is as slow as 2 m/s.
    """
    ego = along(7, LEAVES, np.pi * OWN_M + 6.0 * (TIMES - EXIT_S))
    speed = np.clip(mps - brakes_mps2 * np.clip(TIMES - EXIT_S - 0.4, 0, None), 2.0, None)
    way = np.concatenate(([0.0], np.cumsum(speed[:-1] * STEP_S)))
    way += np.pi * radius - behind_m - np.interp(EXIT_S, TIMES, way)
    other = along(8, arc(radius, 180, 700, 300), way, kind)
    found = recording(LANES, [ego, other], step_s=STEP_S)
    return replace(found, complete=frozenset({"roundabout", "YIELD", "arrivals"}), side="right")


SCENES = pytest.mark.parametrize(
    ("behind_m", "mps", "brakes_mps2", "cut"),
    [
        (0.0, 5.0, 2.0, True),
        (3.0, 6.0, 4.0, True),
        (6.0, 6.0, 4.0, True),
        (25.0, 5.0, 0.0, False),
        (-12.0, 5.0, 0.0, False),
    ],
    ids=["beside", "at its rear", "behind its rear", "far behind", "gone"],
)


@SCENES
@pytest.mark.parametrize("side", ["right", "left"])
def test_who_leaves_a_ring_may_be_in_the_way_of_one_beside_it(
    behind_m, mps, brakes_mps2, cut, side
):
    found = seen(behind_m, mps, brakes_mps2)
    found = found if side == "right" else mirrored_recording(found)
    context = context_of(found, ("r", "rx", "x"), side)
    turns, changes = (
        words_of(turning_conflicts)(context),
        words_of(lane_change_signals, indicator_signals)(context),
    )
    assert bool(unknown_in(turns, "turns_in_way_of").any()) == cut
    assert not values_of(turns, "turns_in_way_of").any()
    assert not unknown_in(changes, "lane_is_clear").any()


def test_who_follows_ego_is_not_beside_it():
    context = context_of(seen(10.0, 6.0, 2.0, radius=OWN_M, kind="car"), ("r", "rx", "x"), "right")
    assert not unknown_in(words_of(turning_conflicts)(context), "turns_in_way_of").any()


@pytest.mark.parametrize("book", ["de", "ch", "fr", "us", "gb"])
@pytest.mark.parametrize(("behind_m", "is_open"), [(0.0, True), (25.0, False)])
def test_whether_leaving_a_ring_is_a_turn_is_open_in_the_law(book, behind_m, is_open):
    found = seen(behind_m, 5.0, 2.0 if is_open else 0.0)
    found = mirrored_recording(found) if book == "gb" else found
    found = replace(found, side="left" if book == "gb" else "right")
    wanted = RequestedDrives(egos=("7",))
    (one,) = RecordingVerdicts(found, machines(book), wanted, "by hand").answers()
    rule = "cyclists_when_turning"
    assert rule not in {x.rule for x in one.answer.violations}
    assert (rule in {x.rule for x in one.answer.open}) == is_open

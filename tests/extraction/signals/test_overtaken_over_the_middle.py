"""Whether ego is being overtaken by one that goes past it on the other half of a two-way road."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.conduct import being_overtaken, overtaking_signals
from support.builders.drive_contexts import told_on_both_sides
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.words import words_of

STEPS = 24
"""Half a second each."""

WORD = "being_overtaken"
ROAD = [straight(1, 0, 900), lanelet(2, [(900, 4), (0, 4)])]
APART = [straight(1, 0, 900), straight(2, 0, 900, 4)]


def driving(number, start, speeds, ys):
    """A car 4 m long at these speeds (m/s) and places across, whose first place is ``start``."""
    x = start + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    return vehicle(number, {k: (x[k], y) for k, y in enumerate(ys)})


def told(other, ego_ys=(0.0,) * STEPS, road=ROAD, route=("1",)):
    ego = driving(7, 100, [10.0] * STEPS, ego_ys)
    found = replace(recording(road, [ego, other]), complete=frozenset({"arrivals"}))
    words = told_on_both_sides(words_of(overtaking_signals, being_overtaken), found, route)[WORD]
    return "".join({"True": "T", "False": "F"}.get(str(value), "?") for value in words)


OUT = [0.0, 2.0] + [4.0] * (STEPS - 2)
"""It is on the other half, 4 m to the side, from the second state on."""


def test_who_comes_past_on_the_other_half_overtakes():
    """It is 5 m/s faster, and 8.5 m behind ego's rear at 3.5 s, for the first time within 2 s."""
    comes = driving(8, 70, [15.0] * STEPS, [*OUT[:20], 2.0, 0.0, 0.0, 0.0])
    # Its front has 26 m to go to ego's rear, and its rear 34 m to ego's front: 6.8 s
    assert told(comes) == "F" * 7 + "T" * 7 + "F" * 10


def test_who_was_never_on_ego_s_lanes_may_drive_on_another_road():
    assert "T" not in told(driving(8, 70, [15.0] * STEPS, [4.0] * STEPS))


def test_beside_a_lane_of_another_road_that_leads_the_same_way_nobody_overtakes():
    comes = driving(8, 70, [15.0] * STEPS, OUT)
    assert "T" not in told(comes, road=APART)


@pytest.mark.parametrize(("ends", "slowest", "known"), [(14, 3.0, True), (16, 9.0, False)])
def test_who_brakes_hard_for_ego_that_comes_out_overtook_it(ends, slowest, known):
    """By 4 m/s² or 1.5, from 4 s on, when its front is 8 m behind ego; it never gets past."""
    speeds = np.interp(np.arange(STEPS), [8, ends], [15.0, slowest])
    ego_ys = [0.0] * 8 + [1.0, 2.0, 3.0] + [4.0] * (STEPS - 11)
    words = told(driving(8, 70, speeds.tolist(), OUT), ego_ys)
    assert words[8] == ("T" if known else "?")

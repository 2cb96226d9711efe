"""Marks between lanes, and what it takes to be on one."""

import pytest

from rulec.extraction.drives import Drives
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.recordings import recording, straight, vehicle


def state(y, right="broken", left="broken", **more):
    """Ego, 2 m wide, at an offset on a road of two lanes that meet at y = 2."""
    lanes = [
        straight(1, 0, 100, left_of=2, left_mark=right, right_mark="solid"),
        straight(2, 0, 100, y=4, right_of=1, right_mark=left, left_mark="solid"),
    ]
    found = recording(lanes, [vehicle(7, {0: (40, y), 1: (50, y)})])
    (drive,) = Drives(found, "right").of("7")
    return drive.trace.states[0]


@pytest.mark.parametrize(
    ("right", "left", "marked"),
    [("broken", "broken", True), ("solid", "broken", True), ("none", "none", False)],
)
def test_marked_lanes(right, left, marked):
    assert state(0, right, left)["marked_lanes"] is marked


def test_marks_that_nobody_knows():
    assert state(0, None, None).get("marked_lanes", UNKNOWN) is UNKNOWN


@pytest.mark.parametrize(
    ("y", "right", "left", "solid", "broken_here"),
    [
        (0.0, "solid", "solid", False, False),
        (1.2, "solid", "solid", False, False),  # 0.2 m over it
        (1.4, "solid", "solid", True, False),
        (1.4, "broken", "broken", False, False),
        (1.4, "broken", "solid", True, True),  # ego comes from the right
        (2.6, "broken", "solid", True, False),  # and here from the left
        (2.6, "solid", "broken", True, True),
        (-1.4, "broken", "broken", True, False),  # the edge of the road
    ],
)
def test_on_a_line(y, right, left, solid, broken_here):
    found = state(y, right, left)
    assert (found["on_solid_line"], found["broken_on_own_side"]) == (solid, broken_here)


def test_a_map_without_marks_says_nothing():
    found = recording([straight(1, 0, 100)], [vehicle(7, {0: (40, 0), 1: (50, 0)})])
    (drive,) = Drives(found, "right").of("7")
    assert not {"marked_lanes", "on_solid_line", "broken_on_own_side"} & drive.words

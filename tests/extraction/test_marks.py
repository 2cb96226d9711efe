"""Marks between lanes, and what it takes to be on one."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.drives import Drives
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.recordings import lanelet, recording, straight, vehicle


def state(y, right="broken", left="broken", name="DEU_Test-1"):
    """Ego, 2 m wide, at an offset on a road of two lanes that meet at y = 2."""
    lanes = [
        straight(1, 0, 100, left_of=2, left_mark=right, right_mark="solid"),
        straight(2, 0, 100, y=4, right_of=1, right_mark=left, left_mark="solid"),
    ]
    found = replace(recording(lanes, [vehicle(7, {0: (40, y), 1: (50, y)})]), name=name)
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
        # Nobody has seen from which side ego came
        (1.4, "broken", "solid", True, UNKNOWN),
        (2.6, "broken", "solid", True, UNKNOWN),
        (-1.4, "broken", "broken", UNKNOWN, UNKNOWN),  # the edge of the road
    ],
)
def test_on_a_line(y, right, left, solid, broken_here):
    found = state(y, right, left)
    assert (found["on_solid_line"], found["broken_on_own_side"]) == (solid, broken_here)


@pytest.mark.parametrize("y", [1.4, 2.6])
@pytest.mark.parametrize(
    ("comes_from", "right", "left", "broken_here"),
    [
        (0.0, "broken", "solid", True),
        (0.0, "solid", "broken", False),
        (4.0, "broken", "solid", False),
        (4.0, "solid", "broken", True),
    ],
)
def test_the_side_from_which_ego_comes_counts_until_it_is_across(
    y, comes_from, right, left, broken_here
):
    """However far over the line, at y = 2, its middle is."""
    lanes = [
        straight(1, 0, 100, left_of=2, left_mark=right, right_mark="solid"),
        straight(2, 0, 100, y=4, right_of=1, right_mark=left, left_mark="solid"),
    ]
    ego = vehicle(7, {0: (40, comes_from), 1: (50, comes_from), 2: (60, y), 3: (70, y)})
    (drive,) = Drives(recording(lanes, [ego]), "right").of("7")
    found = [(own["on_solid_line"], own["broken_on_own_side"]) for own in drive.trace.states]
    assert found[0][0] is False
    assert found[2:] == [(True, broken_here)] * 2


@pytest.mark.parametrize(("y", "told"), [(0.9, False), (1.4, UNKNOWN), (1.7, True)])
def test_within_the_tolerance_of_places_nobody_knows_who_is_on_a_line(y, told):
    """Video is good to 0.3 m: who is 0.4 m over the line may be 0.1 m over it."""
    assert state(y, "solid", "solid", name="USA_Peach-1")["on_solid_line"] is told


@pytest.mark.parametrize(("drifts", "told"), [(0.0, UNKNOWN), (1.5, True)])
def test_a_box_alone_that_points_across_a_line_decides_nothing(drifts, told):
    """Turned by 0.15 rad it reaches 0.3 m more to either side: 0.49 m over the line, not 0.2 m."""
    lanes = [
        straight(1, 0, 100, left_of=2, left_mark="solid", right_mark="solid"),
        straight(2, 0, 100, y=4, right_of=1, right_mark="solid", left_mark="solid"),
    ]
    body = vehicle(7, {0: (40, 1.2), 1: (50, 1.2 + drifts)}, heading=0.15)
    (drive,) = Drives(recording(lanes, [body]), "right").of("7")
    assert drive.trace.states[0]["on_solid_line"] is told


@pytest.mark.parametrize(("left", "told"), [("broken", UNKNOWN), ("solid", True)])
def test_what_is_beyond_the_edge_of_the_road_no_map_tells(left, told):
    """Premises, a place to park or a lane that nobody drew; an inner line is one between lanes."""
    lanes = [
        straight(1, 0, 100, width=1.5, left_of=2, left_mark=left, right_mark="solid"),
        straight(2, 0, 100, y=2.75, right_of=1, right_mark=left, left_mark="solid"),
    ]
    found = recording(lanes, [vehicle(7, {0: (40, 0), 1: (50, 0)}, width=3.0)])
    (drive,) = Drives(found, "right").of("7")
    assert drive.trace.states[0]["on_solid_line"] is told


def test_a_map_without_marks_says_nothing():
    found = recording([straight(1, 0, 100)], [vehicle(7, {0: (40, 0), 1: (50, 0)})])
    (drive,) = Drives(found, "right").of("7")
    assert not {"marked_lanes", "on_solid_line", "broken_on_own_side"} & drive.words


@pytest.mark.parametrize(("name", "told"), [("DEU_Test-1", True), ("USA_Peach-1", UNKNOWN)])
def test_a_badly_known_track_does_not_tell_how_its_body_stands(name, told):
    """Askew by 0.35 rad a corner is 1 m over the line; along the lane its side would be on it."""
    lanes = [
        straight(1, 0, 100, left_of=2, left_mark="solid", right_mark="solid"),
        straight(2, 0, 100, y=4, right_of=1, right_mark="solid", left_mark="solid"),
    ]
    ego = vehicle(7, {0: (40, 1.2), 1: (40.2, 1.2)}, heading=0.35)
    found = replace(recording(lanes, [ego]), name=name)
    (drive,) = Drives(found, "right").of("7")
    assert drive.trace.states[0]["on_solid_line"] is told


@pytest.mark.parametrize(("y", "told"), [(1.1, False), (1.6, UNKNOWN)])
def test_where_a_lane_opens_a_body_reaches_no_farther(y, told):
    """From x = 50 on a lane opens at the left; 4 m later it is 0.2 m wide, and drawn as 4 m.

    Over the line by 0.6 m, of which nobody knows whether it is the road's edge or one of lanes.
    """
    opening = lanelet(2, [(50, 2), (100, 4)], left_mark="solid", right_mark="solid", right_of=1)
    opening = replace(
        opening,
        right=np.array([(50.0, 2.0), (100.0, 2.0)]),
        left=np.array([(50.0, 2.01), (100.0, 6.0)]),
    )
    lanes = [
        straight(3, 0, 50, successors=(1,), left_mark="solid", right_mark="solid"),
        straight(1, 50, 100, left_of=2, predecessors=(3,), left_mark="solid", right_mark="solid"),
        opening,
    ]
    places = {0: (40, y), 1: (52, y), 2: (53, y)}
    (drive,) = Drives(recording(lanes, [vehicle(7, places)]), "right").of("7")
    assert [state["on_solid_line"] for state in drive.trace.states] == [told] * 3

"""The road that a vehicle really drove, and what becomes of those that drive on none."""

from dataclasses import replace
from math import cos, pi, sin

import pytest

from rulec.extraction.drives import Drive, Drives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.tracks.matching.driven_route import route_stretches
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.matching.map_matching import MapMatching
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.measured import middle


def ways(found, ego=0):
    graph = LaneletGraph(found)
    matched = MapMatching(found, tracks_of(found, USUAL), graph).of(ego)
    stretches = (one for part in matched for one in route_stretches(found, part, graph))
    return [(one.first, one.last, one.route) for one in stretches]


def along(*places, **more):
    return vehicle(7, dict(enumerate(places)), **more)


def test_through_a_fork_ego_goes_where_it_went():
    # Behind 1 the road goes on as 2, and bends away as 3; both hold ego for a while
    lanes = [
        straight(1, 0, 100, successors=("2", "3")),
        straight(2, 100, 200, predecessors=("1",)),
        lanelet(3, [(100, 0), (140, 4), (180, 16)], predecessors=("1",)),
    ]
    ahead = along((80, 0), (110, 0.3), (130, 0.0), (150, 0), (170, 0))
    away = along((80, 0), (110, 0.6), (130, 2.6), (150, 6.6), (170, 12.8))
    assert ways(recording(lanes, [ahead])) == [(0, 4, ("1", "2"))]
    assert ways(recording(lanes, [away])) == [(0, 4, ("1", "3"))]


def test_a_change_of_lanes_is_no_change_of_roads():
    lanes = [
        straight(1, 0, 100, left_of=2, successors=("3",)),
        straight(2, 0, 100, y=4, right_of=1, successors=("4",)),
        straight(3, 100, 200, left_of=4, predecessors=("1",)),
        straight(4, 100, 200, y=4, right_of=3, predecessors=("2",)),
    ]
    # Most states are on the left
    found = ways(recording(lanes, [along((80, 0), (95, 1.5), (110, 4), (130, 4), (150, 4))]))
    assert found == [(0, 4, ("2", "4"))]


def test_a_lane_that_ends_is_left_for_the_one_that_goes_on():
    lanes = [
        straight(1, 0, 100, left_of=2),
        straight(2, 0, 100, y=4, right_of=1, successors=("4",)),
        straight(4, 100, 200, y=4, predecessors=("2",)),
    ]
    # Ego is on 1 for longer, but only 2 leads to where it goes
    places = [(20, 0), (40, 0), (60, 0), (80, 0), (95, 3), (110, 4)]
    assert ways(recording(lanes, [along(*places)])) == [(0, 5, ("2", "4"))]


def test_a_jump_parts_the_drive():
    lanes = [straight(1, 0, 100), straight(5, 0, 100, y=500)]
    jumps = along((10, 0), (20, 0), (30, 500), (40, 500), (50, 500))
    found = recording(lanes, [jumps])
    assert ways(found) == [(0, 1, ("1",)), (2, 4, ("5",))]
    drives = list(Drives(found, "right").of("7"))
    assert [(one.trace.id, one.start_s, len(one.trace.states)) for one in drives] == [
        ("7", 0.0, 2),
        ("7#2", 1.0, 3),
    ]


def test_a_gap_in_the_recording_parts_the_drive():
    found = recording(
        [straight(1, 0, 100)], [vehicle(7, {0: (0, 0), 1: (9, 0), 5: (45, 0), 6: (54, 0)})]
    )
    drives = list(Drives(found, "right").of("7"))
    assert [(one.start_s, len(one.trace.states)) for one in drives] == [(0.0, 2), (2.5, 2)]


@pytest.mark.parametrize(
    ("one", "why"),
    [
        (along((10, 30), (20, 30)), "it is never on a lane in its direction"),  # 28 m beside it
        (along((20, 0), (10, 0), heading=pi), "it is never on a lane in its direction"),
        (along((10, 0)), "it is recorded at one moment only"),
    ],
)
def test_who_drives_on_no_lane(one, why):
    (answer,) = Drives(recording([straight(1, 0, 100)], [one]), "right").of("7")
    assert answer == NoDrive("7", why)


def test_who_does_not_drive():
    people = [
        vehicle(1, {0: (0, 0), 1: (1, 0)}, "pedestrian", length=0.5, width=0.5),
        vehicle(2, {0: (20, 0)}, standing=True),
        vehicle(3, {0: (40, 0), 1: (50, 0)}, "bicycle"),
    ]
    assert Drives(recording([straight(1, 0, 100)], people), "right").egos() == ("3",)


def test_in_a_bend_distances_are_those_along_the_road():
    # A quarter of a circle of radius 50: 7 is at 0°, 8 at 45°, both along it
    def on_circle(angle, radius=50.0):
        return radius * sin(angle), radius * (1 - cos(angle))

    bend = lanelet(1, [on_circle(k * pi / 40) for k in range(21)])
    cars = [
        vehicle(7, dict.fromkeys(range(2), on_circle(pi / 12)), heading=pi / 12),
        vehicle(8, dict.fromkeys(range(2), on_circle(pi / 3)), heading=pi / 3),
    ]
    (drive,) = Drives(recording([bend], cars), "right").of("7")
    assert isinstance(drive, Drive)
    state = drive.trace.states[0]
    assert (state["station"], state["lateral"]) == ({"8": "behind"}, {"8": "same_lane"})
    # A quarter of a right angle of way less half a car at either end
    assert middle(state["gap"]["8"]) == pytest.approx(50 * pi / 4 - 4, abs=0.15)


def test_a_lane_without_any_length():
    point = lanelet(1, [(10, 0), (11, 0)])
    point = replace(point, centre=point.centre[[0, 0]])
    (answer,) = Drives(recording([point], [along((10, 0), (10.2, 0))]), "right").of("7")
    assert answer == NoDrive(
        "7", "its road is invalid: all points of its lane's centre line are in one place"
    )

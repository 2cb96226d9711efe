"""The road under a matched path: which lanelets, and where it changes lanes itself."""

import numpy as np
import pytest

from rulec.extraction.tracks.matching.driven_route import pieces_of, route_stretches
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.matching.map_matching import MapMatching
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.drive_contexts import driven_road
from support.builders.recordings import lanelet, recording, straight, vehicle


def stretches(lanes, *places):
    places = [place if isinstance(place, tuple) else (place, 0) for place in places]
    found = recording(lanes, [vehicle(7, dict(enumerate(places)))])
    graph = LaneletGraph(found)
    matched = MapMatching(found, tracks_of(found, USUAL), graph).of(0)
    return [
        (one.first, one.last, one.route, one.pieces)
        for part in matched
        for one in route_stretches(found, part, graph)
    ]


@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])
def test_where_lanelets_overlap_ego_stays_on_its_own(first, second):
    lanes = [
        straight(first, 0, 100, successors=(second,)),
        straight(second, 90, 190, predecessors=(first,)),
    ]
    # At 95 m ego is on both
    assert stretches(lanes, 60, 95) == [(0, 1, (str(first),), (0, 0))]
    ((_, _, route, pieces),) = stretches(lanes, 60, 95, 130)
    assert (route, pieces) == ((str(first), str(second)), (0, 0, 1))


def test_at_most_four_lanelets_lie_between_two_states():
    lanes = [
        straight(k, 10 * k, 10 * k + 10, successors=(k + 1,), predecessors=(k - 1,))
        for k in range(8)
    ]
    assert stretches(lanes, 5, 45) == [(0, 1, ("0", "1", "2", "3", "4"), (0, 4))]
    assert stretches(lanes, 5, 55) == [(0, 0, ("0",), (0,)), (1, 1, ("5",), (0,))]


def test_where_two_lanes_become_one_the_road_is_ego_s_way():
    """It was longer on the right one of them, but came out of the left one."""
    lanes = [
        straight(1, 0, 100, 0, left_of=2, successors=(3,)),
        straight(2, 0, 100, 4, right_of=1, successors=(3,)),
        straight(3, 100, 250, 4, predecessors=(1, 2)),
    ]
    places = [*((x, 0) for x in range(5, 75, 5)), (80, 4), (90, 4), (97, 4), (110, 4), (120, 4)]
    ((_, _, route, _),) = stretches(lanes, *places)
    assert route == ("2", "3")


TURNS = [
    # Into the left lane 2 from 1, and out of the right one, 3, into 4
    lanelet(1, [(0, 4), (100, 4)], successors=("2",)),
    lanelet(2, [(100, 4), (200, 4)], predecessors=("1",), right_of=3),
    lanelet(3, [(100, 0), (200, 0)], left_of=2, successors=("4",)),
    lanelet(4, [(200, 0), (300, 0)], predecessors=("3",)),
]
CHANGES = [(50, 4), (90, 4), (120, 4), (150, 2.5), (170, 0), (190, 0), (210, 0), (250, 0)]


def test_where_no_lane_leads_through_the_road_changes_lanes():
    ((first, last, route, pieces),) = stretches(TURNS, *CHANGES)
    assert (first, last, route) == (0, 7, ("1", "2", "3", "4"))
    assert pieces == (0, 0, 1, 1, 1, 1, 2, 2)
    assert pieces_of(recording(TURNS), route, LaneletGraph(recording(TURNS)).beside) == (
        ("1",),
        ("2", "3"),
        ("4",),
    )


def test_a_road_that_changes_lanes_has_its_lanes_side_by_side():
    road = driven_road(recording(TURNS), ("1", "2", "3", "4"))
    assert [[own and own.id for own in row] for row in road.rows] == [
        [None, "1"],
        ["3", "2"],
        ["4", None],
    ]
    assert road.own_lanes == (1, 1, 0)
    middles = (road.borders[1:] + road.borders[:-1]) / 2
    assert road.lanes.existing_at(middles).tolist() == [[False, True], [True, True], [True, False]]
    # In the middle of lanelet 3 one is in the right lane, wherever the line leads
    place = road.line.coordinates(np.array([(190.0, 0.0)]))
    assert road.lanes.from_bounds(place)[0, :2] == pytest.approx([2, -2], abs=0.05)


BESIDE_AN_END = [
    # Lane 2, which 1 leads to, ends beside 3, which leads on to 4; before, 0 leads to 3
    straight(0, 0, 100, 4, successors=(3,)),
    straight(1, 0, 100, 0, successors=(2,)),
    straight(2, 100, 300, 0, predecessors=(1,), left_of=3),
    straight(3, 100, 300, 4, predecessors=(0,), right_of=2, successors=(4,)),
    straight(4, 300, 400, 4, predecessors=(3,)),
]


def test_the_road_does_not_end_with_a_lane_that_ego_has_left():
    joins = [(50, 0), (90, 0), (130, 0), (160, 0), (180, 2.5), (200, 4), (240, 4)]
    ((first, last, route, pieces),) = stretches(BESIDE_AN_END, *joins)
    assert (first, last, route) == (0, 6, ("1", "2", "3"))
    assert pieces == (0, 0, 1, 1, 1, 1, 1)
    road = driven_road(recording(BESIDE_AN_END), route)
    assert [[own and own.id for own in row] for row in road.rows][2:] == [[None, "4"]]
    # Who is still in the lane that ends may go anywhere from there
    ((_, _, route, _),) = stretches(BESIDE_AN_END, *joins[:4])
    assert route == ("1", "2")


def test_nor_begins_with_a_lane_that_ego_came_to_later():
    turned = [
        straight(0, 0, 100, 4, successors=(3,)),
        straight(2, 100, 300, 0, left_of=3, successors=(5,)),
        straight(3, 100, 300, 4, predecessors=(0,), right_of=2),
        straight(5, 300, 400, 0, predecessors=(2,)),
    ]
    leaves = [(120, 4), (160, 4), (180, 1.5), (200, 0), (240, 0), (330, 0)]
    ((_, _, route, pieces),) = stretches(turned, *leaves)
    assert (route, pieces) == (("3", "2", "5"), (0, 0, 0, 0, 0, 1))

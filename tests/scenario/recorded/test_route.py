"""Which lanelets ego follows."""

import pytest

from rulec.recordings.recording import TrackState, id_order
from rulec.scenario.recorded.route import lanelet_of, lanelets_at, route
from support.builders.recordings import lanelet, recording, straight

FORK = [
    straight(1, 0, 50, successors=(2, 3, 4)),
    lanelet(2, [(50, 0), (60, 2), (68, 10)], predecessors=(1,), successors=(5,)),
    straight(3, 50, 100, predecessors=(1,)),
    lanelet(4, [(50, 0), (60, -2), (68, -10)], predecessors=(1,)),
    lanelet(5, [(68, 10), (70, 40)], predecessors=(2,), left_of=6),
    lanelet(6, [(64, 10), (66, 40)], right_of=5),
]


def test_straight_on_where_the_road_branches():
    assert route(recording(FORK), "1", frozenset()) == ("1", "3")


@pytest.mark.parametrize(("goal", "way"), [((68, 30), ("1", "2", "5")), ((67, -9), ("1", "4"))])
def test_towards_the_goal(goal, way):
    made = recording(FORK, goals=[goal])
    assert route(made, "1", lanelets_at(made, made.problems[0].goals)) == way


def test_a_goal_on_the_lane_beside_will_do():
    made = recording(FORK, goals=[(65, 30)])
    assert lanelets_at(made, made.problems[0].goals) == {"5", "6"}
    assert route(made, "1", frozenset({"5", "6"})) == ("1", "2", "5")


def test_a_goal_that_cannot_be_reached_is_none():
    assert route(recording(FORK), "3", frozenset({"5"})) == ("1", "3")


def test_what_led_here_comes_first():
    assert route(recording(FORK), "5", frozenset()) == ("1", "2", "5")


def test_a_ring_is_followed_once():
    ring = [
        lanelet(1, [(0, 0), (10, 0)], successors=(2,), predecessors=(2,)),
        lanelet(2, [(10, 0), (5, 8), (0, 0)], successors=(1,), predecessors=(1,)),
    ]
    assert route(recording(ring), "1", frozenset()) == ("1", "2")


def test_a_ring_is_cut_half_way_round():
    # A square of four sides of 40 m each: two ahead, two behind, or three if that is the way to go
    corners = [(0, 0), (40, 0), (40, 40), (0, 40), (0, 0)]
    ring = [
        lanelet(k, corners[k - 1 : k + 1], successors=(k % 4 + 1,), predecessors=((k - 2) % 4 + 1,))
        for k in range(1, 5)
    ]
    assert route(recording(ring), "1", frozenset()) == ("4", "1", "2", "3")
    assert route(recording(ring), "1", frozenset({"4"})) == ("1", "2", "3", "4")


def test_no_further_than_300_m():
    chain = [
        straight(n, 100 * n, 100 * n + 100, successors=(n + 1,), predecessors=(n - 1,))
        for n in range(1, 12)
    ]
    assert route(recording(chain), "6", frozenset()) == ("3", "4", "5", "6", "7", "8", "9")


@pytest.mark.parametrize(
    ("place", "heading", "expected"),
    [
        ((25, 0), 0.0, "1"),
        ((25, 0), 1.5, "7"),  # on both, and this one leads its way
        ((25, 4.5), 0.0, "1"),  # beside all, this one is the nearest
        ((25, 9), 0.0, None),
    ],
)
def test_the_lanelet_that_ego_is_on(place, heading, expected):
    crossing = lanelet(7, [(25, -3), (25, 2)])
    made = recording([*FORK, crossing])
    assert lanelet_of(made, TrackState(*place, heading, 0, 0)) == expected


def test_a_road_does_not_turn_back_by_itself():
    """It ends where one can only turn round; who is to go back does."""
    round_the_end = [
        straight(1, 0, 100, y=-2, successors=(2,)),
        lanelet(2, [(100, -2), (103, 0), (100, 2)], predecessors=(1,), successors=(3,)),
        straight(3, 100, 0, y=2, predecessors=(2,)),
    ]
    made = recording(round_the_end)
    assert route(made, "1", frozenset()) == ("1",)
    assert route(made, "3", frozenset()) == ("3",)
    assert route(made, "1", frozenset({"3"})) == ("1", "2", "3")


def test_ids_that_are_numbers_come_in_their_order():
    assert sorted(["10", "9", "e2", "100"], key=id_order) == ["9", "10", "e2", "100"]

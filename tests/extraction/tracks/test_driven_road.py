"""The road of a chain of lanelets: its lanes, and what lies where along it."""

import numpy as np
import pytest

from support.builders.drive_contexts import driven_road
from support.builders.recordings import lanelet, recording, straight

TWO_LANES = [
    straight(1, 0, 100, left_of=2, successors=(3,)),
    straight(2, 0, 100, y=4, right_of=1, successors=(4,)),
    straight(3, 100, 200, left_of=4, predecessors=(1,)),
    straight(4, 100, 200, y=4, right_of=3, predecessors=(2,)),
]


def road(lanes=TWO_LANES, route=("1", "3"), junctions=frozenset()):
    return driven_road(recording(lanes), route, junctions)


def test_rows_are_the_lanelets_beside_each_other():
    found = road()
    assert [[own.id for own in row] for row in found.rows] == [["1", "2"], ["3", "4"]]
    assert found.own_lanes == (0, 0)
    assert road(route=("2", "4")).own_lanes == (1, 1)
    assert found.borders.tolist() == [0, 100, 200]
    assert found.lanelet(1, 1).id == "4"


def test_the_road_goes_on_before_and_after_the_way():
    assert [row[0].id for row in road(route=("3",)).rows] == ["1", "3"]
    assert [row[0].id for row in road(route=("1",)).rows] == ["1", "3"]


def test_places_have_lanelets():
    found = road()
    assert found.piece(np.array([-5.0, 0.0, 99.0, 101.0, 250.0])).tolist() == [0, 0, 0, 1, 1]


def test_a_lane_that_ends_is_missing_from_then_on():
    found = road([TWO_LANES[0], straight(2, 0, 100, y=4, right_of=1), TWO_LANES[2]])
    assert found.rows[1][1] is None
    # Where the map has no lanelet ego's own stands in
    assert found.lanelet(1, 1).id == "3"
    assert found.lanes.existing_at(np.array([50.0, 150.0])).tolist() == [
        [True, True],
        [True, False],
    ]


def test_crossings_and_junctions_lie_along_the_road():
    zebra = lanelet(9, [(40, -5), (40, 9)], width=4, types=frozenset({"crosswalk"}))
    found = road([*TWO_LANES, zebra], junctions=frozenset({"3", "4"}))
    ((start, end),) = found.crossings
    assert (start, end) == (pytest.approx(38, abs=0.1), pytest.approx(42, abs=0.1))
    assert found.junctions == ((100.0, 200.0),)
    assert road(junctions=frozenset({"1", "3"})).junctions == ((0.0, 200.0),)


def test_a_crossing_beside_ego_s_lane_is_another_road_s():
    """As where the lane beside it turns off, and people cross the road that it turns onto."""
    zebra = lanelet(9, [(120, 6), (160, 6)], width=4, types=frozenset({"crosswalk"}))
    assert road([*TWO_LANES, zebra]).crossings == ()
    ((start, end),) = road([*TWO_LANES, zebra], ("2", "4")).crossings
    assert (start, end) == (pytest.approx(120, abs=0.1), pytest.approx(160, abs=0.1))


def test_a_crossing_on_a_ring_is_met_on_every_round():
    """Four quarters of a circle of 25 m, along which the road goes on, and a crossing over one."""
    turned = np.linspace(0, np.pi / 2, 31)
    quarters = [
        lanelet(
            number + 1,
            25 * np.stack((np.cos(turned + at), np.sin(turned + at)), axis=1),
            successors=((number + 1) % 4 + 1,),
            predecessors=((number - 1) % 4 + 1,),
        )
        for number, at in enumerate(np.arange(4) * np.pi / 2)
    ]
    zebra = lanelet(9, [(-14, -14), (-22, -22)], types=frozenset({"crosswalk"}))
    found = road([*quarters, zebra], ("2", "3", "4"))
    middles = [(start + end) / 2 for start, end in found.crossings]
    around = 50 * np.pi
    assert len(middles) == round((found.borders[-1] - found.borders[0]) / around) >= 2
    assert np.diff(middles) == pytest.approx(around, abs=1.0)


def test_a_crossing_that_a_road_meets_again_as_it_comes_back():
    """A hundred metres on, beside itself: in between nobody is on the crossing."""
    around = [(100, 0), (103, 3), (103, 7), (100, 10)]
    lanes = [
        straight(1, 0, 100, successors=(2,)),
        lanelet(2, around, predecessors=(1,), successors=(3,)),
        lanelet(3, [(100, 10), (0, 10)], predecessors=(2,)),
    ]
    zebra = lanelet(9, [(40, -5), (40, 15)], width=4, types=frozenset({"crosswalk"}))
    out, back = road([*lanes, zebra], ("1", "2", "3")).crossings
    assert out == pytest.approx((38, 42), abs=0.1)
    round_m = road(lanes, ("1", "2", "3")).borders[2] - 100
    assert back == pytest.approx((158 + round_m, 162 + round_m), abs=0.5)


def test_a_road_without_lanes_is_refused():
    with pytest.raises(ValueError, match="no lane of the road is as wide as 1 m"):
        road([straight(1, 0, 100, width=0.5)], ("1",))

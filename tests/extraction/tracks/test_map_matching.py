"""The lanelets on which single states may lie, and at what cost."""

from math import pi, radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.tracks.map_matching import NEAR_M, match_to_map
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.recordings import recording, straight, vehicle


def matches(lanes, *participants):
    found = recording(lanes, participants)
    return match_to_map(found, tracks_of(found, USUAL))


def costs(x=50.0, y=0.0, heading=0.0):
    """The costs of the lanelets 1, from y = -2 to 2, and 2, that leads the other way beside it."""
    lanes = [straight(1, 0, 100), straight(2, 100, 0, y=4)]
    return matches(lanes, vehicle(7, {0: (x, y)}, heading=heading))[0][0]


def test_on_a_lane_and_along_it_costs_nothing():
    assert costs() == {"1": 0.0}


def test_an_angle_costs_its_part_of_a_right_angle():
    assert costs(heading=radians(45)) == {"1": pytest.approx(0.5)}
    assert costs(heading=radians(-9)) == {"1": pytest.approx(0.1)}


def test_a_lane_beside_costs_more_than_any_angle():
    # 1.5 m beside, of the 3 m that are near: 1 for being beside, and 0.5
    assert costs(y=-3.5) == {"1": pytest.approx(1.5)}
    assert 0 not in matches([straight(1, 0, 100)], vehicle(7, {0: (50, -2 - NEAR_M - 0.01)}))


def test_a_lane_that_leads_the_other_way_does_not_match():
    assert costs(y=4, heading=pi) == {"2": pytest.approx(0.0)}
    # On lane 2, but headed along lane 1: beside it, by 2 m
    assert costs(y=4) == {"1": pytest.approx(1 + 2 / 3)}


def test_standing_participants_and_other_surfaces_have_no_match():
    assert matches([straight(1, 0, 100)], vehicle(7, {0: (50, 0)}, standing=True)) == {}
    pavement = straight(1, 0, 100, types=frozenset({"sidewalk"}))
    assert matches([pavement], vehicle(7, {0: (50, 0)})) == {}


def test_columns_come_in_order_and_without_gaps_filled():
    body = vehicle(7, {0: (50, 0), 1: (50, 90), 2: (60, 0), 5: (70, 0)})
    assert [*matches([straight(1, 0, 100)], body)[0]] == [0, 2, 5]


@given(st.lists(st.tuples(st.integers(0, 5), st.floats(1, 99), st.floats(-1.9, 1.9)), min_size=1))
def test_on_disjoint_lanes_the_lane_is_found(places):
    lanes = [straight(k, 0, 100, y=100 * k) for k in range(6)]
    body = vehicle(7, {step: (x, 100 * lane + y) for step, (lane, x, y) in enumerate(places)})
    for step, (lane, _, _) in enumerate(places):
        assert matches(lanes, body)[0][step] == {str(lane): pytest.approx(0)}

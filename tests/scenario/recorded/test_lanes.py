"""Lanes side by side: their bounds, where they are not, and places between straight bounds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.scenario.recorded.lane_coordinates import NARROWEST_LANE_M, lanes_along
from rulec.scenario.recorded.reference_line import reference_line
from support.builders.recordings import lanelet, recording, straight


def lanes_of(lanelets, way, ego_s=10.0):
    made = recording(lanelets)
    way = [str(number) for number in way]
    line = reference_line(np.concatenate([made.lanelets[n].centre for n in way]))
    return lanes_along(made, way, line, ego_s)


def test_neighbours_that_lead_the_same_way_are_lanes():
    lanes = lanes_of(
        [
            straight(1, 0, 100, left_of=2, right_of=3),
            straight(2, 0, 100, y=3.5, width=3.0, right_of=1),
            straight(3, 0, 100, y=-4.5, width=5.0, left_of=1),
        ],
        (1,),
    )
    assert lanes.straight.tolist() == pytest.approx([-7, -2, 2, 5])
    assert lanes.missing(0, 100, 0) == ()
    assert lanes.existing_at(np.array(50.0)).sum() == 3


def test_a_pavement_is_no_lane():
    lanes = lanes_of(
        [
            straight(1, 0, 100, left_of=2),
            straight(2, 0, 100, y=4, right_of=1, types=frozenset({"sidewalk"})),
        ],
        (1,),
    )
    assert lanes.straight.tolist() == pytest.approx([-2, 2])


def test_a_lane_that_ends_is_missing_from_there_on():
    lanes = lanes_of(
        [
            straight(1, 0, 40, left_of=2),
            straight(2, 0, 40, y=4, right_of=1),
            straight(3, 40, 100),
        ],
        (1, 3),
    )
    assert lanes.straight.tolist() == pytest.approx([-2, 2, 6])
    assert lanes.missing(0, 100, 10) == ((2, (30, 90)),)
    assert lanes.existing_at(np.array([20.0, 60.0])).sum(axis=1).tolist() == [2, 1]


def test_a_lane_begins_where_it_is_wide_enough():
    """From 0 to 4 m in 80 m: it is 1 m wide after 20 m. Ego is where it is 3 m wide."""
    wedge = lanelet(2, [(0, 2), (80, 4)], right_of=1)
    wedge = lanelet(
        2,
        [(0, 2), (80, 4)],
        left=np.array([(0.0, 2.0), (80.0, 6.0)]),
        right=np.array([(0.0, 2.0), (80.0, 2.0)]),
        right_of=1,
    )
    lanes = lanes_of([straight(1, 0, 80, left_of=2), wedge], (1,), ego_s=60)
    assert lanes.straight.tolist() == pytest.approx([-2, 2, 5])
    ((lane, gap),) = lanes.missing(0, 80, 0)
    assert (lane, gap) == (2, pytest.approx((0, 20), abs=1))
    assert pytest.approx(1) == NARROWEST_LANE_M


def test_where_ego_has_it_not_a_lane_is_as_wide_as_elsewhere():
    lanes = lanes_of(
        [
            straight(1, 0, 40),
            straight(2, 40, 100, left_of=3),
            straight(3, 40, 100, y=3.5, width=3.0, right_of=2),
        ],
        (1, 2),
    )
    assert lanes.straight.tolist() == pytest.approx([-2, 2, 5])


@given(st.floats(0, 100), st.floats(0, 1), st.sampled_from([0, 1]))
def test_proportions_within_a_lane_stay(s, part, lane):
    """The right lane grows from 4 to 8 m to the right; the left one keeps its width."""
    right = lanelet(
        1,
        [(0, 0), (100, -2)],
        left=np.array([(0.0, 2.0), (100.0, 2.0)]),
        right=np.array([(0.0, -2.0), (100.0, -6.0)]),
        left_of=2,
    )
    own = straight(2, 0, 100, y=4, right_of=1)
    lanes = lanes_of([own, right], (2,), ego_s=0.0)
    # the reference line is the middle of the left lane, 4 m to the left of the x axis
    bounds = (-6 - 4 * s / 100, -2, 2)
    d = bounds[lane] + part * (bounds[lane + 1] - bounds[lane])
    ((straightened,),) = lanes.straightened(np.array([(s, d)]))
    assert straightened == pytest.approx((-6, -2)[lane] + 4 * part, abs=0.01)


@given(st.floats(0, 100), st.floats(0.01, 50))
def test_beside_the_road_distances_from_it_stay(s, far):
    lanes = lanes_of([lanelet(1, [(0, 0), (100, 0)], [4.0, 6.0])], (1,), ego_s=0.0)
    half = 2 + s / 100
    ((left,), (right,)) = lanes.straightened(np.array([(s, half + far), (s, -half - far)]))
    assert (left, right) == pytest.approx((2 + far, -2 - far), abs=0.01)


def test_a_road_without_a_lane_is_refused():
    with pytest.raises(ValueError, match="as wide as 1 m"):
        lanes_of([straight(1, 0, 100, width=0.5)], (1,))

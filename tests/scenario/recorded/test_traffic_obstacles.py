"""Participants of a recording as obstacles on a straight road, seen from ego at s = 20 m."""

from fractions import Fraction

import numpy as np
import pytest

from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.recorded.lane_coordinates import lanes_along
from rulec.scenario.recorded.reference_line import reference_line
from rulec.scenario.recorded.traffic_obstacles import GOES_ON_S, TrafficView, traffic_obstacles
from rulec.scenario.scenario_model import ConstantAcceleration, Footprints
from support.builders.recordings import recording, straight, vehicle

ROAD = [straight(1, 0, 200)]


def view(*participants, at_s=0.0):
    found = recording(ROAD, participants)
    line = reference_line(ROAD[0].centre)
    return TrafficView(
        recording=found,
        line=line,
        lanes=lanes_along(found, ("1",), line, 20.0),
        ego_s=20.0,
        at_s=at_s,
        road=Box(-20, 180, -2, 2),
    )


def only(*participants, prediction="recorded", at_s=0.0, ego=None):
    (obstacle,) = traffic_obstacles(view(*participants, at_s=at_s), ego, prediction)
    return obstacle


def test_bounds_are_counted_from_ego():
    near, far = np.array([(30.0, -1.0), (34.0, 1.0)]), np.array([(30.0, 40.0)])
    boxes = view().boxes([near, far])
    assert boxes[1] is None
    box = boxes[0]
    assert (box.s_min, box.s_max, box.d_min, box.d_max) == pytest.approx((10, 14, -1, 1))
    assert view().boxes([]) == []


def test_a_recorded_obstacle_is_where_it_was():
    obstacle = only(vehicle(8, {0: (50, 0), 1: (55, 0), 2: (60, 0.5)}, "truck", length=6.0))
    assert (obstacle.id, obstacle.type, obstacle.broader[0]) == ("8", "truck", "vehicle")
    assert (obstacle.length, obstacle.width) == pytest.approx((6, 2))
    assert isinstance(obstacle.motion, Footprints)
    assert obstacle.motion.times[:3] == (0, 0.5, 1.0)
    box = obstacle.motion.boxes[1]
    assert (box.s_min, box.s_max, box.d_min, box.d_max) == pytest.approx((32, 38, -1, 1))


def test_after_the_end_it_goes_on_at_the_speed_of_the_last_half_second():
    # 10 m/s, then 30 m/s
    obstacle = only(vehicle(8, {0: (50, 0), 1: (55, 0), 2: (70, 0)}))
    body = swept(obstacle, 2.0, 2.0)
    assert (body.s_min, body.s_max) == pytest.approx((50 + 30 - 2, 50 + 30 + 2))
    assert obstacle.motion.times[-1] == 1.0 + GOES_ON_S


def test_one_that_leaves_before_the_end_does_not_go_on():
    stays = vehicle(7, {0: (20, 0), 4: (40, 0)})
    obstacle = only(stays, vehicle(8, {0: (50, 0), 1: (55, 0)}), ego="7")
    assert obstacle.motion.times == (0, 0.5)


def test_times_begin_with_ego():
    obstacle = only(vehicle(8, {0: (50, 0), 1: (55, 0), 2: (60, 0)}), at_s=0.5)
    assert obstacle.motion.times[:2] == (0.0, 0.5)
    assert obstacle.motion.boxes[0].s_min == pytest.approx(33)


def test_a_constant_prediction_has_the_stated_motion_along_the_road():
    body = vehicle(8, {0: (50, 0.5), 1: (55, 0.5)}, speed=9.0, acceleration=-1.0, heading=np.pi)
    motion = only(body, prediction="constant").motion
    assert isinstance(motion, ConstantAcceleration)
    assert (motion.s, motion.d) == pytest.approx((30, 0.5))
    assert (motion.speed, motion.acceleration) == pytest.approx((-9, 1))
    # One that is not there at time 0 has no such prediction
    assert list(traffic_obstacles(view(vehicle(8, {1: (50, 0)})), None, "constant")) == []


def test_predictions_may_have_probabilities():
    body = vehicle(8, {0: (50, 0), 1: (60, 0)}, speed=5.0)
    weights = {"recorded": Fraction(3, 4), "constant": Fraction(1, 4)}
    obstacle = only(body, prediction=weights)
    assert isinstance(obstacle.motion, Footprints)
    assert obstacle.weight == Fraction(3, 4)
    (other,) = obstacle.alternatives
    assert other.weight == Fraction(1, 4)
    assert other.motion == ConstantAcceleration(pytest.approx(30), pytest.approx(0), 5.0, 0.0)


def test_those_that_are_never_on_the_road_and_ego_are_left_out():
    aside = vehicle(8, {0: (50, 5), 1: (55, 5)})
    post = vehicle(9, {0: (60, 5)}, standing=True)
    assert list(traffic_obstacles(view(aside, post), None, "recorded")) == []
    assert list(traffic_obstacles(view(vehicle(7, {0: (20, 0)})), "7", "recorded")) == []


def test_standing_ones_stay_and_parked_ones_are_parked():
    post = only(vehicle(9, {0: (60, 1)}, "parkedVehicle", standing=True))
    assert post.motion == ConstantAcceleration(pytest.approx(40), pytest.approx(1))
    assert post.signals == {"two_wheeled": False, "parked": True}
    assert only(vehicle(9, {0: (60, 1)}, "bicycle", standing=True)).signals == {"two_wheeled": True}


def test_a_pedestrian_that_never_moves_has_a_direction():
    still = vehicle(8, {0: (50, 0), 1: (50, 0)}, "pedestrian", heading=np.pi / 2)
    assert only(still).walking_direction == pytest.approx(90)
    walks = vehicle(8, {0: (50, 0), 1: (50, 1)}, "pedestrian", heading=np.pi / 2)
    assert only(walks).walking_direction is None

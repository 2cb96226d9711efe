"""Signals of traffic around ego: congestion, queues, overtaking."""

import pytest

from rulec.extraction.signals.flow_signals import flow_signals
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording
from support.generators.random_recordings import lanes


def first(*others, ego=None, count=2, side="right", route=("1",), **thresholds):
    """The signals in the first state."""
    ego = ego or steady(7, 0, 0)
    context = context_of(recording(lanes(count), [ego, *others]), route, side, **thresholds)
    return {name: bool(flags[0]) for name, flags in flow_signals(context).world.items()}


def line(speed, count, y=0.0, start=10.0, apart=10.0, number=20):
    """Vehicles one behind the other."""
    return [steady(number + k, start + apart * k, y, speed=speed) for k in range(count)]


def test_congestion_takes_three_vehicles_with_a_low_median():
    slow = steady(7, 0, 0, speed=8)  # 28.8 km/h
    assert first(*line(8, 2), ego=slow)["congested"]
    assert first(*line(8, 2), ego=slow)["CONGESTED"]
    assert not first(*line(8, 1), ego=slow)["congested"]
    assert not first(*line(8.5, 2), ego=slow)["congested"]  # the median is 30.6 km/h
    assert not first(*line(8, 2), ego=slow)["walking_pace_flow"]
    assert first(*line(2, 2), ego=slow)["walking_pace_flow"]  # 7.2 km/h
    # Those that come towards ego do not count, nor those more than 100 m away
    assert not first(steady(8, 30, 0, speed=8), steady(9, 60, 4, speed=-8), ego=slow)["congested"]
    assert not first(steady(8, 30, 0, speed=8), steady(9, 105, 0, speed=8), ego=slow)["congested"]


def test_all_lanes_queue_when_each_has_three_close_vehicles():
    both = [*line(10, 2), *line(10, 3, y=4.0, number=30)]
    assert first(*both)["dense_all_lanes"]
    assert not first(*line(10, 2), *line(10, 2, y=4.0, number=30))["dense_all_lanes"]
    # 6 m of gap in the one lane; in the other 26 m at 10 m/s, where 20 m are allowed
    sparse = line(10, 3, y=4.0, apart=30.0, number=30)
    assert not first(*line(10, 2), *sparse)["dense_all_lanes"]
    assert first(*line(10, 2), *sparse, queue_headway_s=2.7)["dense_all_lanes"]


@pytest.mark.parametrize(("side", "y", "route"), [("right", 4.0, ("1",)), ("left", 0.0, ("2",))])
def test_a_queue_on_the_far_side_is_slow(side, y, route):
    ego = steady(7, 0, 4.0 - y)
    slow, fast = line(10, 3, y=y, start=0), line(17, 3, y=y, start=0)
    assert first(*slow, ego=ego, side=side, route=route)["far_lane_queue"]
    assert not first(*fast, ego=ego, side=side, route=route)["far_lane_queue"]  # 61.2 km/h
    # Seen from the other side of the road it is on the near side
    wrong = "left" if side == "right" else "right"
    assert not first(*slow, ego=ego, side=wrong, route=route)["far_lane_queue"]


def test_in_a_queue_half_of_the_gaps_are_short():
    # On the far lane: gaps of 6 and 46 m, and then another one of 46 m
    three = [steady(k, x, 4.0) for k, x in ((8, -50), (9, -40), (10, 10))]
    assert first(*three)["far_lane_queue"]
    assert not first(*three, steady(11, 60, 4.0))["far_lane_queue"]


def overtakes(x, speed, y=0.0, **more):
    """Is ego, at 20 m/s on the left one of two lanes, overtaking a vehicle?"""
    return first(steady(8, x, y, speed=speed), ego=steady(7, 0, 4, speed=20), **more)["overtaking"]


def test_overtaking_is_passing_a_slower_vehicle_on_its_far_side():
    assert overtakes(0, 10)
    assert overtakes(100, 10)  # 96 m of gap at 10 m/s are 9.6 s
    assert not overtakes(110, 10)
    assert overtakes(-40, 10)  # 36 m past it at 20 m/s are 1.8 s
    assert not overtakes(-46, 10)
    assert not overtakes(0, 20)
    assert not overtakes(0, 10, y=4.0)
    # Where traffic keeps left, the right side is the far one
    assert not overtakes(0, 10, side="left")


def test_being_overtaken_is_having_a_faster_vehicle_on_the_far_side():
    def overtaken(x, speed, y=4.0, **more):
        return first(steady(8, x, y, speed=speed), **more)["being_overtaken"]

    assert overtaken(0, 15)
    assert overtaken(-13, 15)  # 9 m behind at 5 m/s more: 1.8 s
    assert not overtaken(-15, 15)
    assert not overtaken(20, 15)
    assert not overtaken(0, 10)
    assert not overtaken(0, 15, side="left")


def test_nobody_is_overtaken_where_all_lanes_queue():
    # All drive at 10 m/s, but one beside ego is a little faster
    queues = [*line(10, 2), *line(11, 3, y=4.0, start=0.0, number=30)]
    found = first(*queues)
    assert found["dense_all_lanes"]
    assert not found["being_overtaken"]
    assert first(queues[2])["being_overtaken"]

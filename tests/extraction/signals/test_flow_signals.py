"""Signals of traffic around ego: congestion, queues."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import flow_signals
from rulec.extraction.signals.conduct import being_overtaken, overtaking_signals
from support.builders.drive_contexts import context_of, line, steady
from support.builders.recordings import recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import letters, possible_in, possibly_said, unknown_in, values_of
from support.words import words_of


def first(*others, ego=None, count=2, side="right", route=("1",), **thresholds):
    """The signals in the first state."""
    ego = ego or steady(7, 0, 0)
    context = context_of(recording(lanes(count), [ego, *others]), route, side, **thresholds)
    signals = words_of(flow_signals)(context)
    return {name: bool(possibly_said(signals, name)[0]) for name in signals.world}


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


@pytest.mark.parametrize(("speed", "slow"), [(16.0, True), (17.0, False)])
def test_who_queues_beside_a_lane_that_flows_is_in_no_jam(speed, slow):
    """Five stand in ego's lane, and two beside it drive 57.6 km/h or 61.2; 60 are twice 30."""
    ego = steady(7, 0, 0, speed=0)
    found = first(*line(0, 4), *line(speed, 2, y=4.0, number=30), ego=ego)
    assert (found["congested"], found["CONGESTED"]) == (slow, slow)
    # 20 km/h are twice the pace of who walks
    assert not found["walking_pace_flow"]


@pytest.mark.parametrize(("speed", "slow"), [(2.0, True), (17.0, False)])
def test_two_lanes_that_flow_with_one_on_each_are_no_jam(speed, slow):
    ego, drives = steady(7, 0, 0, speed=0), [(30, 4.0), (31, 8.0)]
    others = [steady(number, 10, y, speed=speed) for number, y in drives]
    assert first(*line(0, 4), *others, ego=ego, count=3)["walking_pace_flow"] == slow


@pytest.mark.parametrize(
    ("count", "second", "jam"), [(2, False, True), (3, False, False), (3, True, True)]
)
def test_a_jam_is_on_half_of_the_lanes(count, second, jam):
    """Five stand in ego's lane, and nobody, or one, on the next."""
    ego, beside = steady(7, 0, 0, speed=0), [steady(30, 10, 4.0, speed=0)] if second else []
    found = first(*line(0, 4), *beside, ego=ego, count=count)
    assert (found["congested"], found["walking_pace_flow"]) == (jam, jam)


@pytest.mark.parametrize(
    ("beside", "ahead", "told"),
    [(True, True, True), (False, True, False), (True, False, False)],
    ids=["a jam", "one lane of two, before a turn", "who leads"],
)
def test_who_waits_where_no_jam_may_be_is_not_told_to_be_in_one(beside, ahead, told):
    start = 10.0 if ahead else -50.0
    others = [steady(30, 10, 4.0, speed=0)] if beside else []
    bodies = [steady(7, 0, 0, speed=0), *line(0, 4, start=start), *others]
    found = words_of(flow_signals)(context_of(recording(lanes(2), bodies), ("1",)))
    for word in ("congested", "walking_pace_flow"):
        assert possible_in(found, word)[0]
        assert unknown_in(found, word)[0] == (not told)


@pytest.mark.parametrize(
    ("x", "y", "told"), [(45, 0.0, False), (105, 0.0, True), (-45, 0.0, True), (45, 4.0, True)]
)
def test_those_behind_a_cycle_may_be_in_no_jam(x, y, told):
    bodies = [steady(7, 0, 0, speed=5), *line(5, 3), steady(30, 10, 4.0, speed=5)]
    cycle = steady(40, x, y, speed=5, kind="bicycle")
    found = words_of(flow_signals)(context_of(recording(lanes(2), [*bodies, cycle]), ("1",)))
    assert possible_in(found, "congested")[0]
    assert unknown_in(found, "congested")[0] == (not told)


@pytest.mark.parametrize(
    ("lead_mps", "beside", "told"),
    [(7, False, False), (0, False, True), (7, True, True)],
    ids=["a tractor leads", "one stands ahead", "two lanes"],
)
def test_a_line_behind_one_that_drives_freely_may_be_no_jam(lead_mps, beside, told):
    """Three follow the first one; those ahead of it are 96 m and more away."""
    ego, leader = steady(7, 0, 0, speed=7), steady(30, 50, 0, speed=lead_mps)
    others = [steady(31, 10, 4.0, speed=7)] if beside else []
    far = [steady(40 + k, x, 0, speed=7) for k, x in enumerate((150, 165))]
    bodies = [ego, *line(7, 2, start=20.0), leader, *others, *far]
    found = words_of(flow_signals)(context_of(recording(lanes(2 if beside else 1), bodies), ("1",)))
    for word in ("congested", "CONGESTED"):
        assert possible_in(found, word)[0]
        assert unknown_in(found, word)[0] == (not told)


def test_traffic_that_has_been_slow_for_less_than_10_s_may_be_no_jam():
    """All go at 10 m/s for 2 s, and then at 1 m/s, 11 s long."""
    along_m = np.cumsum([0.0] + [5.0] * 4 + [0.5] * 22)

    def at(number, x, y):
        return vehicle(number, {k: (x + float(far), y) for k, far in enumerate(along_m)})

    others = [at(20 + k, 10.0 * (k + 1), 0.0) for k in range(4)]
    bodies = [at(7, 0.0, 0.0), *others, at(30, 10.0, 4.0)]
    found = words_of(flow_signals)(context_of(recording(lanes(2), bodies), ("1",)))
    slow, unknown = possible_in(found, "congested"), unknown_in(found, "congested")
    begins = int(np.flatnonzero(slow)[0])
    assert slow[begins:].all()
    # It was not slow a state before
    assert np.flatnonzero(unknown).tolist() == list(range(begins, begins + 19))
    # Of a drive that begins in one nobody knows how long it has been there, but where all is known
    jam = recording(lanes(2), [steady(7, 0, 0, 1), *line(1, 4), steady(30, 10, 4, 1)])
    assert not unknown_in(words_of(flow_signals)(context_of(jam, ("1",))), "congested").any()
    whole = replace(jam, complete=frozenset({"arrivals"}))
    assert unknown_in(words_of(flow_signals)(context_of(whole, ("1",))), "congested").all()


def test_a_single_one_that_drives_past_a_jam_is_no_flow():
    ego = steady(7, 0, 0, speed=0)
    assert first(*line(0, 4), steady(30, 10, 4.0, speed=17), ego=ego)["walking_pace_flow"]


def test_all_lanes_queue_when_each_has_three_close_vehicles():
    both = [*line(10, 2), *line(10, 3, y=4.0, number=30)]
    assert first(*both)["dense_all_lanes"]
    assert not first(*line(10, 2), *line(10, 2, y=4.0, number=30))["dense_all_lanes"]
    # 6 m of gap in the one lane; in the other 26 m at 10 m/s, where 20 m are allowed
    sparse = line(10, 3, y=4.0, apart=30.0, number=30)
    context = context_of(recording(lanes(2), [steady(7, 0, 0), *line(10, 2), *sparse]), ("1",))
    assert letters(words_of(flow_signals)(context), "dense_all_lanes")[0] != "T"
    assert first(*line(10, 2), *sparse, queue_headway_s=2.7)["dense_all_lanes"]


@pytest.mark.parametrize("complete", [True, False])
def test_whom_nobody_is_ahead_of_is_in_no_queue(complete):
    behind = [*line(10, 2, start=-30), *line(10, 3, y=4.0, start=-30, number=30)]
    found = recording(lanes(2), [steady(7, 0, 0), *behind])
    found = replace(found, complete=frozenset({"arrivals"} if complete else ()))
    signals = words_of(flow_signals)(context_of(found))
    assert not values_of(signals, "dense_all_lanes")[0]
    # Where only some of the traffic is recorded there may be one
    assert unknown_in(signals, "dense_all_lanes")[0] == (not complete)


@pytest.mark.parametrize(("count", "unknown"), [(2, True), (3, True), (5, False)])
def test_the_first_one_recorded_of_some_lines_may_be_in_one_on_all_lanes(count, unknown):
    """On ego's lane and the next one cars are behind each other, and on the others nobody is."""
    behind = [*line(10, 2, start=-30), *line(10, 3, y=4.0, start=-30, number=30)]
    signals = words_of(flow_signals)(
        context_of(recording(lanes(count), [steady(7, 0, 0), *behind]))
    )
    assert not values_of(signals, "dense_all_lanes")[0]
    assert unknown_in(signals, "dense_all_lanes")[0] == unknown


@pytest.mark.parametrize(
    ("front", "queues", "unknown"), [(25, True, False), (30, False, True), (39, False, False)]
)
def test_who_is_far_behind_the_next_one_leads_too(front, queues, unknown):
    # Vehicles are 4 m long: 21 of 22 m of gap are allowed at 11 m/s, 26 of 33 may be, 35 are not
    behind = [*line(11, 2, start=-30), *line(11, 3, y=4.0, start=-30, number=30)]
    found = recording(lanes(2), [steady(7, 0, 0, speed=11), steady(9, front, 0, speed=11), *behind])
    signals = words_of(flow_signals)(context_of(found))
    assert values_of(signals, "dense_all_lanes")[0] == queues
    assert unknown_in(signals, "dense_all_lanes")[0] == unknown


@pytest.mark.parametrize(("side", "y", "route"), [("right", 4.0, ("1",)), ("left", 0.0, ("2",))])
def test_a_queue_on_the_far_side_is_slow(side, y, route):
    ego = steady(7, 0, 4.0 - y)
    slow, fast = line(10, 3, y=y, start=0), line(17, 3, y=y, start=0)
    assert first(*slow, ego=ego, side=side, route=route)["far_lane_queue"]
    assert not first(*fast, ego=ego, side=side, route=route)["far_lane_queue"]  # 61.2 km/h
    # Seen from the other side of the road it is on the near side
    wrong = "left" if side == "right" else "right"
    assert not first(*slow, ego=ego, side=wrong, route=route)["far_lane_queue"]


def test_in_a_queue_most_of_the_gaps_are_short():
    # On the far lane: gaps of 6 and 46 m, and then another one of 6 m
    three = [steady(k, x, 4.0) for k, x in ((8, -50), (9, -40), (10, 10))]
    assert not first(*three)["far_lane_queue"]
    assert first(*three, steady(11, 20, 4.0))["far_lane_queue"]


@pytest.mark.parametrize(("speed", "overtakes"), [(11, False), (14, True)])
def test_gaps_as_long_as_in_a_queue_within_tolerance_tell_nothing(speed, overtakes):
    """At 11 m/s a gap of 22 m is the longest: those of 22.1 m, known to 0.4 m/s, may be as long."""
    far = [steady(30 + k, 26.1 * k - 3, 4.0, speed=11 if k else speed) for k in range(3)]
    found = recording(lanes(2), [steady(7, 0, 0, speed=11), *line(11, 2), *far])
    signals = words_of(flow_signals)(context_of(found))
    assert unknown_in(signals, "dense_all_lanes")[0]
    assert unknown_in(signals, "far_lane_queue")[0]
    overtaken = unknown_in(
        words_of(overtaking_signals, being_overtaken)(context_of(found)), "being_overtaken"
    )
    assert overtaken[0] == overtakes


def test_a_lane_between_two_ramps_does_not_decide():
    """It is 200 m long, and has room for a queue, on which nobody is."""
    road = [
        straight(1, -300, 0, successors=("2",)),
        straight(2, 0, 200, predecessors=("1",), successors=("3",), right_of=4),
        straight(3, 200, 500, predecessors=("2",)),
        straight(4, 0, 200, y=-4, left_of=2),
    ]
    found = recording(road, [steady(7, 100, 0), *line(10, 2, start=110.0)])
    dense = possible_in(
        words_of(flow_signals)(context_of(found, ("1", "2", "3"))), "dense_all_lanes"
    )
    assert dense.all()


@pytest.mark.parametrize(("complete", "unknown"), [((), True), (("arrivals",), False)])
def test_where_a_world_begins_there_are_no_queues(complete, unknown):
    found = recording([straight(1, 0, 40), straight(2, 0, 40, 4)], [steady(7, 10, 0)])
    found = replace(found, complete=frozenset(complete))
    signals = words_of(flow_signals)(context_of(found))
    assert unknown_in(signals, "dense_all_lanes")[0] == unknown
    assert not values_of(signals, "dense_all_lanes")[0]


def test_a_lane_too_short_for_a_queue_does_not_decide():
    # An acceleration lane of 40 m beside a lane on which all queue
    through = straight(1, -100, 100, left_of=None, successors=("3",))
    joined = [
        straight(3, 100, 140, predecessors=("1",), right_of=4, successors=("5",)),
        straight(4, 100, 140, y=-4, left_of=3),
        straight(5, 140, 300, predecessors=("3",)),
    ]
    queue = line(10, 3, start=110.0)
    ego = steady(7, 100, 0)
    found = recording([through, *joined], [ego, *queue])
    dense = possible_in(words_of(flow_signals)(context_of(found, ("1", "3"))), "dense_all_lanes")
    assert dense[1:].all()
    # A lane that is there all along, without anybody, decides
    assert not first(*line(10, 2))["dense_all_lanes"]


@pytest.mark.parametrize(("behind", "unknown"), [(-20.0, False), (-40.0, True)])
def test_the_last_one_behind_queues_may_be_in_them_or_not(behind, unknown):
    """At 10 m/s a gap of 30 m is the longest that some call one of a queue."""
    both = [*line(10, 2), *line(10, 3, y=4.0, number=30), steady(9, behind, 0)]
    signals = words_of(flow_signals)(context_of(recording(lanes(2), [steady(7, 0, 0), *both])))
    assert possible_in(signals, "dense_all_lanes")[0]
    assert unknown_in(signals, "dense_all_lanes")[0] == unknown


@pytest.mark.parametrize(("count", "unknown"), [(2, False), (3, True)])
def test_a_queue_on_one_lane_of_three_does_not_tell_of_the_others(count, unknown):
    """Lanes of 40 m beside the one that goes on have no room for a queue."""
    beside = [straight(4, 100, 140, y=-4, left_of=3), straight(6, 100, 140, y=4, right_of=3)]
    road = [
        straight(1, -100, 100, successors=("3",)),
        straight(3, 100, 140, predecessors=("1",), right_of=4, successors=("5",)),
        straight(5, 140, 300, predecessors=("3",)),
        *beside[: count - 1],
    ]
    if count == 3:
        road[1] = replace(road[1], left_of="6")
    found = recording(road, [steady(7, 100, 0), *line(10, 3, start=110.0), steady(9, 90, 0)])
    signals = words_of(flow_signals)(context_of(found, ("1", "3")))
    assert possible_in(signals, "dense_all_lanes")[2]
    assert unknown_in(signals, "dense_all_lanes")[2] == unknown


def test_where_the_map_ends_soon_nothing_is_said_of_queues():
    short = recording([straight(1, 0, 40)], [steady(7, 10, 0)])
    assert unknown_in(words_of(flow_signals)(context_of(short)), "dense_all_lanes").all()


@pytest.mark.parametrize("mps", [25, 36, 45])
def test_the_faster_ego_is_the_farther_queues_are_looked_for(mps):
    """At 36 m/s three vehicles with 2 s between them take up 231 m, more than 100 m each way."""
    road, ego = [straight(1, -300, 900)], steady(7, 0, 0, speed=mps, steps=4)
    alone = words_of(flow_signals)(context_of(recording(road, [ego])))
    assert not unknown_in(alone, "dense_all_lanes").any()
    assert not values_of(alone, "dense_all_lanes").any()
    apart = 1.4 * mps
    others = [steady(8, -apart, 0, speed=mps, steps=4), steady(9, apart, 0, speed=mps, steps=4)]
    queue = words_of(flow_signals)(context_of(recording(road, [ego, *others])))
    assert values_of(queue, "dense_all_lanes").all()


@pytest.mark.parametrize(("mps", "queue"), [(10, True), (17, False)])
def test_ego_is_in_the_queue_on_its_own_lane(mps, queue):
    """Three in a lane, ego among them, at 36 or 61 km/h; nobody on the other one."""
    ego = steady(7, 0, 4, speed=mps)
    assert first(*line(mps, 2, y=4.0), ego=ego)["own_lane_queue"] == queue
    assert not first(*line(mps, 2), ego=ego)["own_lane_queue"]


@pytest.mark.parametrize(("complete", "unknown"), [((), True), (("arrivals",), False)])
def test_one_queue_where_a_world_begins_is_not_one_on_all_lanes(complete, unknown):
    """Three are on one of three lanes, which are too short for the longest queue of three."""
    short = [
        straight(1, 0, 60, left_of=2),
        straight(2, 0, 60, 4, right_of=1, left_of=3),
        straight(3, 0, 60, 8, right_of=2),
    ]
    found = recording(short, [steady(7, 10, 0), *line(10, 2, start=24.0)])
    found = replace(found, complete=frozenset(complete))
    signals = words_of(flow_signals)(context_of(found))
    assert unknown_in(signals, "dense_all_lanes")[0] == unknown
    assert unknown or not values_of(signals, "dense_all_lanes")[0]

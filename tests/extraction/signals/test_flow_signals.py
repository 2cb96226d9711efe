"""Signals of traffic around ego: congestion, queues, overtaking."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.flow_signals import flow_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
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
    found = flow_signals(context_of(recording(lanes(2), bodies), ("1",)))
    for word in ("congested", "walking_pace_flow"):
        assert found.world[word][0]
        assert found.unknown[word][0] == (not told)


def test_traffic_that_has_been_slow_for_less_than_10_s_may_be_no_jam():
    """All go at 10 m/s for 2 s, and then at 1 m/s, 11 s long."""
    along_m = np.cumsum([0.0] + [5.0] * 4 + [0.5] * 22)

    def at(number, x, y):
        return vehicle(number, {k: (x + float(far), y) for k, far in enumerate(along_m)})

    others = [at(20 + k, 10.0 * (k + 1), 0.0) for k in range(4)]
    bodies = [at(7, 0.0, 0.0), *others, at(30, 10.0, 4.0)]
    found = flow_signals(context_of(recording(lanes(2), bodies), ("1",)))
    slow, unknown = found.world["congested"], found.unknown["congested"]
    begins = int(np.flatnonzero(slow)[0])
    assert slow[begins:].all()
    # It was not slow a state before
    assert np.flatnonzero(unknown).tolist() == list(range(begins, begins + 19))
    # Of a drive that begins in one nobody knows how long it has been there, but where all is known
    jam = recording(lanes(2), [steady(7, 0, 0, 1), *line(1, 4), steady(30, 10, 4, 1)])
    assert not flow_signals(context_of(jam, ("1",))).unknown["congested"].any()
    whole = replace(jam, complete=frozenset({"light"}))
    assert flow_signals(context_of(whole, ("1",))).unknown["congested"].all()


def test_a_single_one_that_drives_past_a_jam_is_no_flow():
    ego = steady(7, 0, 0, speed=0)
    assert first(*line(0, 4), steady(30, 10, 4.0, speed=17), ego=ego)["walking_pace_flow"]


def test_all_lanes_queue_when_each_has_three_close_vehicles():
    both = [*line(10, 2), *line(10, 3, y=4.0, number=30)]
    assert first(*both)["dense_all_lanes"]
    assert not first(*line(10, 2), *line(10, 2, y=4.0, number=30))["dense_all_lanes"]
    # 6 m of gap in the one lane; in the other 26 m at 10 m/s, where 20 m are allowed
    sparse = line(10, 3, y=4.0, apart=30.0, number=30)
    assert not first(*line(10, 2), *sparse)["dense_all_lanes"]
    assert first(*line(10, 2), *sparse, queue_headway_s=2.7)["dense_all_lanes"]


@pytest.mark.parametrize("complete", [True, False])
def test_whom_nobody_is_ahead_of_is_in_no_queue(complete):
    behind = [*line(10, 2, start=-30), *line(10, 3, y=4.0, start=-30, number=30)]
    found = recording(lanes(2), [steady(7, 0, 0), *behind])
    found = replace(found, complete=frozenset({"light"} if complete else ()))
    signals = flow_signals(context_of(found))
    assert not signals.world["dense_all_lanes"][0]
    # Where only some of the traffic is recorded there may be one
    assert signals.unknown["dense_all_lanes"][0] == (not complete)


@pytest.mark.parametrize(
    ("front", "queues", "unknown"), [(25, True, False), (30, False, True), (39, False, False)]
)
def test_who_is_far_behind_the_next_one_leads_too(front, queues, unknown):
    # Vehicles are 4 m long: 21 of 22 m of gap are allowed at 11 m/s, 26 of 33 may be, 35 are not
    behind = [*line(11, 2, start=-30), *line(11, 3, y=4.0, start=-30, number=30)]
    found = recording(lanes(2), [steady(7, 0, 0, speed=11), steady(9, front, 0, speed=11), *behind])
    signals = flow_signals(context_of(found))
    assert signals.world["dense_all_lanes"][0] == queues
    assert signals.unknown["dense_all_lanes"][0] == unknown


@pytest.mark.parametrize(
    ("mps", "ago_s", "known"), [(0, 9, False), (0, 11, True), (5, 9, False), (6, 9, True)]
)
def test_who_sets_off_beside_others_is_not_told_to_be_overtaken(mps, ago_s, known):
    """Ego creeps (at 18 km/h, not at 21.6) for 2 s, and goes at 10 m/s until 15 m/s pass it."""
    last = 2 * (2 + ago_s)
    ego = vehicle(7, {k: (min(k, 4) * mps / 2 + max(k - 4, 0) * 5.0, 0) for k in range(last + 6)})
    place = ego.states[last].x
    other = vehicle(8, {k: (place + (k - last) * 7.5, 4.0) for k in range(last - 4, last + 6)})
    found = flow_signals(context_of(recording(lanes(2), [ego, other])))
    assert found.world["being_overtaken"][last]
    assert found.whom["being_overtaken"][last] == ("8",)
    assert found.unknown["being_overtaken"][last] == (not known)


@pytest.mark.parametrize(("slowest", "known"), [(15, True), (11, True), (8, False)])
def test_who_falls_back_before_it_gets_past_may_have_given_up(slowest, known):
    """It comes at 15 m/s, ego goes at 10 m/s; for 2 s it is slower than before."""
    speeds = [15, 15] + [slowest] * 4 + [15] * 14
    x = np.cumsum([-12.0] + [mps / 2 for mps in speeds])
    ego = steady(7, 0, 0, 10, steps=20)
    other = vehicle(8, {k: (float(x[k]), 4.0) for k in range(20)})
    whole = replace(recording(lanes(2), [ego, other]), complete=frozenset({"light"}))
    found = flow_signals(context_of(whole))
    assert found.world["being_overtaken"][0] == known
    assert found.unknown["being_overtaken"][0] == (not known)


def runs(speeds):
    """Ego's places, and its speeds at most of them, from x = 0; half a second apart."""
    places = np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) * 0.5)))
    return {k: (x, 0.0) for k, x in enumerate(places.tolist())}


CRAWLED = [4.0] * 10 + [12.0] * 24
GAINING = [0.0] * 4 + [0.4 * k for k in range(30)]


@pytest.mark.parametrize(
    ("speeds", "at", "known"),
    [(CRAWLED, 20, False), (CRAWLED, 31, True), (GAINING, 33, False)],
    ids=["5 s after it crawled", "10.5 s after", "still gaining speed after 15 s"],
)
def test_who_gets_up_speed_from_a_crawl_sets_off(speeds, at, known):
    places = runs(speeds)
    passes = {k: (places[at][0] + (k - at) * 9.0, 4.0) for k in range(at - 4, at + 8)}
    ego = vehicle(7, places | {at + k: (places[at][0] + 6.0 * k, 0.0) for k in range(1, 8)})
    found = flow_signals(context_of(recording(lanes(2), [ego, vehicle(8, passes)])))
    assert found.world["being_overtaken"][at]
    assert found.unknown["being_overtaken"][at] == (not known)


@pytest.mark.parametrize(("before", "known"), [(24.0, False), (20.0, True), (16.0, True)])
def test_who_had_to_brake_regains_its_speed(before, known):
    """Ego is at 20 m/s or a little more, and was at another speed up to 4 s before."""
    speeds = [before] * 10 + [20.0 + 0.02 * k for k in range(16)]
    places, at = runs(speeds), 18
    passes = {k: (places[at][0] + (k - at) * 13.0, 4.0) for k in range(at - 4, at + 6)}
    ego = vehicle(7, places)
    found = flow_signals(context_of(recording(lanes(2), [ego, vehicle(8, passes)])))
    assert found.world["being_overtaken"][at]
    assert found.unknown["being_overtaken"][at] == (not known)


@pytest.mark.parametrize(("ago_s", "known"), [(4, False), (12, True)])
def test_who_has_turned_into_a_road_gets_up_speed_yet(ago_s, known):
    """Ego turns right at 8 m/s, and drives on beside one at 15 m/s."""
    angles = np.radians(np.linspace(90, 0, 19))
    turn = np.stack((100 + 14 * np.cos(angles), -14 + 14 * np.sin(angles)), axis=1)
    inside = frozenset({"intersection"})
    road = [
        straight(1, -100, 100, successors=(2,)),
        lanelet(2, turn, predecessors=(1,), successors=(3,), types=inside, junction="x"),
        lanelet(3, [(114, -14), (114, -300)], predecessors=(2,), left_of=4),
        lanelet(4, [(118, -14), (118, -300)], right_of=3),
    ]
    line = np.concatenate(([(-100.0, 0.0)], turn, [(114.0, -300.0)]))
    out_m = 200 + 22 + 8.0 * ago_s
    last = 2 * ago_s + 10
    ego = along(7, line, out_m + 4.0 * (np.arange(last + 6) - last))
    beside = along(
        8,
        np.array([(118.0, 100.0), (118.0, -300.0)]),
        114 + 8.0 * ago_s + 7.5 * (np.arange(last + 6) - last),
    )
    found = flow_signals(context_of(recording(road, [ego, beside]), ("1", "2", "3")))
    assert found.world["being_overtaken"][last]
    assert found.unknown["being_overtaken"][last] == (not known)


@pytest.mark.parametrize("types", [(), ("accessRamp",), ("exitRamp",)])
def test_who_gets_up_speed_on_a_lane_that_joins_is_not_overtaken(types):
    road = [
        straight(1, -100, 300, left_of=2, types=frozenset(types)),
        straight(2, -100, 300, 4.0, right_of=1),
    ]
    bodies = [steady(7, 0, 0, 21, steps=12), steady(8, 0, 4.0, 26, steps=12)]
    found = flow_signals(context_of(recording(road, bodies), route=("1",)))
    assert found.world["being_overtaken"][0] == (not types)
    assert not found.unknown["being_overtaken"].any() or not types


@pytest.mark.parametrize(("ago_s", "known"), [(4, False), (11, True)])
def test_who_has_joined_gets_up_speed_yet(ago_s, known):
    """Ego comes at 21 m/s from a lane that joins, and leaves it so long before it is overtaken."""
    road = [
        straight(1, -100, 600, left_of=2, types=frozenset({"accessRamp"})),
        straight(2, -100, 600, 4.0, right_of=1, left_of=3),
        straight(3, -100, 600, 8.0, right_of=2),
    ]
    last = 2 * ago_s + 2
    ego = vehicle(7, {k: (10.5 * k, 0.0 if k < 2 else 4.0) for k in range(last + 4)}, speed=21)
    passes = {k: (10.5 * last + 13.0 * (k - last), 8.0) for k in range(last + 4)}
    other = vehicle(8, passes, speed=26)
    found = flow_signals(context_of(recording(road, [ego, other]), route=("1",)))
    assert found.world["being_overtaken"][last]
    assert found.unknown["being_overtaken"][last] == (not known)


@pytest.mark.parametrize(("speed", "known"), [(9, False), (21, True)])
def test_who_may_have_stood_before_anybody_saw_it_may_set_off(speed, known):
    """To 9 m/s it takes 4.5 s, to 21 m/s 10.5 s."""
    ego, other = steady(7, 0, 0, speed, steps=12), steady(8, 0, 4.0, speed + 5, steps=12)
    found = flow_signals(context_of(recording(lanes(2), [ego, other])))
    assert found.world["being_overtaken"][0]
    assert found.unknown["being_overtaken"][0] == (not known)


@pytest.mark.parametrize(("speed", "known"), [(4, False), (9, True)])
def test_who_is_put_into_all_traffic_slowly_sets_off(speed, known):
    """Simulators begin drives amid the road, at any speed: who is slow then gets going."""
    ego, other = steady(7, 0, 0, speed, steps=12), steady(8, 0, 4.0, speed + 5, steps=12)
    whole = replace(recording(lanes(2), [ego, other]), complete=frozenset({"light"}))
    found = flow_signals(context_of(whole))
    assert found.world["being_overtaken"][0]
    assert found.unknown["being_overtaken"][0] == (not known)


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
    signals = flow_signals(context_of(found))
    assert signals.unknown["dense_all_lanes"][0]
    assert signals.unknown["far_lane_queue"][0]
    assert signals.unknown["being_overtaken"][0] == overtakes


def test_a_lane_between_two_ramps_does_not_decide():
    """It is 200 m long, and has room for a queue, on which nobody is."""
    road = [
        straight(1, -300, 0, successors=("2",)),
        straight(2, 0, 200, predecessors=("1",), successors=("3",), right_of=4),
        straight(3, 200, 500, predecessors=("2",)),
        straight(4, 0, 200, y=-4, left_of=2),
    ]
    found = recording(road, [steady(7, 100, 0), *line(10, 2, start=110.0)])
    dense = flow_signals(context_of(found, ("1", "2", "3"))).world["dense_all_lanes"]
    assert dense.all()


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


def coming(*others, y=4.0, side="right", count=2, steps=12, **thresholds):
    """Is ego being overtaken in the first state, by one of those on the far lane? None: unknown."""
    ego = steady(7, 0, 0, steps=steps)
    bodies = [steady(8 + k, x, y, speed, steps) for k, (x, speed) in enumerate(others)]
    found = replace(recording(lanes(count), [ego, *bodies]), complete=frozenset({"light"}))
    found = flow_signals(context_of(found, ("1",), side, **thresholds))
    return None if found.unknown["being_overtaken"][0] else bool(found.world["being_overtaken"][0])


def test_being_overtaken_is_having_a_faster_vehicle_on_the_far_side():
    # To get past 4 m of ego and its own 4 m at 5 m/s more takes 1.6 s from beside
    assert coming((0, 15)) is True
    assert coming((-13, 15)) is True  # 9 m behind at 5 m/s more: 1.8 s
    assert coming((-15, 15)) is False
    assert coming((20, 15)) is False
    assert coming((0, 10)) is False
    assert coming((0, 15), side="left") is False


def test_who_is_hardly_faster_does_not_overtake():
    assert coming((0, 11.3)) is False  # 4.7 km/h
    assert coming((3, 11.5)) is True  # 5.4 km/h: past in 3.4 s
    assert coming((0, 11.3), clearly_faster_kmh=4) is True


def test_who_overtakes_is_on_the_next_lane():
    assert coming((0, 15), y=8.0, count=3) is False


@pytest.mark.parametrize(("y", "overtaken"), [(4.0, True), (2.8, True), (2.2, False)])
def test_on_the_mark_the_next_lane_is_the_one_that_ego_moves_into(y, overtaken):
    """Ego, 2 m wide, comes from the lane up to y = 2; one passes two lanes farther, at y = 8."""
    bodies = [steady(7, 0, y, 10, 40), steady(8, 0, 8, 15, 40)]
    context = context_of(recording(lanes(3), bodies), near_m=200)
    assert bool(flow_signals(context).world["being_overtaken"][0]) == overtaken


@pytest.mark.parametrize(("complete", "unknown"), [((), True), (("light",), False)])
def test_where_a_world_begins_there_are_no_queues(complete, unknown):
    found = recording([straight(1, 0, 40), straight(2, 0, 40, 4)], [steady(7, 10, 0)])
    found = replace(found, complete=frozenset(complete))
    signals = flow_signals(context_of(found))
    assert signals.unknown["dense_all_lanes"][0] == unknown
    assert not signals.world["dense_all_lanes"][0]


def test_who_gets_past_overtakes_and_the_recording_may_end_before():
    # Faster for a second, then as fast as ego: it stays beside
    places = {k: (-3 + 2 * min(k, 2) + 5.0 * k, 4.0) for k in range(40)}
    ego, other = steady(7, 0, 0, steps=40), vehicle(8, places)
    context = context_of(recording(lanes(2), [ego, other]), near_m=200)
    found = flow_signals(context)
    # And so it does 10 s later
    assert not found.world["being_overtaken"].any()
    assert not found.unknown["being_overtaken"][0]
    assert coming((-13, 15), steps=4) is None


def test_nobody_is_overtaken_where_all_lanes_queue():
    # All drive at 10 m/s, but those beside ego are a little faster
    queues = [*line(10, 2), *line(12, 3, y=4.0, start=0.0, number=30)]
    found = first(*queues)
    assert found["dense_all_lanes"]
    assert not found["being_overtaken"]
    assert coming((0, 12)) is True


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
    dense = flow_signals(context_of(found, ("1", "3"))).world["dense_all_lanes"]
    assert dense[1:].all()
    # A lane that is there all along, without anybody, decides
    assert not first(*line(10, 2))["dense_all_lanes"]


@pytest.mark.parametrize(("behind", "unknown"), [(-20.0, False), (-40.0, True)])
def test_the_last_one_behind_queues_may_be_in_them_or_not(behind, unknown):
    """At 10 m/s a gap of 30 m is the longest that some call one of a queue."""
    both = [*line(10, 2), *line(10, 3, y=4.0, number=30), steady(9, behind, 0)]
    signals = flow_signals(context_of(recording(lanes(2), [steady(7, 0, 0), *both])))
    assert signals.world["dense_all_lanes"][0]
    assert signals.unknown["dense_all_lanes"][0] == unknown


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
    signals = flow_signals(context_of(found, ("1", "3")))
    assert signals.world["dense_all_lanes"][2]
    assert signals.unknown["dense_all_lanes"][2] == unknown


def test_where_the_map_ends_soon_nothing_is_said_of_queues():
    short = recording([straight(1, 0, 40)], [steady(7, 10, 0)])
    assert flow_signals(context_of(short)).unknown["dense_all_lanes"].all()


def test_overtaking_looks_as_far_as_ten_seconds_of_the_difference_need():
    # 200 m at 25 m/s more are 8 s, and farther than what counts for anything else
    ego, slow = steady(7, -90, 4.0, speed=40), steady(8, 114, 0, speed=15)
    context = context_of(recording(lanes(2), [ego, slow]), ("2",))
    assert flow_signals(context).world["overtaking"][0]
    assert not context.relevant[0, 0]


@pytest.mark.parametrize("mps", [25, 36, 45])
def test_the_faster_ego_is_the_farther_queues_are_looked_for(mps):
    """At 36 m/s three vehicles with 2 s between them take up 231 m, more than 100 m each way."""
    road, ego = [straight(1, -300, 900)], steady(7, 0, 0, speed=mps, steps=4)
    alone = flow_signals(context_of(recording(road, [ego])))
    assert not alone.unknown["dense_all_lanes"].any()
    assert not alone.world["dense_all_lanes"].any()
    apart = 1.4 * mps
    others = [steady(8, -apart, 0, speed=mps, steps=4), steady(9, apart, 0, speed=mps, steps=4)]
    queue = flow_signals(context_of(recording(road, [ego, *others])))
    assert queue.world["dense_all_lanes"].all()


@pytest.mark.parametrize(("mps", "queue"), [(10, True), (17, False)])
def test_ego_is_in_the_queue_on_its_own_lane(mps, queue):
    """Three in a lane, ego among them, at 36 or 61 km/h; nobody on the other one."""
    ego = steady(7, 0, 4, speed=mps)
    assert first(*line(mps, 2, y=4.0), ego=ego)["own_lane_queue"] == queue
    assert not first(*line(mps, 2), ego=ego)["own_lane_queue"]


def test_overtaking_begins_when_ego_pulls_out():
    """Ego, at 20 m/s, goes to the left lane from 2 to 3 s; one at 10 m/s was 90 m ahead at 0 s."""
    ways = {k: (10.0 * k, min(max(k - 4, 0) * 2.0, 4.0)) for k in range(12)}
    slow = vehicle(8, {k: (90 + 5.0 * k, 0) for k in range(12)}, speed=10)
    context = context_of(recording(lanes(2), [vehicle(7, ways, speed=20), slow]))
    signals = flow_signals(context)
    overtakes = signals.world["overtaking"].tolist()
    begins = signals.world["begins_to_overtake"].tolist()
    assert not overtakes[3]
    assert overtakes[8]
    assert begins[: overtakes.index(True)] == [True] * overtakes.index(True)
    # Who stays behind does not
    stays = context_of(recording(lanes(2), [steady(7, 0, 0, speed=20), slow]))
    assert not flow_signals(stays).world["begins_to_overtake"].any()


@pytest.mark.parametrize(("complete", "unknown"), [((), True), (("light",), False)])
def test_one_queue_where_a_world_begins_is_not_one_on_all_lanes(complete, unknown):
    """Three are on one of three lanes, which are too short for the longest queue of three."""
    short = [
        straight(1, 0, 60, left_of=2),
        straight(2, 0, 60, 4, right_of=1, left_of=3),
        straight(3, 0, 60, 8, right_of=2),
    ]
    found = recording(short, [steady(7, 10, 0), *line(10, 2, start=24.0)])
    found = replace(found, complete=frozenset(complete))
    signals = flow_signals(context_of(found))
    assert signals.unknown["dense_all_lanes"][0] == unknown
    assert unknown or not signals.world["dense_all_lanes"][0]


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("slow", "past"),
    [
        # 14 m/s behind one at 10, 50 m ahead: beside it within 10 s only later, but out for that
        (range(50, 130, 5), "FFFTTTTTTTTTTTTF"),
        # It gets up speed and is not reached: ego goes back, and may have given up
        (np.cumsum([50, *[9] * 15]), "FFF????????????F"),
        # Whom ego has not come near to it does not mean to pass
        (range(180, 260, 5), "FFFFFFFFFFFFFFFF"),
    ],
)
def test_who_overtakes_beyond_the_middle_does_so_from_going_there_until_it_is_back(
    slow, past, side
):
    ys = [0, 0, 1, *[3.5] * 12, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    other = vehicle(8, {k: (float(x), 0.0) for k, x in enumerate(slow)}, speed=10)
    found = recording([straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])], [ego, other])
    found = mirrored_recording(found) if side == "left" else found
    signals = flow_signals(context_of(found, side=side), {"overtaking"})
    told = zip(signals.world["overtaking"], signals.unknown["overtaking"], strict=True)
    assert "".join("?" if dark else "FT"[int(value)] for value, dark in told) == past

"""Signals of ego alone, on a straight road."""

from dataclasses import replace

import numpy as np
import pytest

from rulec import build_lanelet, build_participant, build_recording, verify_recording
from rulec.extraction.signals import ego_signals
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.defined_words import defined
from support.generators.random_recordings import lanes
from support.signal_arrays import (
    bounds_of,
    possibly_said,
    said,
    texts_of,
    unknown_in,
    values_of,
)
from support.words import words_of


def world(body, count=3, route=("1",), side="right", **thresholds):
    context = context_of(recording(lanes(count), [body]), route, side, **thresholds)
    signals = words_of(ego_signals)(context)
    return {name: possibly_said(signals, name) for name in signals.world}


def drive(*places, **more):
    return vehicle(7, dict(enumerate(places)), **more)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("car", "ego_car"),
        ("taxi", "ego_car"),
        ("truck", "ego_truck"),
        ("bus", "ego_bus"),
        ("motorcycle", "ego_motorcycle"),
        ("priorityVehicle", "ego_emergency_vehicle"),
        ("bicycle", "ego_cycle"),
    ],
)
def test_type_and_length(kind, expected):
    found = world(steady(7, 0, 0, kind=kind, length=6.5))
    assert set(found["ego_type"].tolist()) == {expected}
    assert found["ego_length"].tolist() == [6.5] * 4


def test_the_length_of_one_that_turns_is_its_own():
    t = np.arange(8) / 2
    bend = np.linspace(0, np.pi / 2, 12)
    lane = build_lanelet("bend", np.column_stack((15 * np.sin(bend), 15 - 15 * np.cos(bend))))
    angle = 0.3 + 0.1 * np.arange(8)
    x, y = 15 * np.sin(angle), 15 - 15 * np.cos(angle)
    van = build_participant("7", "car", t, x, y, heading=angle + 0.2, step_s=0.5, length=7.0)
    made = build_recording([lane], [van], step_s=0.5, side="right")
    (judged,) = verify_recording(made, "at").answers()
    assert {state["ego_length"] for state in judged.drive.trace.states} == {7.0}


def test_speed_in_km_h_and_standing():
    assert world(steady(7, 0, 0, speed=10))["speed"].tolist() == [36.0] * 4
    # 0.2 m/s are 0.72 km/h, below the 1 km/h at which a vehicle stands
    assert world(steady(7, 0, 0, speed=0.2))["speed"].tolist() == [0.0] * 4
    assert world(steady(7, 0, 0, speed=0.2), standing_kmh=0.5)["speed"].tolist() == [0.72] * 4


def test_what_can_stop_at_once():
    def at(mps):
        return defined("can_stop_at_once", recording(lanes(3), [steady(7, 0, 0, speed=mps)]))

    # 20 km/h are 5.56 m/s, and a speed is known to about 0.1 m/s, less well at the ends
    assert (at(5.3), at(5.5), at(5.6), at(5.8)) == ("TTTT", "????", "????", "FFFF")


def test_acceleration_and_hard_braking():
    def told(body):
        found = recording(lanes(3), [body])
        return defined("accelerating", found), defined("braking_hard", found)

    # 1, 2, 3, 4 m in half seconds: 2, 4, 6 and 8 m/s in the middle of each, so 4 m/s²
    assert told(drive((0, 0), (1, 0), (3, 0), (6, 0), (10, 0))) == ("?TTT?", "FFFFF")
    # 20, 12, 4 and 0 m/s, so 16, 16 and 8 m/s², known best in the middle
    assert told(drive((0, 0), (10, 0), (16, 0), (18, 0), (18, 0)))[1] == "??T??"
    # 4 m/s², which is not harder than 4, but may be within its error
    assert told(drive((0, 0), (10, 0), (19, 0), (27, 0), (34, 0)))[1] == "?????"
    assert "T" not in told(steady(7, 0, 0))[0]


@pytest.mark.parametrize(
    ("y", "right_hand", "left_hand"),
    [
        (0, "kerb_lane", "far_lane"),
        (4, "middle_lane", "middle_lane"),
        (8, "far_lane", "kerb_lane"),
    ],
)
def test_the_lane_counted_from_the_kerb(y, right_hand, left_hand):
    body = steady(7, 0, y)
    assert set(world(body)["lane"].tolist()) == {right_hand}
    assert set(world(body, side="left")["lane"].tolist()) == {left_hand}


@pytest.mark.parametrize(
    ("count", "expected"),
    [(1, "one_lane"), (2, "two_lanes"), (3, "three_or_more_lanes"), (4, "three_or_more_lanes")],
)
def test_the_number_of_lanes(count, expected):
    found = world(steady(7, 0, 0), count)
    assert set(found["lanes"].tolist()) == {expected}
    # An only lane is the one at the kerb
    assert set(found["lane"].tolist()) == {"kerb_lane"}


def test_lanes_count_where_most_are_beside_ego():
    """The left one of two turns off; ego is 4 m long."""
    road = [
        straight(1, 0, 100, left_of=4, successors=(2,)),
        straight(4, 0, 100, 4, right_of=1, successors=(5,)),
        straight(2, 100, 120, predecessors=(1,), successors=(3,)),
        straight(3, 120, 300, predecessors=(2,)),
        lanelet(5, [(100, 4), (110, 8), (112, 30)], predecessors=(4,)),
    ]
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate((90, 101, 103, 119, 130))})
    found = words_of(ego_signals)(context_of(recording(road, [ego]), ("1", "2", "3")))
    one, two = (texts_of(found, "lanes").index(word) for word in ("one_lane", "two_lanes"))
    assert values_of(found, "lanes").tolist() == [two, two, one, one, one]


@pytest.mark.parametrize("x", np.arange(90.0, 112.0, 0.5))
def test_a_lane_that_forks_hides_none_beside_it(x):
    """The right one of two does at 100 m; what was the second lane is the third one from there."""
    road = [
        straight(1, 0, 100, left_of=4, successors=(2, 3)),
        straight(4, 0, 100, 4, right_of=1, successors=(5,)),
        straight(2, 100, 300, left_of=3, predecessors=(1,)),
        lanelet(3, [(100, 0), (120, 4), (300, 4)], left_of=5, right_of=2, predecessors=(1,)),
        lanelet(5, [(100, 4), (120, 8), (300, 8)], right_of=3, predecessors=(4,)),
    ]
    ego = vehicle(7, {0: (x, 0.0), 1: (x, 0.0)})
    found = words_of(ego_signals)(context_of(recording(road, [ego]), ("1", "2")))
    assert texts_of(found, "lanes")[values_of(found, "lanes")[0]] != "one_lane"


@pytest.mark.parametrize(("y", "lane"), [(0, "kerb_lane"), (4, "kerb_lane"), (8, "far_lane")])
def test_a_hard_shoulder_is_no_lane_to_count(y, lane):
    """It lies along y = 0, right of two lanes."""
    shoulder, *driven = lanes(3)
    road = [replace(shoulder, types=frozenset({"shoulder"})), *driven]
    found = words_of(ego_signals)(context_of(recording(road, [steady(7, 0, y)])))
    assert (set(said(found, "lane")), set(said(found, "lanes"))) == ({lane}, {"two_lanes"})


@pytest.mark.parametrize(
    ("y", "kind", "lane", "count"),
    [
        (12, "shoulder", "far_lane", "two_lanes"),
        (8, "shoulder", "kerb_lane", "two_lanes"),
        (0, "shoulder", "kerb_lane", "one_lane"),
        (12, "urban", "far_lane", "three_or_more_lanes"),
        (0, "urban", "kerb_lane", "three_or_more_lanes"),
    ],
)
def test_beyond_a_shoulder_there_is_another_road(y, kind, lane, count):
    """Of four lanes, 4 m wide, the second is between a road and one beside it."""
    road = lanes(4)
    road[1] = replace(road[1], types=frozenset({kind}))
    context = context_of(recording(road, [steady(7, 0, y)]), (str(1 + y // 4),))
    signals = words_of(ego_signals)(context)
    assert set(said(signals, "lane").tolist()) == {lane}
    assert set(said(signals, "lanes").tolist()) == {count}


@pytest.mark.parametrize(("y", "expected"), [(1.2, False), (1.4, True), (2, True), (2.8, False)])
def test_straddling_needs_thirty_centimetres_on_each_side(y, expected):
    # 2 m wide; the mark lies at 2 m, the road ends at -2 m
    assert world(steady(7, 0, y))["straddling"].tolist() == [expected] * 4
    assert not world(steady(7, 0, -1.5))["straddling"].any()


@pytest.mark.parametrize(
    ("y", "expected"),
    [(0, "centred"), (-0.5, "centred"), (-0.7, "at_near_edge"), (0.7, "at_far_edge")],
)
def test_the_place_in_the_lane(y, expected):
    assert set(world(steady(7, 0, y))["lane_position"].tolist()) == {expected}
    other = {"at_near_edge": "at_far_edge", "at_far_edge": "at_near_edge"}.get(expected, expected)
    assert set(world(steady(7, 0, y), side="left")["lane_position"].tolist()) == {other}


def test_no_edge_is_kept_to_in_a_lane_hardly_wider_than_ego():
    # 20 cm of room to the right, 40 cm to the left
    found = world(steady(7, 0, -0.1, width=3.4))
    assert set(found["lane_position"].tolist()) == {"centred"}


def test_a_lane_is_left_only_well_beyond_its_mark():
    found = recording(lanes(2), [drive((0, 1.9), (5, 2.2), (10, 2.4), (15, 1.8), (20, 1.6))])
    context = context_of(found)
    assert context.ego_lane.tolist() == [0, 1, 1, 0, 0]
    assert context.steady_lane.tolist() == [0, 0, 1, 1, 0]
    early = replace(context, thresholds=replace(context.thresholds, changed_m=0.1))
    assert early.steady_lane.tolist() == [0, 1, 1, 0, 0]


def test_acceleration_has_its_bounds():
    # From 20 to 14 m/s in 1.5 s; those of the middle known to 0.1 m/s: 0.14 m/s² for two of them
    body = drive((0, 0), (10, 0), (19, 0), (27, 0), (34, 0))
    found = words_of(ego_signals)(context_of(recording(lanes(1), [body])))
    assert values_of(found, "acceleration").tolist() == [-4.0] * 5
    low, high = bounds_of(found, "acceleration")
    assert (low[2], high[2]) == (-4.15, -3.85)


@pytest.mark.parametrize(
    ("y", "right_hand", "left_hand"),
    [(0, "first_lane", "fourth_or_further_lane"), (8, "third_lane", "third_lane")],
)
def test_lanes_are_numbered_from_the_kerb(y, right_hand, left_hand):
    body = steady(7, 0, y)
    assert set(world(body, 5)["lane_number"].tolist()) == {right_hand}
    assert set(world(body, 5, side="left")["lane_number"].tolist()) == {left_hand}


@pytest.mark.parametrize(
    ("y", "right_hand", "left_hand"),
    [(0, True, False), (4, True, False), (8, False, True), (12, False, True)],
)
def test_lanes_two_or_more_from_the_far_one_are_apart_from_it(y, right_hand, left_hand):
    # Of four lanes the far one is the uppermost in right-hand traffic
    body = steady(7, 0, y)
    assert set(world(body, 4)["apart_from_far_lane"].tolist()) == {right_hand}
    assert set(world(body, 4, side="left")["apart_from_far_lane"].tolist()) == {left_hand}


def test_whether_the_far_lane_is_apart_is_open_beside_a_mark():
    # 10 cm beyond the mark between the second and the third of four lanes
    signals = words_of(ego_signals)(context_of(recording(lanes(4), [steady(7, 0, 6.1)])))
    assert unknown_in(signals, "apart_from_far_lane").tolist() == [True] * 4


@pytest.mark.parametrize(("end", "unknown"), [(200, True), (800, False)])
def test_beside_a_lane_that_ends_nobody_knows_which_one_is_at_the_kerb(end, unknown):
    road = [
        straight(1, 0, end, left_of=2),
        straight(2, 0, end, 4, right_of=1, left_of=3, successors=(4,)),
        straight(3, 0, end, 8, right_of=2, successors=(5,)),
        straight(4, end, 1600, 4, predecessors=(2,), left_of=5),
        straight(5, end, 1600, 8, predecessors=(3,), right_of=4),
    ]
    body = vehicle(7, dict.fromkeys(range(3), (400 if end == 800 else 100, 4)))
    signals = words_of(ego_signals)(context_of(recording(road, [body]), ("2", "4")))
    assert values_of(signals, "lane").tolist() == [1] * 3
    assert unknown_in(signals, "lane").tolist() == [unknown] * 3

"""What is said of traffic around ego, and of how ego keeps among it."""

import pytest

from rulec.extraction.drives import Drives
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.recordings import recording, vehicle
from support.defined_words import defined
from support.generators.random_recordings import lanes
from support.measured import middle

STEP_S = 0.5


def going(number, x, lane, mps, count=4, across=0.0, **more):
    """A vehicle that starts in the middle of a lane, which are counted from the right, from 1."""
    y = 4.0 * (lane - 1)
    places = {k: (x + mps * STEP_S * k, y + across * STEP_S * k) for k in range(count)}
    return vehicle(number, places, speed=mps, **more)


def states(cars, n_lanes=2, side="right", ego="7", **thresholds):
    found = recording(lanes(n_lanes), cars, step_s=STEP_S)
    (drive,) = Drives(found, side, Thresholds(**thresholds)).of(ego)
    return drive.trace.states


def first(word, *arguments, **more):
    return states(*arguments, **more)[0][word]


@pytest.mark.parametrize(
    ("n_lanes", "lane", "side", "word"),
    [
        (1, 1, "right", "kerb_lane"),
        (2, 1, "right", "kerb_lane"),
        (2, 2, "right", "far_lane"),
        (2, 1, "left", "far_lane"),
        (2, 2, "left", "kerb_lane"),
        (3, 2, "right", "middle_lane"),
        (3, 2, "left", "middle_lane"),
        (3, 1, "left", "far_lane"),
    ],
)
def test_lanes_are_counted_from_the_kerb(n_lanes, lane, side, word):
    assert first("lane", [going(7, 0, lane, 10)], n_lanes=n_lanes, side=side) == word


@pytest.mark.parametrize(("count", "word"), [(1, "one_lane"), (2, "two_lanes")])
def test_how_many_lanes(count, word):
    assert first("lanes", [going(7, 0, 1, 10)], n_lanes=count) == word


def test_a_change_of_lanes():
    # 1 m/s to the left over the mark at y = 2: the middle is 0.3 m beyond it at 2.3 s, in state 5.
    # Its sides, 1 m from the middle, reach 0.3 m over the mark from y = 1.3 on up to 2.7.
    told = states([going(7, 0, 1, 20, count=8, across=1.0)])
    assert [state["lane_change"] for state in told] == [k == 5 for k in range(8)]
    # At 2.0 s its middle is on the mark: which lane it is in nobody knows
    lanes = [state["lane"] for state in told]
    assert lanes == ["kerb_lane"] * 4 + [UNKNOWN] + ["far_lane"] * 3
    assert [state["straddling"] for state in told] == [k in (3, 4, 5) for k in range(8)]


def test_to_and_fro_on_the_mark_is_no_change_of_lanes():
    places = {k: (10.0 * k, 2.0 + 0.2 * (-1) ** k) for k in range(6)}
    told = states([vehicle(7, places)])
    assert not any(state["lane_change"] for state in told[1:])


@pytest.mark.parametrize(
    ("behind_mps", "gap_m", "clear"),
    [(20, 7, True), (20, 3, False), (28, 30, True), (28, 18, False)],
)
def test_who_has_to_brake_for_a_change_of_lanes(behind_mps, gap_m, clear):
    # Ego changes in state 5 at 20 m/s and x = 50. An equally fast one needs 0.3 s to react, which
    # is 6 m. One that is 8 m/s faster has 8 m less after a second: with 22 m left it brakes with
    # 8²/(2·22) = 1.45 m/s², with 10 m left with 3.2 m/s².
    ego = going(7, 0, 1, 20, count=8, across=1.0)
    other = going(8, 50 - 4 - gap_m - behind_mps * 2.5, 2, behind_mps, count=8)
    told = states([ego, other])
    assert told[5]["lane_is_clear"] is clear
    assert all(state["lane_is_clear"] for k, state in enumerate(told) if k != 5)


@pytest.mark.parametrize(("between_mps", "clear"), [(20, True), (27, False)])
def test_who_has_to_brake_for_another_one_in_between(between_mps, clear):
    """It comes at 28 m/s, 18 m behind ego, and has 4 m to the other one: for that it brakes."""
    ego = going(7, 0, 1, 20, count=8, across=1.0)
    between = going(8, 50 - 4 - 10 - between_mps * 2.5, 2, between_mps, count=8)
    comes = going(9, 50 - 4 - 18 - 28 * 2.5, 2, 28, count=8)
    assert states([ego, comes])[5]["lane_is_clear"] is False
    assert states([ego, between, comes])[5]["lane_is_clear"] is clear


@pytest.mark.parametrize(
    ("cars", "queue"),
    [
        ([going(k, 20 * k, 2, 10) for k in range(1, 5)], True),  # 16 m
        ([going(k, 25 * k, 2, 10) for k in range(1, 5)], UNKNOWN),  # 21 m, 2.1 s
        ([going(k, 35 * k, 2, 10) for k in range(1, 4)], False),  # 31 m, 3.1 s
        ([going(k, 25 * k, 2, 11) for k in range(1, 5)], True),  # 21 m, 1.9 s
        ([going(k, 45 * k, 2, 21) for k in range(1, 4)], False),  # 41 m, but 76 km/h
        ([going(k, 20 * k, 2, 10) for k in range(1, 3)], False),  # two are none
    ],
)
def test_a_queue_on_the_lane_beside(cars, queue):
    assert first("far_lane_queue", [going(7, 0, 1, 20), *cars]) is queue
    assert first("dense_all_lanes", [going(7, 0, 1, 20), *cars]) is False


def test_queues_on_all_lanes():
    cars = [going(k, 20 * (k % 10), 1 + k // 10, 10) for k in (1, 2, 11, 12, 13)]
    behind = going(3, -20, 1, 10)
    assert first("dense_all_lanes", [going(7, 0, 1, 10), *cars, behind]) is True
    # Whether the last one behind a queue is in it nobody knows
    assert first("dense_all_lanes", [going(7, 0, 1, 10), *cars]) is UNKNOWN
    assert first("dense_all_lanes", [going(7, 0, 1, 10), *cars], n_lanes=3) is False


@pytest.mark.parametrize(
    ("mps", "congested", "walking"), [(9, False, False), (8, True, False), (2, True, True)]
)
def test_slow_traffic(mps, congested, walking):
    cars = [going(7, 0, 1, mps), going(1, 30, 1, mps), going(2, 60, 2, mps)]
    told = states(cars)[0]
    assert (told["congested"], told["walking_pace_flow"]) == (congested, walking)
    assert told["CONGESTED"] is congested
    assert states(cars[:2])[0]["congested"] is False
    assert states(cars, fewest=4)[0]["congested"] is False


@pytest.mark.parametrize(
    ("x", "mps", "overtaking"),
    [
        (60, 10, True),  # 56 m ahead, 10 m/s slower: in 5.6 s
        (110, 10, False),  # in 10.6 s
        (2, 10, True),  # beside
        (-40, 10, True),  # 36 m behind: 1.8 s at 20 m/s
        (-50, 10, False),  # 2.3 s
        (60, 25, False),  # it is faster
    ],
)
def test_overtaking(x, mps, overtaking):
    assert first("overtaking", [going(7, 0, 2, 20), going(1, x, 1, mps)]) is overtaking
    # Seen from the other lane nobody overtakes on its far side
    assert first("overtaking", [going(7, 0, 1, 20), going(1, x, 2, mps)]) is False


@pytest.mark.parametrize(
    ("x", "mps", "overtaken"), [(2, 25, True), (-12, 25, True), (-20, 25, False), (2, 15, False)]
)
def test_being_overtaken(x, mps, overtaken):
    # From 8 m behind at 5 m/s more it is beside in 1.6 s, from 16 m in 3.2 s
    cars = [going(7, -60, 1, 20, count=12), going(1, x - 60, 2, mps, count=12)]
    assert first("being_overtaken", cars) is overtaken


@pytest.mark.parametrize(("gap_m", "safe"), [(19, False), (21, True)])
def test_a_safe_gap(gap_m, safe):
    # At 20 m/s behind one as fast: what ego drives in a second
    cars = [going(7, 0, 1, 20), going(1, 4 + gap_m, 1, 20), going(2, 4 + gap_m, 2, 20)]
    assert first("safe_gap", cars) == {"1": safe, "2": True}
    assert first("precedes", cars) == {"1": True, "2": False}


def test_who_comes_towards_ego():
    coming = going(1, 80, 2, -10, heading=3.14159)
    told = states([going(7, 0, 1, 10), coming], n_lanes=1)[0]
    assert (told["oncoming"], told["lateral"]) == ({"1": True}, {"1": "right_of"})
    assert middle(told["speed_difference"]) == {"1": 72.0}


def test_who_comes_back_is_another_object():
    # 1 is beside the road, off all lanes, in states 3 to 6, for longer than a second
    places = {k: (5.0 + 10.0 * k, 20.0 if 3 <= k <= 6 else 0.0) for k in range(10)}
    cars = [going(7, 0, 1, 20, count=10), vehicle(1, places)]
    found = recording(lanes(1), cars, step_s=STEP_S)
    (drive,) = Drives(found, "right").of("7")
    assert drive.trace.present == {"1": (0, 2), "1_2": (7, 9)}
    assert "1" not in drive.trace.states[5].get("station", {})
    (longer,) = Drives(found, "right", Thresholds(away_s=2.0)).of("7")
    assert longer.trace.present == {}


def test_braking_and_gaining_speed():
    # From 20 m/s with -6 m/s², then on with 2 m/s²
    x, v, places = 0.0, 20.0, {}
    for k in range(12):
        places[k] = (x, 0.0)
        a = -6.0 if k < 5 else 2.0
        x, v = x + v * STEP_S + a * STEP_S**2 / 2, v + a * STEP_S
    told, found = (
        states([vehicle(7, places)]),
        recording(lanes(2), [vehicle(7, places)], step_s=STEP_S),
    )
    brakes, gains = defined("braking_hard", found), defined("accelerating", found)
    assert (brakes[3], gains[3]) == ("T", "F")
    assert (brakes[9], gains[9]) == ("F", "T")
    # Over states 2 to 4, a second around the third: from 20 - 3·1 to 20 - 3·3 m/s on average
    assert middle(told[3]["speed"]) == pytest.approx((20 - 9) * 3.6)


@pytest.mark.parametrize(("mps", "seconds"), [(10, 2.6), (20, 1.3), (0, 1000)])
def test_headway_is_the_gap_over_ego_s_speed(mps, seconds):
    # Both are 4 m long and 30 m apart between their middles: a gap of 26 m.
    found = first("time_headway", [going(7, 0, 1, mps), going(8, 30, 1, 10)])["8"]
    assert middle(found) == pytest.approx(seconds, abs=0.01)

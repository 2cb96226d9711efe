"""Pedestrian crossings, lights and signs before ego, with verdicts thought through."""

from dataclasses import replace

import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.drives import Drives
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Light
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.drive_verdicts import violated
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.measured import middle

STEP_S = 0.5
GERMAN = machines("de")


def states(found, ego, side="right", **thresholds):
    (drive,) = Drives(found, side, Thresholds(**thresholds)).of(ego)
    return drive.trace.states


def going(number, x, mps, count=12, y=0.0, **more):
    places = {k: (x + mps * STEP_S * k, y) for k in range(count)}
    return vehicle(number, places, speed=mps, **more)


def on_foot(number, places):
    return vehicle(number, places, "pedestrian", length=0.5, width=0.5)


def zebra(number=9, x=100.0):
    """A crossing of 4 m along the road, from 4 m to the right of ego's lane to as far left."""
    return lanelet(number, [(x, -6.0), (x, 6.0)], types=frozenset({"crosswalk"}))


ROAD = straight(1, 0, 300)
# The lane reaches from y = -2 to 2, the crossing from x = 98 to 102.
STANDING, CROSSING, AWAY = (100.0, -3.5), (100.0, 0.0), (120.0, -3.5)


@pytest.mark.parametrize(
    ("place", "use"),
    [(STANDING, "waiting_to_cross"), (CROSSING, "on_crossing"), (AWAY, "not_crossing")],
)
def test_who_stands(place, use):
    people = [going(7, 40, 10.0), on_foot(8, dict.fromkeys(range(12), place))]
    found = recording([ROAD, zebra()], people)
    assert {state["crossing_use"]["8"] for state in states(found, "7")} == {use}


def test_who_walks():
    # At 1.2 m/s across, from y = -6 on, with a body of 0.25 m to either side of its middle
    places = {k: (100.0, -6.0 + 0.6 * k) for k in range(16)}
    people = [going(7, 40, 2.0, count=16), on_foot(8, places)]
    uses = [state["crossing_use"]["8"] for state in states(recording([ROAD, zebra()], people), "7")]
    # 3.75 m to the lane at first and 0.6 m less in each state; 2 s of walking are 2.4 m, half a
    # second 0.6 m. Its middle is on the lane from -1.8 (state 7) to 1.8 (state 13).
    far, soon, enters = 3, 3, 1
    expected = ["not_crossing"] * far + ["about_to_cross"] * soon + ["entering_crossing"] * enters
    on = uses[far + soon + enters :]
    assert uses[: far + soon + enters] == expected
    assert on == ["on_crossing"] * 7 + ["not_crossing"] * 2


def test_who_walks_along_the_pavement_does_not_come_to_cross():
    # At 1.2 m/s along the road, drifting towards it by 0.4 m/s: 0.65 m from the lane at first, it
    # would be there in less than 2 s, which is not where it goes
    places = {k: (99.0 + 0.6 * k, -2.9 + 0.2 * k) for k in range(3)}
    people = [going(7, 40, 2.0, count=3), on_foot(8, places)]
    found = recording([ROAD, zebra()], people)
    assert {state["crossing_use"]["8"] for state in states(found, "7")} == {"not_crossing"}


def test_driving_over_a_crossing_somebody_is_on():
    # 7 is 4 m long: its front reaches the crossing, at 98 m, when 42 + 10 t > 98, from 6.0 s on
    people = [going(7, 40, 10.0, count=20), on_foot(8, dict.fromkeys(range(20), CROSSING))]
    found = violated(recording([ROAD, zebra()], people), GERMAN)
    assert found["7"]["give_way_to_pedestrians"] == 6.0
    aside = [people[0], on_foot(8, dict.fromkeys(range(20), AWAY))]
    assert "give_way_to_pedestrians" not in violated(recording([ROAD, zebra()], aside), GERMAN)["7"]


def test_the_way_to_the_crossing():
    found = recording([ROAD, zebra()], [going(7, 80, 10.0, count=8)])
    told = [
        (middle(state["distance_to_crossing"]), state["crossing_zone"], state["surface"])
        for state in states(found, "7")
    ]
    # The front is at 82 + 5 k, the rear 4 m behind it: at 102 the rear is on the crossing alone
    assert told == [
        (16.0, False, "carriageway"),
        (11.0, False, "carriageway"),
        (6.0, False, "carriageway"),
        (1.0, True, "carriageway"),
        (0.0, UNKNOWN, "crossing"),
        (1000.0, False, "carriageway"),
        (1000.0, False, "carriageway"),
        (1000.0, False, "carriageway"),
    ]


def lit(colours, begin=0):
    """Two lanelets; at the end of the first, at x = 100, is a light."""
    first = straight(1, 0, 100, lights=(Light(begin, colours),), successors=("2",))
    return [first, straight(2, 100, 300, predecessors=("1",))]


# 7 has its front at 92 + 5 k: it crosses the line in state 2.
def test_crossing_the_line_at_red():
    found = recording(lit((("red", 10), ("green", 10))), [going(7, 90, 10.0)])
    assert violated(found, GERMAN)["7"]["red_light"] == 1.0
    green = recording(lit((("green", 10), ("red", 10))), [going(7, 90, 10.0)])
    assert "red_light" not in violated(green, GERMAN)["7"]


@pytest.mark.parametrize(
    ("begins", "crossed"),
    [
        # Its front is at 100 and 100.3 m 0.01 and 0.04 s after state 1, between, or before state 2
        (92.9, "red_light"),
        (90.8, UNKNOWN),
        (88.4, "green_light"),
    ],
)
def test_the_light_is_the_one_that_is_crossed(begins, crossed):
    """It turns green between the states before and after: 5 m, and half a second."""
    found = recording(lit((("red", 2), ("green", 10))), [going(7, begins, 10.0)])
    told = [(state["light"], state["crosses_light_line"]) for state in states(found, "7")]
    assert told[:4] == [
        ("red_light", False),
        ("red_light", False),
        (crossed, True),
        ("no_light", False),
    ]


def test_who_stands_beyond_the_place_of_a_line_sets_off_from_there():
    """It stops with its front at 100.2 m while it is red, and goes on at green."""
    places = {k: (x, 0) for k, x in enumerate((96.0, 98.2, 98.2, 98.2, 98.2, 100.0, 104.0))}
    found = recording(lit((("red", 3), ("green", 10))), [vehicle(7, places)])
    told = [(state["light"], state["crosses_light_line"]) for state in states(found, "7")]
    assert told[4:6] == [("green_light", False), ("green_light", True)]


def test_lights_that_differ_tell_nothing():
    lanes = lit((("red", 10),))
    both = replace(lanes[0], lights=(Light(0, (("red", 10),)), Light(0, (("green", 10),))))
    found = states(recording([both, lanes[1]], [going(7, 90, 10.0)]), "7")
    assert [state["light"] is UNKNOWN for state in found[:4]] == [True, True, True, False]


def test_a_stop_sign():
    lanes = [
        straight(1, 0, 100, signs=frozenset({"STOP"}), successors=("2",)),
        straight(2, 100, 300, predecessors=("1",)),
    ]
    found = recording(lanes, [going(7, 90, 10.0)])
    assert violated(found, GERMAN)["7"]["stop_sign"] == 1.0
    # Who stands there for a second may go on
    places = {0: (93.0, 0), 1: (96.0, 0), 2: (97.9, 0), 3: (97.9, 0), 4: (97.9, 0), 5: (97.9, 0)}
    places |= {6: (98.0, 0.0), 7: (99.0, 0.0), 8: (102.0, 0.0), 9: (106.0, 0.0)}
    stops = recording(lanes, [vehicle(7, places)])
    assert "stop_sign" not in violated(stops, GERMAN)["7"]


@pytest.mark.parametrize(("mps", "sure"), [(10.0, True), (5.0, False)])
def test_who_comes_fast_has_not_stopped_before_the_recording_either(mps, sure):
    """Who creeps from the first state on may have stood at the line just before it."""
    lanes = [
        straight(1, 0, 100, signs=frozenset({"STOP"}), successors=("2",)),
        straight(2, 100, 300, predecessors=("1",)),
    ]
    found = recording(lanes, [going(7, 90, mps)])
    assert ("stop_sign" in violated(found, GERMAN, defaults=False)["7"]) is sure


def test_a_junction():
    # 1 and 2 lead straight on; 5 crosses 2 at a right angle
    lanes = [
        straight(1, 0, 100, successors=("2",)),
        straight(2, 100, 120, predecessors=("1",), successors=("3",)),
        straight(3, 120, 300, predecessors=("2",)),
        lanelet(5, [(110, -50), (110, 50)]),
    ]
    told = states(recording(lanes, [going(7, 84, 10.0, count=9)]), "7")
    # The front is at 86 + 5 k, the middle at 84 + 5 k, the rear at 82 + 5 k
    assert [state["junction_zone"] for state in told] == [False] * 2 + [True] * 6 + [False]
    assert [state["enters_junction"] for state in told] == [k == 3 for k in range(9)]
    assert [state["surface"] == "junction" for state in told] == [4 <= k <= 7 for k in range(9)]
    assert {state["turn"] for state in told} == {"straight_on"}


def test_a_way_through_a_junction_may_begin_at_a_lanelet_that_a_cut_out_has_not():
    lanes = [
        straight(1, 0, 100, successors=("2",)),
        straight(2, 100, 120, predecessors=("1",), types=frozenset({"intersection"})),
        lanelet(5, [(110, -9), (110, 9)], predecessors=("99",), types=frozenset({"intersection"})),
        zebra(),
    ]
    told = states(recording(lanes, [going(7, 84, 10.0, count=5)]), "7")
    assert [state["junction_zone"] for state in told] == [False] * 2 + [True] * 3


@pytest.mark.parametrize(("side", "turn"), [("right", "turn_far"), ("left", "turn_near")])
def test_a_turn_to_the_left(side, turn):
    bend = [(100, 0), (104, 0.8), (107.6, 3), (110, 6.6), (110.8, 10.6)]
    lanes = [
        straight(1, 0, 100, successors=("2",)),
        lanelet(2, bend, predecessors=("1",), successors=("3",), types=frozenset({"intersection"})),
        lanelet(3, [(110.8, 10.6), (111.6, 200)], predecessors=("2",)),
    ]
    # The front is at 82 + 5 k, the zone begins 5 m before 100
    places = {0: (80.0, 0.0), 1: (85.0, 0.0), 2: (90.0, 0.0), 3: (95.0, 0.0), 4: (100.0, 0.0)}
    one = vehicle(7, {**places, 5: (104.0, 0.8), 6: (107.6, 3.0)})
    told = states(recording(lanes, [one]), "7", side)
    assert [state["turn"] for state in told] == ["straight_on"] * 3 + [turn] * 4
    # One second is two states
    soon = states(recording(lanes, [one]), "7", side, preparing_s=1.0)
    assert [state["preparing_to_leave"] for state in soon] == [False] + [True] * 6

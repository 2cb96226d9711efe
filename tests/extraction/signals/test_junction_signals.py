"""Signals of junctions, stop lines and traffic lights before them."""

from math import cos, radians, sin

import pytest

from rulec.extraction.signals.map import junction_signals, line_signals
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import all_said, unknown_in, values_of
from support.words import words_of

at_junctions = words_of(junction_signals, line_signals)

JUNCTION = frozenset({"intersection"})


def signals(body, middle=None, side="right", before=None, **thresholds):
    """On a road with a junction from x = 100 to 120."""
    lanes = [
        straight(1, 0, 100, successors=(2,), **(before or {})),
        middle or straight(2, 100, 120, predecessors=(1,), successors=(3,), types=JUNCTION),
    ]
    if middle is None:
        lanes.append(straight(3, 120, 300, predecessors=(2,)))
    route = tuple(lane.id for lane in lanes)
    return at_junctions(context_of(recording(lanes, [body]), route, side, **thresholds))


def along(*xs, length=4.0):
    return vehicle(7, {k: (x, 0) for k, x in enumerate(xs)}, length=length)


def test_the_zone_reaches_from_before_the_junction_to_its_end():
    # The front is 2 m ahead of the middle: 5 m before the junction begins at 93
    found = all_said(signals(along(92, 94, 97, 99, 121, 123)))
    assert found["junction_zone"].tolist() == [False, True, True, True, True, False]
    assert found["enters_junction"].tolist() == [False, False, False, True, False, False]


def test_whoever_begins_in_a_junction_does_not_enter_it():
    assert not values_of(signals(along(105, 110, 115)), "enters_junction").any()


def bend(degrees):
    """A junction in which the road turns to the left, by a quarter or less."""
    turn = radians(degrees)
    ends = [(110, 0), (110 + 30 * cos(turn), 30 * sin(turn))]
    return lanelet(2, [(100, 0), *ends], predecessors=(1,), types=JUNCTION)


@pytest.mark.parametrize(
    ("degrees", "right_hand", "left_hand"),
    [
        (0, "straight_on", "straight_on"),
        (40, "straight_on", "straight_on"),
        (60, "turn_far", "turn_near"),
        (-60, "turn_near", "turn_far"),
        (-130, "turn_near", "turn_far"),
    ],
)
def test_turns_by_their_angle_and_the_side_of_traffic(degrees, right_hand, left_hand):
    body = along(90, 97, 99, 101)
    found = all_said(signals(body, bend(degrees)))
    assert found["turn"].tolist() == ["straight_on", *[right_hand] * 3]
    assert values_of(signals(body, bend(degrees), "left"), "turn")[-1] == left_hand


def test_a_junction_in_which_a_road_comes_back_is_a_turn_round():
    round_again = lanelet(
        2, [(100, 0), (120, 0), (125, 5), (120, 10), (90, 10)], predecessors=(1,), types=JUNCTION
    )
    assert values_of(signals(along(97, 99), round_again), "turn")[-1] == "turn_round"


def test_preparing_is_known_from_what_follows():
    body = along(80, 85, 90, 95, 97, 99)
    found = values_of(signals(body, bend(60), preparing_s=1.0), "preparing_to_leave")
    # The zone begins in state 3: a second before are two states
    assert found.tolist() == [False, True, True, True, True, True]


# 10 m/s for six states, 5 s of standing, and on: the zone begins 11 m beyond where it stood
WAIT = (*range(52, 82, 5), *(82,) * 10, 84, 87, 91, 95, 99)


def test_the_time_in_which_it_waits_to_turn_does_not_count():
    found = signals(along(*WAIT), bend(60), preparing_s=3.0)
    prepares = values_of(found, "preparing_to_leave").tolist()
    # Of the 3 s before the turn it has driven in all up to state 4, at the latest
    assert prepares[:3] == [False] * 3
    assert prepares[5:] == [True] * 16
    assert not unknown_in(found, "preparing_to_leave")[5:].any()
    on = signals(along(*WAIT), bend(0), preparing_s=3.0)
    assert not values_of(on, "preparing_to_leave").any()


def test_nobody_knows_since_when_one_prepares_in_a_queue_that_creeps():
    # 7.2 km/h are slower than one walks: 3 s at 36 km/h, and 10 s so
    creeps = (*range(42, 72, 5), *(72 + k for k in range(21)), 97, 99)
    found = signals(along(*creeps), bend(60), preparing_s=2.0)
    prepares = values_of(found, "preparing_to_leave")
    assert prepares[24:].all()
    assert not prepares[:20].any()
    assert not unknown_in(found, "preparing_to_leave")[:2].any()
    assert unknown_in(found, "preparing_to_leave")[6:20].all()


def test_who_waits_near_a_junction_at_the_drives_end_may_turn_there():
    waits = along(*WAIT[:16])
    found = unknown_in(signals(waits, bend(60), preparing_s=4.0), "preparing_to_leave")
    # At 5 m/s it needs 2.2 s from where it stands, and came with 10 m/s
    assert found[6:].all()
    assert not found[:2].any()
    far = along(*(x - 60 for x in WAIT[:16]))
    assert not unknown_in(signals(far, bend(60), preparing_s=4.0), "preparing_to_leave").any()


def test_stop_lines_lie_at_the_ends_of_their_lanelets():
    stop = {"signs": frozenset({"STOP"})}
    assert "crosses_stop_line" not in signals(along(90, 99)).world
    found = values_of(signals(along(90, 97, 99, 101), before=stop), "crosses_stop_line")
    assert found.tolist() == [False, False, True, False]


@pytest.mark.parametrize(("back", "times"), [(98.27, 1), (97.5, 2)])
def test_a_line_is_crossed_again_only_by_who_was_back_behind_it(back, times):
    """The front is 2 m ahead, the line ends at 100.3 m, and places are good to 0.05 m."""
    stop = {"signs": frozenset({"STOP"})}
    body = along(90, 97, 98.5, back, 98.5, 99, 101)
    found = values_of(signals(body, before=stop), "crosses_stop_line")
    assert found.sum() == times


def test_the_light_at_the_line_ahead():
    # Red for two steps, then green for ten
    before = {"lights": (Light(0, (("red", 2), ("green", 10))),)}
    found = signals(along(40, 60, 80, 99, 105), before=before)
    assert values_of(found, "light").tolist() == [
        "no_light",  # 58 m away
        "red_light",
        "green_light",
        "green_light",  # in the state in which the line is crossed
        "no_light",
    ]
    assert values_of(found, "crosses_light_line").tolist() == [False, False, False, True, False]
    assert not unknown_in(found, "light").any()


def test_a_light_is_ego_s_from_fifty_metres_on():
    # Fronts are 50.5 and 49.5 m before the line
    before = {"lights": (Light(0, (("red", 9),)),)}
    found = values_of(signals(along(47.5, 48.5), before=before), "light")
    assert found.tolist() == ["no_light", "red_light"]
    assert (
        values_of(signals(along(47.5, 48.5), before=before, light_reach_m=51), "light")[0]
        != "no_light"
    )


def test_lights_of_several_colours_leave_egos_unknown():
    both = (Light(0, (("red", 9),)), Light(0, (("green", 9),)))
    found = signals(along(60, 70), before={"lights": both})
    assert unknown_in(found, "light").tolist() == [True, True]
    same = (Light(0, (("red", 9),)), Light(0, (("redYellow", 9),)))
    assert values_of(signals(along(60, 70), before={"lights": same}), "light")[0] == "red_light"


def test_where_no_ways_cross_there_is_no_light():
    # The map ends at 300 m, beyond which there may be one
    found = recording(lanes(2), [vehicle(7, {0: (240, 0), 1: (249, 0)})])
    signals = at_junctions(context_of(found))
    assert values_of(signals, "light").tolist() == ["no_light"] * 2
    assert unknown_in(signals, "light").tolist() == [False, True]
    assert not values_of(signals, "crosses_light_line").any()


def test_a_map_without_lights_says_nothing_of_them():
    assert "light" not in signals(along(90, 99)).world

"""Who changes lanes where another one has no room, as that one shows by getting out of the way."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.conduct import manoeuvre_signals
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from support.builders.drive_contexts import told_on_both_sides
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.words import words_of

STEP_S, STEPS, CHANGE = 0.1, 60, 35
BEGINS, ENDS = 20, 50
"""Ego moves over from 2 to 5 s; its middle is 0.3 m beyond the mark in the state of the change."""


def lanes(count):
    """Lanes 4 m wide."""
    found = []
    for number in range(1, count + 1):
        left, right = (number + 1 if number < count else None), (number - 1 or None)
        found.append(straight(number, 0, 900, 4 * (number - 1), left_of=left, right_of=right))
    return found


def driving(number, start, y, speeds, **more):
    """A vehicle 4 m long and 2 m wide, at these speeds (m/s) and places across in each state."""
    x = start + np.concatenate(([0.0], np.cumsum(speeds[:-1] * STEP_S)))
    body = vehicle(number, {k: (x[k], y[k]) for k in range(STEPS)}, **more)
    states = {k: replace(state, speed=float(speeds[k])) for k, state in body.states.items()}
    return replace(body, states=states)


def across(begin, end, of, to):
    return np.interp(np.arange(STEPS), [begin, end], [of, to])


def steady_speed(mps=20.0):
    return np.full(STEPS, mps)


def braking(begin, mps2, mps=20.0):
    """First this fast, and for a second slower and slower."""
    return np.interp(np.arange(STEPS), [begin, begin + 10], [mps, mps - mps2])


def braking_from_behind(mps2):
    """28 m/s, 8 m/s more than ego's, and slower from 2.8 to 3.8 s."""
    return np.interp(np.arange(STEPS), [28, 38], [28.0, 28.0 - mps2])


def told(*others, road=None, route=("1",), mps=20.0, **more):
    """Whether the lane is clear in the state of the change, "?" where that is unknown."""
    # At 1.33 m/s it is 0.3 m beyond the mark at 2 m after 1.73 s, and there all of the next state
    ego = driving(7, 100, across(BEGINS, ENDS, 0.0, 4.0), steady_speed(mps))
    found = recording(road or lanes(3), [ego, *others], step_s=STEP_S)
    words = told_on_both_sides(
        words_of(lane_change_signals, indicator_signals), found, route, **more
    )
    changes = np.flatnonzero(np.array(words["lane_change"]) == "True")
    assert len(changes) == 1
    assert abs(int(changes[0]) - 38) <= 1
    return words["lane_is_clear"][int(changes[0])]


@pytest.mark.parametrize(
    ("gap_m", "clear"),
    # 0.3 s at 20 m/s are 6 m
    [(1.0, "False"), (5.5, "False"), (6.5, "True"), (15.0, "True")],
)
def test_one_close_behind_has_no_room_to_react(gap_m, clear):
    assert told(driving(8, 96 - gap_m, np.full(STEPS, 4.0), steady_speed())) == clear


@pytest.mark.parametrize(("aside_m", "clear"), [(0.3, "?"), (1.2, "False")])
def test_one_that_lies_in_ego_may_be_its_own_box_seen_twice(aside_m, clear):
    """Both are 2 m wide: 1.2 m aside it is a car that ego runs into."""
    y = across(BEGINS, ENDS, 0.0, 4.0) + aside_m
    assert told(driving(8, 100.5, y, steady_speed())) == clear


def test_ego_draws_away_from_one_close_behind():
    """It is 2 m/s slower: 5 m behind in the state of the change it has 7.6 m less to go."""
    slower = driving(8, 96 - 5.0 + 7.6, np.full(STEPS, 4.0), steady_speed(18.0))
    assert told(slower) == "True"


@pytest.mark.parametrize(
    ("begin", "clear"),
    # Who was on its way before is not driven out; ego begins in state 20
    [(23, "False"), (10, "?")],
)
def test_who_gets_out_of_the_way_sideways_had_no_room(begin, clear):
    other = driving(8, 99, across(begin, begin + 15, 4.0, 6.6), steady_speed())
    assert told(other) == clear


def test_who_goes_aside_far_ahead_was_not_in_the_way():
    other = driving(8, 130, across(23, 38, 4.0, 6.6), steady_speed())
    assert told(other) == "True"


@pytest.mark.parametrize(
    ("start", "mps2", "clear"),
    [
        # Beside ego when that begins, and 6 m farther back, behind it, when that has changed lanes
        (98.0, 8.0, "False"),
        # Too far back to be run into
        (70.0, 8.0, "True"),
    ],
)
def test_who_brakes_out_of_the_way_had_no_room(start, mps2, clear):
    other = driving(8, start, np.full(STEPS, 4.0), braking(22, mps2))
    assert told(other) == clear


@pytest.mark.parametrize(
    ("gap_m", "mps2", "clear"),
    # 0.5 s behind ego, and 1.5 s; it brakes from the change on, after ego has moved over for 1.6 s
    [(10.0, 4.0, "False"), (10.0, 1.0, "True"), (30.0, 4.0, "True")],
)
def test_who_brakes_for_ego_that_comes_in_close_ahead_had_no_room(gap_m, mps2, clear):
    """It is 2 m/s slower than ego, which draws away from it."""
    speeds = braking(CHANGE + 1, mps2) - 2.0
    other = driving(8, 96 - gap_m + 7.6, np.full(STEPS, 4.0), speeds)
    assert told(other) == clear


@pytest.mark.parametrize(
    ("gap_m", "begin", "mps2", "clear"),
    [
        # Ego's body comes over the mark in state 30: who brakes before may let it in
        (1.5, 18, 5.0, "?"),
        (1.5, 25, 5.0, "False"),
        (1.5, 30, 5.0, "False"),
        (1.5, 25, 1.4, "?"),
        # Who has braked before ego begins has opened the gap, which ego takes
        (1.5, 0, 4.0, "True"),
        # 0.4 s behind ego, where only who brakes hard has had to
        (3.0, 18, 5.0, "?"),
        (3.0, 25, 5.0, "?"),
        (3.0, 30, 5.0, "False"),
        (3.0, 25, 1.4, "True"),
        (3.0, 90, 0.0, "True"),
        # 1.6 s
        (12.0, 25, 5.0, "True"),
    ],
)
def test_braking_that_opens_the_gap_does_not_make_it_one(gap_m, begin, mps2, clear):
    """Both drive at 7.5 m/s, at which 0.3 s are 2.25 m."""
    speeds = braking(begin, mps2, 7.5)
    assert told(driving(8, 96 - gap_m, np.full(STEPS, 4.0), speeds), mps=7.5) == clear


def test_who_would_be_ahead_of_ego_is_not_close_behind():
    """It brakes hard, far ahead of ego, for reasons of its own."""
    other = driving(8, 130, np.full(STEPS, 4.0), braking(25, 5.0, 7.5))
    assert told(other, mps=7.5) == "True"


@pytest.mark.parametrize(("mps2", "clear"), [(6.0, "False"), (0.0, "False")])
def test_who_comes_from_behind_has_to_brake_before_ego_is_in_its_lane_or_then(mps2, clear):
    """It is 8 m/s faster, and 14.5 m behind when ego has changed lanes did it not brake before.

    That leaves 6.5 m after a second of reaction, and 64 / 13 = 4.9 m/s² to brake with.
    """
    speeds = braking_from_behind(mps2)
    assert told(driving(8, 100 - 18.5 - 8 * 3.8, np.full(STEPS, 4.0), speeds)) == clear


def test_of_one_whose_speeds_contradict_its_places_nobody_knows_how_hard_it_braked():
    other = driving(8, 100 - 18.5 - 8 * 3.8, np.full(STEPS, 4.0), braking_from_behind(6.0))
    states = {k: replace(state, speed=28.0) for k, state in other.states.items()}
    assert told(replace(other, states=states)) == "?"


@pytest.mark.parametrize(("mps", "clear"), [(14.0, "False"), (6.0, "True")])
def test_who_comes_onto_the_road_looks_for_those_on_it(mps, clear):
    """Ego sets off beside the road at 1 s, and is on its lane at 3 s, at 4 m/s.

    The other one is 14 m behind then: at 10 m/s more it would run into ego within its reaction.
    """
    speeds = np.interp(np.arange(STEPS), [10, 50], [0.0, 8.0])
    ego = driving(7, 100, across(10, 40, -4.0, 0.0), speeds)
    at_3 = 100 + float(speeds[:30].sum()) * STEP_S
    other = driving(8, at_3 - 18 - mps * 3.0, np.zeros(STEPS), np.full(STEPS, mps))
    found = recording([straight(1, 0, 900)], [ego, other], step_s=STEP_S)
    words = told_on_both_sides(words_of(lane_change_signals, indicator_signals), found, ("1",))
    assert "True" not in words["lane_change"]
    assert ("False" in words["lane_is_clear"]) == (clear == "False")
    if clear == "False":
        # Its middle is on the lane, 2 m from the edge, in state 25
        assert words["lane_is_clear"].index("False") == 25
        joins = told_on_both_sides(words_of(manoeuvre_signals), found, ("1",))["joins_road"]
        assert joins[25] == "True"


def test_who_brakes_for_another_one_may_not_brake_for_ego():
    other = driving(8, 98.0, np.full(STEPS, 4.0), braking(22, 8.0))
    slower = driving(9, 140.0, np.full(STEPS, 4.0), steady_speed(12.0))
    assert told(other, slower) == "?"


def test_who_brakes_gently_before_ego_comes_may_let_it_in():
    """It is 1.4 m/s slower when ego comes over the mark, and 10 cm behind it by then."""
    slows = np.interp(np.arange(STEPS), [20, 26], [20.0, 18.6])
    other = driving(8, 96.4, np.full(STEPS, 4.0), slows)
    assert told(other) == "?"


def test_where_ego_s_lane_ends_they_let_each_other_in():
    road = [
        straight(1, 0, 330, left_of=2),
        straight(2, 0, 330, 4, right_of=1, successors=(3,)),
        straight(3, 330, 900, 4, predecessors=(2,)),
    ]
    other = driving(8, 98.0, np.full(STEPS, 4.0), braking(22, 8.0))
    assert told(other, road=road, route=("2", "3")) == "?"


@pytest.mark.parametrize(
    ("away_m", "mps2", "clear"),
    # 10 m/s: with 20 m to ego after a second 100 / 40 = 2.5 m/s² are needed, with 60 m 0.8 m/s²
    [(30, 3.0, "False"), (30, 0.7, "?"), (70, 3.0, "True")],
)
def test_who_turns_round_looks_for_those_who_come_towards_it(away_m, mps2, clear):
    """Ego turns by a half circle, 4 m across, to the lane of the other direction."""
    turns = np.clip((np.arange(STEPS) - 20) / 20, 0, 1) * np.pi
    x = 100 + np.minimum(np.arange(STEPS) - 20, 0) * 0.3 + 2 * np.sin(turns)
    x -= np.maximum(np.arange(STEPS) - 40, 0) * 0.3
    y = 2 - 2 * np.cos(turns)
    poses = [vehicle(7, {k: (x[k], y[k])}, heading=turns[k], speed=3.0) for k in range(STEPS)]
    ego = replace(
        poses[0],
        states={k: pose.states[k] for k, pose in enumerate(poses)},
        outlines={k: pose.outlines[k] for k, pose in enumerate(poses)},
    )
    speeds = np.interp(np.arange(STEPS), [30, 60], [10.0, 10.0 - 3 * mps2])
    # So far from ego's middle when that is across the road
    begins = 102 + away_m + 30 * 1.0
    way = begins - np.concatenate(([0.0], np.cumsum(speeds[:-1] * STEP_S)))
    other = vehicle(8, {k: (way[k], 4.0) for k in range(STEPS)}, heading=np.pi)
    states = {k: replace(state, speed=float(speeds[k])) for k, state in other.states.items()}
    road = [straight(1, 0, 300), lanelet(2, [(300, 4), (0, 4)])]
    found = recording(road, [ego, replace(other, states=states)], step_s=STEP_S)
    words = told_on_both_sides(words_of(lane_change_signals, indicator_signals), found, ("1",))
    told_words = set(words["lane_is_clear"])
    assert told_words - {"True"} == (set() if clear == "True" else {clear})


FORKING = [
    straight(1, 0, 170, left_of=2, successors=(11,)),
    straight(2, 0, 170, 4.0, right_of=1, successors=(12, 20)),
    straight(11, 170, 900, left_of=12, predecessors=(1,)),
    straight(12, 170, 900, 4.0, right_of=11, predecessors=(2,)),
    lanelet(20, [(170, 4), (190, 12), (190, 300)], 4.0, predecessors=(2,)),
]


@pytest.mark.parametrize(
    ("turns", "is_told", "clear"),
    [(False, False, "False"), (True, True, "True"), (True, False, "?")],
    ids=["goes on", "turns off", "turns off, perhaps"],
)
def test_one_that_takes_another_way_before_it_comes_to_egos_lane_brakes_for_that(
    turns, is_told, clear
):
    """Its lane forks at 170 m, where ego has just been; it is on the other way 0.5 s later."""
    y = across(42, 52, 4.0, 14.0 if turns else 4.0)
    other = driving(8, 62, y, braking_from_behind(8.0))
    elsewhere = np.zeros((2, STEPS), dtype=bool)
    elsewhere[1, 45:] = is_told
    assert told(other, road=FORKING, route=("1", "11"), elsewhere=elsewhere) == clear

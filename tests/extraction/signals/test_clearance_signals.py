"""What leaves ego room: who comes towards it, who stands in its lane, access.

Lanes are 4 m wide; ego's has its middle at y = 0, the one towards it at y = 4.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import clearance_signals
from support.builders.drive_contexts import along, steady, told_on_both_sides
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.words import words_of

STEP_S = 0.5


def two_ways():
    return [straight(1, 0, 600), lanelet(2, [(600, 4), (0, 4)])]


def signals(lanes, *bodies, route=("1",), **thresholds):
    """The words, unknown ones as "?", which are the same in the mirror."""
    found = recording(lanes, bodies, step_s=STEP_S)
    return told_on_both_sides(words_of(clearance_signals), found, route, **thresholds)


def ego(x=0.0, mps=10.0, steps=4, y=0.0):
    return steady(7, x, y, mps, steps)


def coming(x, mps=10.0, steps=4, first=0):
    return steady(8, x, 4, -mps, steps, first)


@pytest.mark.parametrize(("x", "clear"), [(100, "False"), (140, "True")])
def test_one_that_comes_within_six_seconds(x, clear):
    # 96 m and 136 m between them, at 20 m/s together: 4.8 s and 6.8 s
    assert signals(two_ways(), ego(), coming(x))["oncoming_clear"][0] == clear


def test_nobody_comes_and_the_lane_can_be_seen():
    # In 6 s two who drive 12 m/s are 144 m nearer, which is less than 150 m
    assert signals(two_ways(), ego(mps=12))["oncoming_clear"] == ["True"] * 4
    assert signals(two_ways(), ego(mps=13))["oncoming_clear"] == ["?"] * 4


def test_a_fast_one_s_way_is_known_from_who_came():
    """At 20 m/s ego drives 6 s, which are 12 states, without meeting anybody."""
    free = signals(two_ways(), ego(mps=20, steps=20))["oncoming_clear"]
    assert free == ["True"] * 8 + ["?"] * 12
    # It is 240 m ahead at first, and beside ego 5.9 s later
    meets = signals(two_ways(), ego(mps=20, steps=20), coming(240, 20, 20))["oncoming_clear"]
    assert meets[0] == "False"
    # Who has passed is in nobody's way
    assert meets[-1] == "?"


@pytest.mark.parametrize(
    ("x", "slows_to_mps", "clear"),
    [(320, 20.0, "False"), (320, 2.0, "?"), (580, 20.0, "True"), (580, 2.0, "True")],
)
def test_one_that_brakes_may_do_so_for_ego(x, slows_to_mps, clear):
    """Ego is over the middle from 2.5 to 15.5 s; they would meet at 11 or 19 s.

    From 4 to 7.6 s the other one brakes by 5 m/s², and then is 45 m away when ego is back.
    """
    times = np.arange(0, 20, STEP_S)
    out_and_back = [(0.0, 0.0), (20.0, 0.0), (40.0, 4.0), (140.0, 4.0), (160.0, 0.0), (600.0, 0.0)]
    speeds = np.interp(times, [0, 4, 7.6, 20], [20, 20, slows_to_mps, slows_to_mps])
    driven = np.concatenate(([0.0], np.cumsum((speeds[1:] + speeds[:-1]) / 2 * STEP_S)))
    passes = along(7, np.array(out_and_back), 10 * times)
    comes = along(8, np.array([(600.0, 4.0), (0.0, 4.0)]), 600 - x + driven)
    found = signals(two_ways(), passes, comes)["oncoming_clear"]
    assert found[round(3 / STEP_S)] == clear
    # Or it appears when ego is over the middle already
    states, outlines = (
        {step: one for step, one in each.items() if step >= 4 / STEP_S}
        for each in (comes.states, comes.outlines)
    )
    late = replace(comes, states=states, outlines=outlines)
    found = signals(two_ways(), passes, late)["oncoming_clear"]
    assert found[round(3 / STEP_S)] == clear


def test_one_that_appears_midway():
    found = signals(two_ways(), ego(mps=20, steps=20), coming(200, 20, 10, first=4))
    # At 2 s it is 160 m ahead: they meet at about 5.9 s
    assert found["oncoming_clear"][0] == "False"


def test_one_that_stands_or_comes_on_the_other_carriageway_is_in_nobodys_way():
    stands = replace(coming(60, 0), states=steady(8, 60, 4, 0, 4, heading=np.pi).states)
    assert signals(two_ways(), ego(), stands)["oncoming_clear"] == ["True"] * 4
    divided = [straight(1, 0, 600), lanelet(2, [(600, 8), (0, 8)])]
    comes = steady(8, 60, 8, -10, 4)
    assert signals(divided, ego(), comes)["oncoming_clear"] == ["True"] * 4


def test_a_lane_of_ego_s_direction_needs_no_room_among_those_who_come():
    lanes = [
        straight(1, 0, 600, left_of=3),
        straight(3, 0, 600, 4, right_of=1),
        lanelet(2, [(600, 8), (0, 8)]),
    ]
    comes = steady(8, 60, 8, -10, 4)
    assert signals(lanes, ego(), comes)["oncoming_clear"] == ["True"] * 4
    # Nor does one that is on the far lane of its direction already, unless it reaches over its edge
    assert signals(lanes, ego(y=4), comes)["oncoming_clear"] == ["True"] * 4
    assert signals(lanes, ego(y=5.5), comes)["oncoming_clear"][0] == "False"


@pytest.mark.parametrize(
    ("x", "y", "blocked"),
    [
        (30, 0.0, True),  # 26 m ahead
        (40, 0.0, False),  # 36 m
        (2, 0.0, True),  # beside
        (-25, 0.0, True),  # 21 m behind: ego may be on its way back
        (-40, 0.0, False),
        (30, -1.7, False),  # it reaches to y = -0.7: 2.7 m are free, and ego is 2 m wide
        (30, -1.4, True),  # 2.4 m are too few
        (30, 4.0, False),  # on the other lane
    ],
)
def test_who_stands_in_ego_s_lane(x, y, blocked):
    found = signals(two_ways(), ego(mps=0), vehicle(9, dict.fromkeys(range(4), (x, y))))
    assert found["obstructed"] == [str(blocked)] * 4


@pytest.mark.parametrize(
    ("mps", "x", "blocked"), [(15, 63, True), (15, 67, False), (5, 35, False), (15, -40, False)]
)
def test_who_is_fast_goes_out_early_for_one_that_never_moves(mps, x, blocked):
    """Ego's front is 2 m ahead of its middle, and the other one's rear 2 m behind: 59 and 63 m."""
    stands = vehicle(9, dict.fromkeys(range(4), (x, 0.0)))
    assert signals(two_ways(), ego(mps=mps), stands)["obstructed"][0] == str(blocked)
    # One that stands for a while may wait in a queue
    waits = vehicle(9, {**dict.fromkeys(range(3), (x, 0.0)), 3: (x + 5.0, 0.0)})
    assert signals(two_ways(), ego(mps=mps), waits)["obstructed"][0] == "False"


def test_ego_passes_an_obstacle_on_the_lane_beside():
    """Ego is over the mark with most of its body, and not yet past the one that stands."""
    lanes = [straight(1, 0, 600, left_of=3), straight(3, 0, 600, 4, right_of=1)]
    stands = vehicle(9, dict.fromkeys(range(4), (20.0, 0.0)))
    crossing = vehicle(7, dict.fromkeys(range(4), (18.0, 2.6)))
    assert signals(lanes, crossing, stands)["obstructed"] == ["True"] * 4
    beyond = vehicle(7, dict.fromkeys(range(4), (18.0, 4.0)))
    assert signals(lanes, beyond, stands)["obstructed"] == ["False"] * 4


@pytest.mark.parametrize(
    ("start", "step", "blocked"),
    [
        ((20.0, -1.7), (-0.7, 0.0), True),  # towards ego, at the edge: 3.4 m and less are left
        ((20.0, -1.7), (0.7, 0.0), True),  # or along with it
        ((20.0, -1.7), (0.0, 0.7), False),  # crosses the road
        ((20.0, -2.6), (0.7, 0.0), False),  # beside the road
        ((45.0, -1.7), (0.7, 0.0), False),  # farther ahead than ego would be in 4 s
    ],
)
def test_who_walks_along_in_ego_s_lane_leaves_no_room(start, step, blocked):
    """Ego is 2 m wide and wants 1.5 m to them, in a lane of 4 m that reaches from -2 to 2."""
    places = {k: (start[0] + step[0] * k, start[1] + step[1] * k) for k in range(4)}
    heading = float(np.arctan2(step[1], step[0]))
    walker = vehicle(9, places, "pedestrian", length=0.5, width=0.5, speed=1.4, heading=heading)
    assert signals(two_ways(), ego(mps=2), walker)["obstructed"][0] == str(blocked)


@pytest.mark.parametrize(("x", "blocked"), [(-57.0, True), (-65.0, False)])
def test_who_is_fast_needs_time_to_get_back_from_one_that_walks(x, blocked):
    """At 15 m/s ego may go on for 60 m beyond; 2.25 m lie between rear and middle."""
    places = {k: (x + 0.7 * k, -1.7) for k in range(4)}
    walker = vehicle(9, places, "pedestrian", length=0.5, width=0.5, speed=1.4)
    assert signals(two_ways(), ego(mps=15), walker)["obstructed"][0] == str(blocked)


ROUND_M = 3.4
"""How far aside ego goes round an obstacle: into the middle of the next lane, or almost."""


def goes_round(out_s, clear_m, back_s, *, mps, step_s, until_s=14.0, first_s=0.0, aside=ROUND_M):
    """Ego at y = 0, aside from ``out_s`` before one that stands at x = 100, and back after it.

    Ego begins to go back when it is ``clear_m`` ahead of it, and takes ``back_s``.
    """
    steps = np.arange(round(first_s / step_s), round(until_s / step_s) + 1)
    at, beside_s = steps * step_s, 96.0 / mps
    turns = [beside_s - out_s - 2.0, beside_s - out_s, (104.0 + clear_m) / mps]
    y = np.interp(at, [*turns, turns[-1] + back_s], [0.0, aside, aside, 0.0])
    places = {int(k): (mps * s, d) for k, s, d in zip(steps, at, y, strict=True)}
    return vehicle(7, places, speed=mps)


def stands(x=100.0, y=0.0, number=9, steps=150, **more):
    return vehicle(number, dict.fromkeys(range(steps), (x, y)), **more)


def waits(x=100.0, seconds=12.0, step_s=0.1):
    """One that drives off in the end."""
    stood = round(seconds / step_s)
    return vehicle(9, {**dict.fromkeys(range(stood), (x, 0.0)), stood: (x + 5.0, 0.0)})


def told(lanes, body, *others, step_s=0.1):
    """Whether ego is obstructed, by time (s); the same in the mirror."""
    found = recording(lanes, [body, *others], step_s=step_s)
    column = told_on_both_sides(words_of(clearance_signals), found, ("1",))["obstructed"]
    return dict(zip([round(k * step_s, 1) for k in body.states], column, strict=True))


def those_in(column, first_s, last_s):
    return {value for at, value in column.items() if first_s <= at <= last_s}


@pytest.mark.parametrize("step_s", [0.1, 0.5])
@pytest.mark.parametrize("mps", [9.0, 14.0, 20.0])
@pytest.mark.parametrize("other", [stands, waits])
def test_ego_is_still_on_its_way_back_from_an_obstacle(mps, step_s, other):
    """Its rear is 5 m beyond when it begins to go back over the middle, which takes 3.5 s."""
    body = goes_round(1.0, 7.0, 3.5, mps=mps, step_s=step_s, until_s=15.0)
    column = told(
        two_ways(), body, stands() if other is stands else waits(step_s=step_s), step_s=step_s
    )
    # It is back when it reaches over the line by 30 cm, with its middle at y = 1.3
    beyond_s, back_s = 136 / mps, 111 / mps + 3.5 * (1 - 1.3 / ROUND_M)
    assert "False" not in those_in(column, 94 / mps, back_s - step_s)
    assert those_in(column, beyond_s + step_s, back_s - step_s) <= {"?"}
    assert those_in(column, max(back_s, beyond_s) + step_s, 15.0) <= {"False"}


def test_who_does_not_go_back_is_on_its_way_round_for_six_seconds():
    column = told(
        two_ways(), goes_round(1.0, 300.0, 3.0, mps=14.0, step_s=0.1, aside=1.5), stands()
    )
    # At 7.6 s ego's rear is level with the obstacle's front
    assert those_in(column, 10.0, 13.4) == {"?"}
    assert those_in(column, 13.8, 14.0) == {"False"}


def test_who_was_in_the_next_lane_long_before_does_not_come_back_from_an_obstacle():
    body = goes_round(5.0, 40.0, 3.0, mps=10.0, step_s=0.1, until_s=18.0)
    from_far = told(two_ways(), body, stands(steps=200))
    # Ego left its lane 7 s before
    assert those_in(from_far, 13.8, 18.0) == {"False"}


def next_lanes():
    """Ego's lane, and two lanes of its direction to the left of it."""
    return [
        straight(1, -200, 600, left_of=3),
        straight(3, -200, 600, 4, left_of=4, right_of=1),
        straight(4, -200, 600, 8, right_of=3),
    ]


@pytest.mark.parametrize(("step_s", "mps"), [(0.1, 9.0), (0.5, 9.0), (0.1, 20.0), (1.0, 20.0)])
def test_in_the_next_lane_ego_may_be_on_its_way_round(step_s, mps):
    """It is wholly in it, also beside the obstacle, from which it came and goes back."""
    body = goes_round(2.0, 10.0, 3.0, mps=mps, step_s=step_s, until_s=18.0, aside=4.0)
    column = told(next_lanes(), body, stands(steps=200), step_s=step_s)
    beside_s, back_s = 96 / mps, 114 / mps
    assert those_in(column, beside_s - 1.0, back_s) == {"?"}
    # One that drives off in the end may have waited in a queue
    waiting = told(next_lanes(), body, waits(seconds=16.0, step_s=step_s), step_s=step_s)
    assert those_in(waiting, beside_s - 1.0, back_s) == {"False"}
    walks = {k: (98 + 0.1 * k * step_s, 0.0) for k in range(200)}
    walker = vehicle(9, walks, "pedestrian", length=0.5, width=0.5, speed=0.1)
    assert those_in(told(next_lanes(), body, walker, step_s=step_s), beside_s, back_s) == {"?"}


def test_who_only_drives_in_the_next_lane_goes_round_nothing():
    """Whoever stands beside its way, and however many."""
    queue = [stands(80.0 + 7.0 * k, number=10 + k) for k in range(8)]
    passes = vehicle(7, {k: (1.4 * k, 4.0) for k in range(141)}, speed=14.0)
    assert set(told(next_lanes(), passes, *queue).values()) == {"False"}
    # Nor does one that came from ego's lane long before, or only goes there long after
    early = goes_round(6.5, 300.0, 3.0, mps=10.0, step_s=0.1, aside=4.0, until_s=18.0)
    assert those_in(told(next_lanes(), early, stands(steps=200)), 4.0, 18.0) == {"False"}
    late = goes_round(30.0, 70.0, 3.0, mps=10.0, step_s=0.1, aside=4.0, until_s=21.0)
    assert those_in(told(next_lanes(), late, stands(steps=220)), 0.0, 18.0) == {"False"}


def test_beside_an_obstacle_two_lanes_away_ego_goes_round_nothing():
    body = goes_round(2.0, 10.0, 3.0, mps=9.0, step_s=0.1, aside=8.0)
    assert those_in(told(next_lanes(), body, stands()), 10.0, 12.0) == {"False"}
    # Nor over the line beyond the next lane
    body = goes_round(2.0, 10.0, 3.0, mps=9.0, step_s=0.1, aside=6.0)
    assert those_in(told(next_lanes(), body, stands()), 10.0, 12.0) == {"False"}


def test_ego_goes_round_several_one_after_another():
    cars = [stands(100.0 + 40.0 * k, number=10 + k, steps=300) for k in range(4)]
    body = goes_round(2.0, 125.0, 3.0, mps=9.0, step_s=0.1, aside=4.0, until_s=29.0)
    assert those_in(told(next_lanes(), body, *cars), 10.0, 25.0) == {"?"}


def test_one_that_moves_is_no_obstacle():
    assert signals(two_ways(), ego(), steady(9, 20, 0, 5))["obstructed"] == ["False"] * 4


@pytest.mark.parametrize(("y", "room"), [(2.0, "True"), (1.4, "False"), (0.0, "False")])
def test_room_on_the_near_side(y, room):
    # From the lane's edge at -2 to the other's side at y - 1; ego needs 2.5 m
    lanes = [straight(1, 0, 600, left_of=3), straight(3, 0, 600, 4, right_of=1)]
    found = signals(lanes, ego(), steady(9, 30, y, 5))
    assert found["room_on_near_side"] == [[room] * 4]


def bend():
    """Ego turns left at 50 m, with a radius of 6 m, into a road at x = 56."""
    angles = np.radians(np.linspace(-90, 0, 10))
    turn = np.stack((50 + 6 * np.cos(angles), 6 + 6 * np.sin(angles)), axis=1)
    inside = frozenset({"intersection"})
    lanes = [
        straight(1, -100, 50, successors=(2,)),
        lanelet(2, turn, predecessors=(1,), successors=(3,), types=inside),
        lanelet(3, [(56, 6), (56, 100)], predecessors=(2,)),
    ]
    return lanes, np.concatenate(([(12.0, 0.0)], turn, [(56.0, 100.0)]))


def test_access_is_what_ego_turns_to_within_five_seconds():
    # At 5 m/s: in the junction from 38 to 47.4 m on, which are the states 16 to 18
    lanes, line = bend()
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    way = 2.5 * np.arange(35)
    x, y = (np.interp(way, along, line[:, axis]) for axis in (0, 1))
    heading = np.clip((way - 38) / 6, 0, np.pi / 2)
    bodies = [vehicle(7, {k: (x[k], y[k])}, heading=heading[k]) for k in range(35)]
    body = replace(
        bodies[0],
        states={k: one.states[k] for k, one in enumerate(bodies)},
        outlines={k: one.outlines[k] for k, one in enumerate(bodies)},
    )
    found = signals(lanes, body, route=("1", "2", "3"))["needs_access"]
    # 5 s are 10 states, and it is not known what ego does after the drive
    assert found == ["False"] * 6 + ["True"] * 13 + ["False"] * 6 + ["?"] * 10


def test_a_drive_of_one_state():
    found = signals(two_ways(), ego(mps=20, steps=1))
    assert found["oncoming_clear"] in (["?"], ["True"])
    assert found["obstructed"] == ["False"]

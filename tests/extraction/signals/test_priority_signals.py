"""Whose ways cross ego's at a junction, who is in conflict with it, and what a net's bits say."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rulec.extraction.signals.map import junction_signals, priority_signals
from rulec.extraction.tracks.at_junctions.junctions import junctions_of
from rulec.recordings.recording import Recording
from rulec.recordings.sumo.lanelets import net_lanelets
from rulec.recordings.sumo.net import read_net
from rulec.scenario.recorded.reference_line import turn
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

NETS = sorted((Path(__file__).parents[2] / "worlds/stored").glob("*.net.xml"))
INSIDE = frozenset({"intersection"})
EAST = [
    straight(1, -60, -4, successors=(2,)),
    straight(2, -4, 4, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
    straight(3, 4, 90, predecessors=(2,)),
]
NORTH = [
    lanelet(4, [(0, -90), (0, -4)], successors=(5,)),
    lanelet(5, [(0, -4), (0, 4)], predecessors=(4,), successors=(6,), types=INSIDE, junction="x"),
    lanelet(6, [(0, 4), (0, 90)], predecessors=(5,)),
]
SOUTH = [
    replace(x, left=x.right[::-1], right=x.left[::-1], centre=x.centre[::-1])
    for x in (
        replace(NORTH[2], predecessors=(), successors=("5",)),
        replace(NORTH[1], predecessors=("6",), successors=("4",)),
        replace(NORTH[0], predecessors=("5",), successors=()),
    )
]
STEPS = range(16)


def signals(road, y, heading, complete=("YIELD",)):
    """Ego goes east at 10 m/s, its front in the other's way at 2 s, its rear past it at 2.5 s."""
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    other = vehicle(8, {k: (0, y(k / 2)) for k in STEPS}, speed=10, heading=heading)
    found = replace(recording([*EAST, *road], [ego, other]), complete=frozenset(complete))
    return words_of(priority_signals)(context_of(found, route=("1", "2", "3")))


@pytest.mark.parametrize(
    ("comes_s", "conflict"),
    [(2.5, True), (3.0, True), (4.5, False), (6.0, False), (1.0, False)],
    ids=["at once", "half a second later", "two seconds", "much later", "ego lets it pass"],
)
@pytest.mark.parametrize(
    ("road", "side", "sign"),
    [(NORTH, "conflict_from_right", 1), (SOUTH, "conflict_from_left", -1)],
)
def test_who_is_in_conflict(road, side, sign, comes_s, conflict):
    found = signals(road, lambda t: sign * (-3 + 10 * (t - comes_s)), sign * np.pi / 2)
    other = ({"conflict_from_left", "conflict_from_right"} - {side}).pop()
    assert values_of(found, side)[3] == conflict
    assert found.whom[side][3] == (("8",) if conflict else ())
    assert not values_of(found, other).any()
    assert not unknown_in(found, side).any()


LINK = [
    straight(1, -90, -10, successors=(2,)),
    straight(2, -10, 10, predecessors=(1,), successors=(9,), types=INSIDE, junction="x"),
    straight(9, 10, 25, predecessors=(2,), successors=(10,), signs=frozenset({"YIELD"})),
    straight(10, 25, 33, predecessors=(9,), successors=(11,), types=INSIDE, junction="y"),
    straight(11, 33, 150, predecessors=(10,)),
    lanelet(4, [(7, -90), (7, -10)], successors=(5,)),
    lanelet(5, [(7, -10), (7, 10)], predecessors=(4,), successors=(6,), types=INSIDE, junction="x"),
    lanelet(6, [(7, 10), (7, 90)], predecessors=(5,)),
    lanelet(14, [(29, -90), (29, -4)], successors=(15,)),
    lanelet(
        15, [(29, -4), (29, 4)], predecessors=(14,), successors=(16,), types=INSIDE, junction="y"
    ),
    lanelet(16, [(29, 4), (29, 90)], predecessors=(15,)),
]
"""Two junctions 15 m apart, at the first of which a way crosses ego's just before the link."""


def test_a_drive_that_breaks_in_a_junction():
    """Where no lane leads on ego leaves the road, and is in the junction yet, on another drive."""
    ego = vehicle(7, {k: (-50 + 2 * k, 0) for k in range(60)}, speed=10)
    found = replace(recording(LINK, [ego]), complete=frozenset({"YIELD", "PRIORITY"}))
    route = ("1", "2", "9", "10", "11")
    told = values_of(
        words_of(priority_signals)(context_of(found, route, until=24)), "unregulated_junction"
    )
    # Its front is 50 m before the first junction in state 0, its middle in it from state 20 on
    assert told[20:].tolist() == [True] * 4


@pytest.mark.parametrize("length", [4.5, 12.0, 18.0, 24.0])
def test_nobody_is_in_the_way_at_the_next_junction_who_was_at_the_last_one(length):
    """The rear of a long one is still on that way when its front is at the next line."""
    ego = vehicle(7, {k: (-50 + 2 * k, 0) for k in range(60)}, speed=10, length=length)
    # The other one's front is where the ways cross half a second after ego's rear has left it
    leaves_s = (58.6 + length / 2) / 10
    places = {k: (7, -3.6 + 10 * (k / 5 - leaves_s - 0.5)) for k in range(60)}
    other = vehicle(8, places, speed=10, heading=np.pi / 2)
    found = replace(recording(LINK, [ego, other], step_s=0.2), complete=frozenset({"YIELD"}))
    context = context_of(found, route=("1", "2", "9", "10", "11"))
    enters = np.flatnonzero(values_of(words_of(junction_signals)(context), "enters_junction"))
    conflict = values_of(words_of(priority_signals)(context), "conflict_from_right")
    assert conflict[enters].tolist() == [True, False]


@pytest.mark.parametrize("cuts_corner", [False, True])
def test_the_next_junction_ends_a_conflict_also_for_who_is_on_none_of_its_ways(cuts_corner):
    """Its middle passes beside the next one, as that of a long one does that cuts the corner."""
    ends = {"15": [(29, -4), (29, 2)], "16": [(29, 2), (29, 90)]}
    road = [
        replace(own, centre=np.array(ends[own.id], dtype=float)) if own.id in ends else own
        for own in LINK
    ]
    road = [
        lanelet(
            own.id,
            own.centre,
            successors=own.successors,
            predecessors=own.predecessors,
            signs=own.signs,
            types=own.types,
            junction=own.junction,
        )
        for own in road
    ]
    aside = 2.6 if cuts_corner else 0.0
    x = -50 + 2.0 * np.arange(60)
    y = np.interp(x, [14, 23, 35, 44], [0, aside, aside, 0])
    ego = vehicle(7, {k: (x[k], y[k]) for k in range(60)}, speed=10, length=18.0)
    leaves_s = (58.6 + 9) / 10
    places = {k: (7, -3.6 + 10 * (k / 5 - leaves_s - 0.5)) for k in range(60)}
    other = vehicle(8, places, speed=10, heading=np.pi / 2)
    found = replace(recording(road, [ego, other], step_s=0.2), complete=frozenset({"YIELD"}))
    context = context_of(found, route=("1", "2", "9", "10", "11"))
    row = [body.id for body in context.surroundings.tracks.participants].index("7")
    assert len(context.surroundings.passages.of_row[row]) == (1 if cuts_corner else 2)
    enters = np.flatnonzero(values_of(words_of(junction_signals)(context), "enters_junction"))
    conflict = values_of(words_of(priority_signals)(context), "conflict_from_right")
    assert conflict[enters].tolist() == [True, False]


def test_a_junction_is_not_the_next_one_after_itself():
    """Its area is wider than ego's way through it is long, by 2 m on both sides."""
    wide = [lanelet(own.id, own.centre, 12.0, types=own.types, junction="x") for own in NORTH[1:2]]
    wide = [replace(wide[0], predecessors=("4",), successors=("6",))]
    found = signals([NORTH[0], *wide, NORTH[2]], lambda t: -3 + 10 * (t - 3.0), np.pi / 2)
    # Its middle is in the area in state 3, at x = -5, and its front on the way, which begins at -4
    assert values_of(found, "conflict_from_right")[3]


@pytest.mark.parametrize("turns", [False, True])
def test_nobody_knows_of_one_before_another_junction_whether_it_turns_into_the_road(turns):
    """It comes along the link, 15 m long, when ego has driven in from the south."""
    bend = [(7, -10), (7, -4), (7.5, -1.5), (8.5, -0.3), (10, 0)]
    way = lanelet(8, bend, predecessors=(4,), successors=(9,), types=INSIDE, junction="x")
    west = [(-90.0, 0.0), (60.0, 0.0)]
    path = np.array([(7.0, -90.0), *bend, (60.0, 0.0)] if turns else west)
    # At 4 m/s ego's front is in the junction at 3 s, its rear out of the other's way at 5.25 s
    ego = vehicle(7, {k: (29, -18 + 0.8 * k) for k in range(60)}, speed=4, heading=np.pi / 2)
    to_link = float(np.hypot(*np.diff(path[: (6 if turns else 1)], axis=0).T).sum())
    # Its front is where the ways cross, at x = 28, 0.8 s after that; turning it is in the junction
    # before from 3.3 s on
    start = (to_link + 18 if turns else 118) - 2 - 10 * 6.05
    other = along(8, path, start + 2.0 * np.arange(60))
    signs = [
        replace(own, signs=frozenset({"YIELD"}) if own.id == "14" else frozenset()) for own in LINK
    ]
    found = replace(
        recording([*signs, way], [ego, other], step_s=0.2), complete=frozenset({"YIELD"})
    )
    told = words_of(priority_signals)(context_of(found, route=("14", "15", "16")))
    side = "conflict_from_left"
    assert (values_of(told, side).any(), unknown_in(told, side).any()) == (not turns, turns)


@pytest.mark.parametrize(("length", "sure"), [(4.5, True), (20.0, True), (60.0, False)])
@pytest.mark.parametrize(("comes_s", "conflict"), [(3.0, True), (6.0, False)])
def test_of_a_long_one_the_front_counts(length, sure, comes_s, conflict):
    """Its middle is in the junction long after its front, which is 0.75 m before y = 0 then.

    One state in it does not tell the way of a train.
    """
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    places = {k: (0, -0.75 - length / 2 + 10 * (k / 2 - comes_s)) for k in STEPS}
    other = vehicle(8, places, speed=10, heading=np.pi / 2, length=length)
    north = [lanelet(4, [(0, -150), (0, -4)], successors=(5,)), *NORTH[1:]]
    found = replace(recording([*EAST, *north], [ego, other]), complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert values_of(told, "conflict_from_right").any() == (conflict and sure)
    assert unknown_in(told, "conflict_from_right").any() == (conflict and not sure)


@pytest.mark.parametrize(("first_y", "told"), [(4.5, "F"), (1, "?"), (-2, "?"), (-9, "T")])
def test_who_is_in_a_junction_when_a_recording_begins(first_y, told):
    """Ego has its front in the other's way at first; that one is beyond, there too, or comes."""
    ego = vehicle(7, {k: (-2 + 5 * k, 0) for k in range(8)}, speed=10)
    other = vehicle(8, {k: (0, first_y + 5 * k) for k in range(8)}, speed=10, heading=np.pi / 2)
    found = replace(recording([*EAST, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    words = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    side = "conflict_from_right"
    assert (
        "?" if unknown_in(words, side).any() else "FT"[int(values_of(words, side).any())]
    ) == told


@pytest.mark.parametrize(("length", "times"), [(12.0, [(1, 3)]), (2.0, [(1, 1), (3, 3)])])
def test_a_long_one_whose_middle_cuts_a_corner_is_in_the_junction_once(length, times):
    """A cross of roads 4 m wide; its middle is out of it for one state, on a way of some 7 m."""
    places = [(-8, 0), (-2, 0), (2.6, 2.8), (3, 1), (8, 0), (12, 0)]
    body = vehicle(7, dict(enumerate(places)), "truck", length=length, speed=10)
    found = recording([*EAST, *NORTH], [body])
    passages = context_of(found, route=("1", "2", "3")).surroundings.passages
    assert [(x.first, x.last) for x in passages.of_row[0]] == times


@pytest.mark.parametrize(("length", "sure"), [(12.0, False), (4.0, True)])
def test_of_who_cuts_a_corner_by_less_than_half_its_length_nobody_knows_the_way(length, sure):
    """Its middle is in the junction for one state, on a way of 3 m from the one before."""
    places = [(-5.5, 2.5), (-3, 2), (-2.5, 2.5), (-2.5, 8), (-2.5, 14)]
    body = vehicle(7, dict(enumerate(places)), "truck", length=length, speed=5)
    found = recording([*EAST, *NORTH], [body])
    passages = context_of(found, route=("1", "2", "3")).surroundings.passages
    assert [x.sure for x in passages.of_row[0]] == [sure]


def test_a_conflict_is_one_of_a_single_junction():
    """Ego's front is in the first junction at 1.5 s, and 30 m on, at 4.5 s, in the second one."""
    road = [
        *EAST[:2],
        straight(3, 4, 26, predecessors=(2,), successors=(10,)),
        straight(10, 26, 34, predecessors=(3,), successors=(11,), types=INSIDE, junction="y"),
        straight(11, 34, 120, predecessors=(10,)),
        lanelet(14, [(30, -90), (30, -4)], successors=(15,)),
        lanelet(15, [(30, -4), (30, 4)], predecessors=(14,), types=INSIDE, junction="y"),
    ]
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    places = {k: (30, -3 + 10 * (k / 2 - 6)) for k in STEPS}
    other = vehicle(8, places, speed=10, heading=np.pi / 2)
    found = replace(recording([*road, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3", "10", "11")))
    from_right = values_of(signals, "conflict_from_right")
    assert not from_right[:4].any()
    assert from_right[9]


@pytest.mark.parametrize(("stops_at", "ends", "perhaps"), [(-7, 9, True), (-40, 9, False)])
def test_one_that_stops_for_ego_and_is_not_recorded_further_may_have_been_held_up(
    stops_at, ends, perhaps
):
    """At 2 s, as ego gets there, it is 10 m/s fast and 9 m before the place, or 42 m."""
    times, places = [0, 2, 3], [stops_at - 25, stops_at - 5, stops_at]
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    at = {k: (0, np.interp(k / 2, times, places)) for k in range(ends)}
    drives, stands = (vehicle(8, at, speed=mps, heading=np.pi / 2) for mps in (10, 0))
    states = {k: (drives if k < 5 else stands).states[k] for k in at}
    other = replace(drives, states=states)
    found = replace(recording([*EAST, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert not values_of(told, "conflict_from_right").any()
    assert unknown_in(told, "conflict_from_right").any() == perhaps


@pytest.mark.parametrize(("aside_m", "x", "perhaps"), [(0, 70, False), (4, 70, True), (4, 0, True)])
def test_nobody_knows_whose_way_crosses_that_of_ego_on_no_way(aside_m, x, perhaps):
    """Its junction is 12 m wide, and ego drives that far beside the middle of its only way."""
    road = [replace(one, **straight_sides(one, 6.0)) for one in EAST]
    ego = vehicle(7, {k: (-20 + 5 * k, -aside_m) for k in STEPS}, speed=10)
    other = vehicle(8, dict.fromkeys(STEPS, (x, 30)), speed=0)
    found = replace(recording([*road, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert unknown_in(told, "conflict_from_right").any() == (perhaps and x == 0)
    assert unknown_in(told, "unregulated_junction").any() == perhaps


def straight_sides(one, half_m):
    return {
        name: np.add(one.centre, (0, way * half_m)) for name, way in (("left", 1), ("right", -1))
    }


@pytest.mark.parametrize(("creeps_mps", "known"), [(0.0, False), (2.0, True)])
def test_one_that_stands_when_ego_drives_in_may_wait_for_others(creeps_mps, known):
    """It moves off when ego leaves the junction at 2.5 s, and comes less than a second later."""
    places = [-6 - 2.5 * creeps_mps, -6, -4, 2]
    found = signals(NORTH, lambda t: np.interp(t, [0, 2.5, 3, 3.5], places), np.pi / 2)
    told = (
        values_of(found, "conflict_from_right").any(),
        unknown_in(found, "conflict_from_right").any(),
    )
    assert told == (known, not known)


def test_one_that_would_have_come_at_once_was_held_up():
    """It comes 2 s after ego has left, for it brakes from 10 m/s 9 m before."""
    found = signals(NORTH, lambda t: np.interp(t, [0, 2, 4, 4.5], [-32, -12, -7, -3]), np.pi / 2)
    assert values_of(found, "conflict_from_right")[3]


@pytest.mark.parametrize(("brakes_s", "perhaps"), [(2, True), (3, False)])
def test_one_that_stops_for_ego_and_waits_longer_may_have_been_held_up(brakes_s, perhaps):
    """It comes 4.5 s after ego has left, for it stops from 10 m/s within 5 m.

    At 2 s, as ego gets there, it is 9 m before the place; or it has 5 m left when ego is gone.
    """
    times, gone = [0, brakes_s, brakes_s + 1, 6.5, 7], -12 if perhaps else -8
    places = [gone - 10 * brakes_s, gone, -7 if perhaps else -3.5, -7 if perhaps else -3.5, -3]
    found = signals(NORTH, lambda t: np.interp(t, times, places), np.pi / 2)
    assert not values_of(found, "conflict_from_right").any()
    assert unknown_in(found, "conflict_from_right").any() == perhaps


@pytest.mark.parametrize(
    ("way", "conflict"),
    [(3.0, "?"), (4.25, "F"), (5.0, "F")],
    ids=["brakes gently", "hardly", "when ego is gone"],
)
def test_one_that_does_not_slow_down_for_ego_was_not_held_up(way, conflict):
    """Ego is there from 2 s on and gone 1 s before 3.4 s; the other one comes at 3.5 s.

    At 2 s it is 13.5 m away, and at 10 m/s up to 2.5 s. Then it covers a way in half a second.
    """
    places = np.array([-36.5, -11.5, -11.5 + way, -3])
    found = signals(NORTH, lambda t: np.interp(t, [0, 2.5, 3, 3.5], places), np.pi / 2)
    assert not values_of(found, "conflict_from_right").any()
    assert unknown_in(found, "conflict_from_right").any() == (conflict == "?")


def turning_into_ego_s_road(driven):
    """The signals where one from the right turns into ego's road by a bend of 12 m.

    ``driven``: its way (m) by state. Ego goes on at 10 m/s and is past the bend's end at 3.2 s.
    """
    turns = np.linspace(0, np.pi / 2, 19)
    bend = 12 * np.stack([1 - np.cos(turns), np.sin(turns) - 1], axis=1)
    road = [
        straight(1, -60, -12, successors=(2,)),
        straight(2, -12, 12, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
        straight(3, 12, 120, predecessors=(2, 5)),
        lanelet(4, [(0, -90), (0, -12)], successors=(5,)),
        lanelet(5, bend, predecessors=(4,), successors=(3,), types=INSIDE, junction="x"),
    ]
    other = along(8, np.array([(0.0, -90.0), *bend, (120.0, 0.0)]), driven)
    ego = vehicle(7, {k: (-15 + 5 * k, 0) for k in STEPS}, speed=10)
    found = replace(recording(road, [ego, other]), complete=frozenset({"YIELD"}))
    return words_of(priority_signals)(context_of(found, route=("1", "2", "3")))


@pytest.mark.parametrize(
    "speeds", [[10] * 4 + [6] * 12, [10, 10, 10, 6, 2, 0, 0, 0, 4, 8] + [10] * 6]
)
def test_who_slows_down_before_its_bend_may_do_so_for_that(speeds):
    """From the right it turns into ego's road by a bend of 12 m: at 6 m/s with 3 m/s² across.

    Ego is past the bend's end when the other one, did it keep its 10 m/s, would come there less
    than a second later; it comes more than a second later. Or it stops, by 8 m/s², and is 2 s late.
    """
    begin = 55.0 if min(speeds) else 60.0
    signals = turning_into_ego_s_road(begin + 0.5 * np.cumsum([0.0, *speeds[:-1]]))
    side = "conflict_from_right"
    assert not values_of(signals, side).any()
    assert unknown_in(signals, side).any()


@pytest.mark.parametrize(("at_1_s", "conflict"), [(-30, False), (-26, True)])
def test_one_that_speeds_up_when_ego_has_entered_was_not_held_up(at_1_s, conflict):
    """Ego drives in at 1 s and is past its way at 2.5 s; the other one comes 1.5 s later.

    At 2 s it is 12 m away, 0.9 s at 14 m/s. At 1 s it was 27 m away, or 23, and at 10 m/s.
    """
    long = [
        straight(1, -60, -14, successors=(2,)),
        straight(2, -14, 4, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
        EAST[2],
    ]
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    times, places = [0, 1.5, 2, 2.5, 3.8], [at_1_s - 10, at_1_s + 5, -15, -11, -3]
    ways = np.interp(np.arange(16) / 2, times, places)
    other = vehicle(8, {k: (0, ways[k]) for k in STEPS}, speed=10, heading=np.pi / 2)
    found = replace(recording([*long, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert values_of(signals, "conflict_from_right").any() == conflict


@pytest.mark.parametrize(
    ("front", "conflict"), [(-1.3, False), (-0.82, False), (-0.78, True), (-0.2, True)]
)
def test_who_stops_too_far_ahead_lets_one_pass_unless_it_runs_into_it(front, conflict):
    """Their ways meet from 1.6 m before the other's middle on; its body begins 1 m before that.

    Corners may be cut by 0.15 m, and places be off by 0.05 m.
    """
    ego = vehicle(7, {k: (min(-22 + 5 * k, front - 2), 0) for k in STEPS}, speed=0)
    places = {k: (0, -3 + 10 * (k / 2 - 3)) for k in STEPS}
    other = vehicle(8, places, speed=10, heading=np.pi / 2)
    found = replace(recording([*EAST, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert values_of(signals, "conflict_from_right").any() == conflict


@pytest.mark.parametrize(
    ("signs", "first", "expected"),
    [
        (("STOP", "STOP"), frozenset(), "no"),
        (("YIELD", "STOP"), frozenset({"4", "5", "6"}), "yes"),
        (("STOP", "YIELD"), None, "unknown"),
        (("STOP", None), None, "yes"),
        ((None, None), frozenset(), "yes"),
        # Where all have to stop it is who has come first that counts
        (("STOP_4_WAY", "STOP_4_WAY"), frozenset(), "yes"),
    ],
)
def test_a_sign_does_not_let_go_first_whom_a_sign_stops_too(signs, first, expected):
    """Both are on minor roads of one junction; ``first``: the ways that the map lets go first."""
    own, its = (frozenset({sign} - {None}) for sign in signs)
    east = [replace(EAST[0], signs=own), replace(EAST[1], first=first), EAST[2]]
    road = [replace(NORTH[0], signs=its), *NORTH[1:]]
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    places = {k: (0, -3 + 10 * (k / 2 - 2.5)) for k in STEPS}
    other = vehicle(8, places, speed=10, heading=np.pi / 2)
    found = replace(recording([*east, *road], [ego, other]), complete=frozenset({"YIELD"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    side = "conflict_from_right"
    assert values_of(signals, side).any() == (expected == "yes")
    assert unknown_in(signals, side).any() == (expected == "unknown")


def test_signs_order_a_junction_where_the_map_has_them():
    steady = lambda t: -50.0 + t  # noqa: E731
    free = signals(NORTH, steady, np.pi / 2)
    assert values_of(free, "unregulated_junction")[3]
    assert not unknown_in(free, "unregulated_junction")[3]
    bare = signals(NORTH, steady, np.pi / 2, complete=())
    assert unknown_in(bare, "unregulated_junction")[3]


def test_a_road_has_priority_until_all_of_ego_is_out_of_the_junction():
    """Its middle is out of it in state 5, at x = 5, its rear 1 m before its end."""
    east = [replace(EAST[0], signs=frozenset({"PRIORITY"})), *EAST[1:]]
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    found = recording([*east, *NORTH], [ego])
    found = replace(found, complete=frozenset({"YIELD", "PRIORITY"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    assert values_of(told, "on_priority_road").tolist() == [True] * 6 + [False] * 10


@pytest.mark.parametrize("path", NETS, ids=lambda path: path.name.split(".")[0])
def test_ways_that_meet_are_the_foes_of_the_net(path):
    """Geometry alone says what SUMO's `request` bits say, way by way."""
    told = net_lanelets(read_net(path), 0.5)
    bare = {name: replace(x, foes=None) for name, x in told.items()}
    junctions = junctions_of(Recording("drawn", 0.5, bare, (), ()))
    for junction in junctions:
        for own, way in enumerate(junction.ways):
            foes = told[way.lanelets[0].id].foes
            for other, its in enumerate(junction.ways):
                if own != other and foes is not None:
                    assert (junction.meeting(own, other) is not None) == bool(foes & its.names)


@pytest.mark.parametrize("path", NETS, ids=lambda path: path.name.split(".")[0])
def test_who_yields_to_one_from_the_side_is_what_the_net_says(path):
    """Signs, and sides where there are none, say what SUMO's `request` bits say, way by way."""
    told = net_lanelets(read_net(path), 0.5)
    drawn = Recording("drawn", 0.5, told, (), ())
    pairs = 0
    for junction in junctions_of(drawn):
        for own, way in enumerate(junction.ways):
            first, signed = told[way.lanelets[0].id].first, _gives_way(drawn, way)
            for other, its in enumerate(junction.ways):
                side_deg = np.degrees(turn(way.headings[0], its.headings[0]))
                crosses = 30 <= abs(side_deg) <= 135 and junction.meeting(own, other)
                # Lights say who goes first where there are some
                if first is None or not crosses or _is_lit(drawn, way):
                    continue
                without_sign = not signed and not _gives_way(drawn, its)
                assert (junction.regulated is False) == without_sign
                yields = side_deg > 0 if without_sign else signed
                assert bool(first & its.names) == yields
                pairs += 1
    assert pairs or path.name.startswith(("grid", "motorway", "spider", "zebra"))


def _gives_way(drawn, way):
    return any(entry.signs & {"YIELD", "STOP"} for entry in way.approaches)


def _is_lit(drawn, way):
    return any(entry.lights for entry in way.approaches)


@pytest.mark.parametrize(
    ("y", "first"), [(lambda t: -4.4 + 1.2 * t, True), (lambda t: -3 + 10 * (t - 2.5), False)]
)
def test_who_arrives_more_than_a_second_before_ego_arrives_first(y, first):
    # Ego is in the junction from 2 s on; who creeps from 0.5 s on, and ego runs into it
    found = signals(NORTH, y, np.pi / 2)
    assert values_of(found, "conflict_from_right").any()
    assert bool(values_of(found, "other_arrived_first").any()) == first
    assert bool(values_of(found, "arrived_together").any()) != first


@pytest.mark.parametrize(
    ("away_m", "known"),
    # At 10 m/s in 3.2 s, as if ego blocked its way; or in 8.2 s, when ego had time enough
    [(32.0, True), (82.0, False)],
)
def test_who_comes_up_while_ego_is_held_up_in_the_junction_may_have_been_far(away_m, known):
    """Ego drives in at 2 s, creeps there until 9 s, and is gone at 10 s; the other is held up."""
    times = np.arange(0, 16, 0.5)
    ahead = np.where(times < 2, -20 + 10 * times, np.where(times < 9, 0.2 * (times - 2), np.nan))
    ahead = np.where(times < 9, ahead, 1.4 + 8 * (times - 9))
    speeds = np.gradient(ahead, 0.5)
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate(ahead)})
    ego = replace(
        ego,
        states={k: replace(state, speed=speeds[k]) for k, state in ego.states.items()},
    )
    # As fast as before, as far as ego leaves it room: it is at the ways' meeting place at 10.4 s
    start = -4 - away_m - 20
    way = np.minimum(start + 10 * times, np.where(times < 10, -8.0, -8 + 10 * (times - 10)))
    moved = np.gradient(way, 0.5)
    other = vehicle(8, {k: (0, y) for k, y in enumerate(way)}, heading=np.pi / 2)
    other = replace(
        other,
        states={k: replace(state, speed=moved[k]) for k, state in other.states.items()},
    )
    found = replace(recording([*EAST, *NORTH], [ego, other]), complete=frozenset({"YIELD"}))
    told = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    side = "conflict_from_right"
    assert values_of(told, side).any() or unknown_in(told, side).any()
    assert bool((values_of(told, side) & ~unknown_in(told, side)).any()) == known


def with_a_tram(road, comes_s, way=EAST, heading=np.pi / 2, x=0.0):
    """``signals`` with a tram of 30 m, whose front is in ego's way ``comes_s`` after the start."""
    ego = vehicle(7, {k: (-20 + 5 * k, 0) for k in STEPS}, speed=10)
    sign = 1 if heading > 0 else -1
    places = {k: (x, sign * (-2 - 15 + 10 * (k / 2 - comes_s))) for k in STEPS}
    tram = vehicle(8, places, "train", length=30.0, speed=10, heading=heading)
    found = replace(recording([*way, *road], [ego, tram]), complete=frozenset({"YIELD"}))
    return words_of(priority_signals)(context_of(found, route=("1", "2", "3")))


def on_tracks(road, *types):
    return [replace(x, types=x.types | frozenset(types)) for x in road]


@pytest.mark.parametrize("types", [(), ("busLane",), ("rail", "restricted_area")])
@pytest.mark.parametrize(("road", "heading"), [(NORTH, np.pi / 2), (SOUTH, -np.pi / 2)])
@pytest.mark.parametrize(("comes_s", "conflict"), [(2.5, True), (2.9, True), (6.5, False)])
def test_trams_on_lanes_that_others_share(types, road, heading, comes_s, conflict):
    found = with_a_tram(on_tracks(road, *types), comes_s, heading=heading)
    assert values_of(found, "conflict_with_rail")[3] == conflict
    assert not unknown_in(found, "conflict_with_rail").any()


@pytest.mark.parametrize(
    ("road", "heading", "side", "other"),
    [(NORTH, np.pi / 2, "right", "left"), (SOUTH, -np.pi / 2, "left", "right")],
)
@pytest.mark.parametrize(("comes_s", "conflict"), [(2.5, True), (2.9, True), (6.5, False)])
def test_a_tram_comes_from_a_side_and_whether_it_has_the_order_of_all_is_open(
    road, heading, side, other, comes_s, conflict
):
    found = with_a_tram(on_tracks(road, "rail"), comes_s, heading=heading)
    assert values_of(found, "conflict_with_rail_from_side")[3] == conflict
    assert not unknown_in(found, "conflict_with_rail_from_side").any()
    assert unknown_in(found, f"conflict_from_{side}")[3] == conflict
    assert not unknown_in(found, f"conflict_from_{other}").any()
    assert not any(values_of(found, f"conflict_from_{x}").any() for x in (side, other))


def test_a_tram_from_a_side_is_in_conflict_in_few_words_at_a_level_crossing():
    over = [replace(x, types=x.types | {"level_crossing"}) if x.id == "2" else x for x in EAST]
    found = with_a_tram(on_tracks(NORTH, "rail"), 2.5, way=over)
    assert values_of(found, "conflict_with_rail")[3]
    assert not values_of(found, "conflict_with_rail_from_side").any()
    assert not values_of(found, "conflict_from_right").any()
    assert not unknown_in(found, "conflict_from_right").any()


@pytest.mark.parametrize(("x", "unknown"), [(0.0, True), (30.0, False)])
def test_a_tram_in_the_junction_on_no_way_of_it_may_be_in_conflict(x, unknown):
    """The map has no way across; 30 m farther on the tram is not in the junction."""
    found = with_a_tram([], 2.5, x=x)
    for word in ("conflict_with_rail", "conflict_with_rail_from_side"):
        assert not values_of(found, word).any()
        assert unknown_in(found, word)[3] == unknown


@pytest.mark.parametrize("step_s", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("train_mps", [9.0, 21.0, 34.0])
@pytest.mark.parametrize(("comes_s", "conflict"), [(1.3, True), (2.2, True), (9.0, False)])
def test_trains_at_a_level_crossing(step_s, train_mps, comes_s, conflict):
    """It comes ``comes_s`` after ego's front; its middle may be on the road in no state."""
    rails = frozenset({"level_crossing"})
    lanes = [
        straight(1, -200, -4, successors=(2,)),
        straight(2, -4, 4, predecessors=(1,), successors=(3,), types=rails, junction="x"),
        straight(3, 4, 200, predecessors=(2,)),
        lanelet(4, [(0, -400), (0, -2)], successors=(5,)),
        lanelet(5, [(0, -2), (0, 2)], predecessors=(4,), successors=(6,), junction="x"),
        lanelet(6, [(0, 2), (0, 400)], predecessors=(5,)),
    ]
    lanes = lanes[:3] + on_tracks(lanes[3:5], "rail", "level_crossing") + lanes[5:]
    times = np.arange(0, 20, step_s)
    ego = vehicle(7, {k: (-6 + 8 * (t - 8), 0) for k, t in enumerate(times)}, speed=8)
    places = {k: (0, -42 + train_mps * (t - 8 - comes_s)) for k, t in enumerate(times)}
    train = vehicle(8, places, "train", length=80.0, speed=train_mps, heading=np.pi / 2)
    found = replace(recording(lanes, [ego, train], step_s=step_s), complete=frozenset({"rail"}))
    signals = words_of(priority_signals)(context_of(found, route=("1", "2", "3")))
    entered = round(8 / step_s)
    assert values_of(signals, "conflict_with_rail")[entered] == conflict
    assert not unknown_in(signals, "conflict_with_rail")[: entered + 1].any()

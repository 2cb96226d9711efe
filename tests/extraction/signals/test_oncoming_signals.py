"""Ego turns across the way of one that comes towards it, which signs and lights may stop.

Ego comes from the west in the lane y = -2 and turns left into the road to the north at x = 2; the
other one comes from the east in the lane y = 2. Ego is on that lane some 4 to 14 m along its turn.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rulec.extraction.signals.map import priority_signals
from rulec.extraction.signals.map.right_of_way.oncoming_priority import goes_first
from rulec.extraction.tracks.at_junctions.junctions import junctions_of
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import Light, Recording
from rulec.recordings.sumo.lanelets import net_lanelets
from rulec.recordings.sumo.net import read_net
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

NETS = sorted((Path(__file__).parents[2] / "worlds/stored").glob("*.net.xml"))
INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
STEP_S = 0.25


def arc(x, y, radius, first, last):
    angles = np.radians(np.linspace(first, last, 19))
    return np.stack((x + radius * np.cos(angles), y + radius * np.sin(angles)), axis=1)


FAR_TURN = arc(-8, 8, 10, -90, 0)
NEAR_TURN = arc(8, 8, 6, 270, 180)
ITS_FAR_TURN = arc(8, -8, 10, 90, 180)


def crossroads(entry=None, its_entry=None):
    """Lanelets of ego's turn (1, 2, 3), and of who comes towards it (4, 5, 6; turns 7, 8)."""
    return [
        straight(1, -90, -8, -2, successors=(2, 9), **(entry or {})),
        lanelet(2, FAR_TURN, predecessors=(1,), successors=(3,), **INSIDE),
        lanelet(3, [(2, 8), (2, 90)], predecessors=(2, 7)),
        lanelet(4, [(90, 2), (8, 2)], successors=(5, 7, 8), **(its_entry or {})),
        lanelet(5, [(8, 2), (-8, 2)], predecessors=(4,), successors=(6,), **INSIDE),
        lanelet(6, [(-8, 2), (-90, 2)], predecessors=(5,)),
        lanelet(7, NEAR_TURN, predecessors=(4,), successors=(3,), **INSIDE),
        lanelet(8, ITS_FAR_TURN, predecessors=(4,), successors=(10,), **INSIDE),
        straight(9, -8, 8, -2, predecessors=(1,), successors=(11,), **INSIDE),
        lanelet(10, [(-2, -8), (-2, -90)], predecessors=(8,)),
        straight(11, 8, 90, -2, predecessors=(9,)),
    ]


TIMES = np.arange(0, 14, STEP_S)
TURN = np.concatenate(([(-60.0, -2.0)], FAR_TURN, [(2.0, 90.0)]))
STRAIGHT_ON = np.array([(-60.0, -2.0), (90.0, -2.0)])
# At 5 m/s the middle is where the turn begins, 52 m along, at 4 s
EGO = 32 + 5 * TIMES


def its(way):
    """The other's ways: to the west, to the north and to the south."""
    turn = {"on": [(-90.0, 2.0)], "near": [*NEAR_TURN, (2, 90)], "far": [*ITS_FAR_TURN, (-2, -90)]}
    return np.concatenate(([(90.0, 2.0)], [(8.0, 2.0)], turn[way]))


def at(reaches_s, mps=10.0):
    """The middle of one that is where the junction begins, 82 m along, at a time."""
    return 82 + mps * (TIMES - reaches_s)


def told(way, road=None, ego=EGO, turn="on", line=TURN, kind="car", route=("1", "2", "3")):
    found = recording(road or crossroads(), [along(7, line, ego), along(8, its(turn), way, kind)])
    found = replace(found, step_s=STEP_S)
    right = words_of(priority_signals)(context_of(found, route))
    left = words_of(priority_signals)(context_of(mirrored_recording(found), route, "left"))
    word = "in_way_of_oncoming"
    assert values_of(right, word).tolist() == values_of(left, word).tolist()
    assert unknown_in(right, word).tolist() == unknown_in(left, word).tolist()
    return values_of(right, word), unknown_in(right, word)


def test_ego_turns_at_once_before_one_that_comes():
    conflict, unknown = told(at(5.5))
    # Ego's front is on the other's lane from about 4.6 s on, its rear until about 7.2 s
    times = TIMES[conflict]
    assert 4.0 < times[0] < 5.0
    assert 6.5 < times[-1] < 7.75
    assert not unknown.any()


def test_a_recording_that_ends_while_both_are_there_tells_that_ego_did_not_wait():
    # Ego is there from 4.6 s on, the other one from about 5.8 s on
    conflict, unknown = told(at(5.5)[:28], ego=EGO[:28])
    assert conflict.any()
    assert not unknown.any()
    # Ego may still stop for one that is about to come, or stands there
    conflict, unknown = told(at(5.5)[:24], ego=EGO[:24])
    assert not conflict.any()
    assert unknown.any()
    # Its nose is at the edge of the other's way
    stands = np.minimum(EGO, 57.0)
    conflict, unknown = told(at(5.5)[:28], ego=stands[:28])
    assert not conflict.any()
    assert unknown.any()


@pytest.mark.parametrize(("comes_s", "known"), [(8.0, True), (18.0, False)])
def test_ego_that_has_to_stand_may_not_have_seen_who_comes_much_later(comes_s, known):
    """It stands across the other's lane from 6 s on, until 2 s before that one comes."""
    times = np.arange(0, 30, STEP_S)
    stood = np.clip(times - 6, 0, comes_s - 6)
    ego = 32 + 5 * (times - stood)
    conflict, unknown = told(82 + 10 * (times - comes_s), ego=ego)
    assert conflict.any() == known
    assert unknown.any() == (not known)


@pytest.mark.parametrize(("reaches_s", "waits"), [(4.5, True), (5.5, False)])
def test_where_all_have_to_stop_ego_does_not_wait_for_who_comes_later(reaches_s, waits):
    """Ego gets into the junction at 3.6 s, the other one 0.7 s or 1.7 s later."""
    stop = {"signs": frozenset({"STOP_4_WAY"})}
    conflict, unknown = told(at(reaches_s), crossroads(stop, stop))
    assert conflict.any() == waits
    assert not unknown.any()
    assert told(at(reaches_s))[0].any()


def stopping(at_s):
    """The middle of one that stands for a second from a time on, its front a metre before."""
    since = TIMES - at_s
    return 79 + np.where(since < 0, 10 * since, 1.5 * np.maximum(since - 1, 0) ** 2)


@pytest.mark.parametrize(
    ("signs", "known"), [(frozenset(), False), (frozenset({"STOP"}), True)], ids=["none", "some"]
)
def test_a_map_without_any_stop_sign_does_not_show_who_has_to_stop(signs, known):
    """It enters 2.8 s after ego, and may have stopped as all have to; signs are elsewhere."""
    road = [*crossroads(), straight(12, 300, 400, signs=signs)]
    conflict, unknown = told(stopping(4.0), road)
    assert conflict.any() == known
    assert unknown.any() == (not known)
    # Where there are lights they are not all told to stop
    light = {"lights": (Light(0, (("green", 10),)),)}
    assert told(stopping(4.0), crossroads(its_entry=light))[0].any()
    # Who does not stop has no sign
    assert told(at(5.5), road)[0].any()


@pytest.mark.parametrize("reaches_s", [2.0, 9.5], ids=["ego lets it pass", "it is far away"])
def test_ego_turns_behind_or_long_before_one(reaches_s):
    conflict, unknown = told(at(reaches_s))
    assert not conflict.any()
    assert not unknown.any()


@pytest.mark.parametrize(
    ("reaches_s", "mps", "conflict"),
    [
        # It is on ego's way from about 3.7 to 5.3 s, and ego on its way from 4.6 s on: 0.6 m behind
        (3.5, 10.0, ""),
        # 0.47 m behind
        (3.7, 10.0, "open"),
        # From 5.0 s on ego's front is in its rear
        (4.1, 10.0, "sure"),
        # It is there all the time and slow, as one that may wait; but ego runs into it
        (2.0, 2.0, "sure"),
    ],
)
def test_ego_drives_into_the_side_of_one_that_was_there_first_or_behind_it(
    reaches_s, mps, conflict
):
    found, unknown = told(at(reaches_s, mps))
    assert (found.any(), unknown.any()) == (conflict == "sure", conflict == "open")


@pytest.mark.parametrize(("place_m", "conflict"), [(56.5, False), (57.5, True)])
def test_who_brakes_may_stop_short_of_one_that_was_there_first(place_m, conflict):
    """It brakes from 4.5 s on for a second, and stays 0.7 or 0.51 m behind it."""
    ego = np.interp(TIMES, [0, 4.5, 5.5, 14], [32, 54.5, place_m, 99])
    found, unknown = told(at(3.9), ego=ego)
    assert (found.any(), unknown.any()) == (False, conflict)


@pytest.mark.parametrize(("place_m", "meet"), [(88, True), (93, False)])
def test_where_ways_join_who_drives_in_behind_one_may_run_into_it(place_m, meet):
    """It turns into the same road, and is so far along 6 s on: then ego is in its rear, or not."""
    way = np.interp(TIMES, [0, 3.5, 6, 14], [52, 82, place_m, place_m + 37])
    found, unknown = told(way, turn="near")
    assert (found.any(), unknown.any()) == (False, meet)


def test_who_rolls_on_in_front_of_one_does_not_let_it_pass():
    # It comes at about 5.0 s and has passed at 6.6 s, while ego is on its way from 4.6 to 7.2 s
    conflict, _ = told(at(4.8))
    assert conflict.any()
    # Ego stops a little too far ahead
    waits, _ = told(at(4.8), ego=np.interp(TIMES, [0, 4.8, 7, 14], [32, 56, 56, 91]))
    assert not waits.any()


def test_one_that_has_to_brake_is_in_conflict():
    # At 5 s it is half a second away, and gets there at 9 s, less than 3 s after ego
    conflict, _ = told(np.interp(TIMES, [0, 5, 9, 13], [27, 77, 82, 120]))
    assert conflict.any()


@pytest.mark.parametrize(
    ("speeds", "perhaps"),
    [
        ([(4.3, 0.0), (5.55, 2.5), (6.55, 0.0), (9.0, 0.0), (11.0, 7.0)], True),
        # It lets ego go, and sets off behind it
        ([(7.0, 0.0), (9.0, 5.0)], False),
    ],
)
def test_who_sets_off_at_green_and_brakes_for_one_that_turns_may_be_held_up(speeds, perhaps):
    """Ego sets off at 4 s, a metre before the junction, and has left the other's lane by 7.7 s."""
    ego, way = (
        begin
        + np.concatenate(([0.0], np.cumsum(np.interp(TIMES, *zip(*mps, strict=True)))[:-1]))
        * STEP_S
        for begin, mps in ((49.0, [(4.0, 0.0), (6.5, 7.0)]), (79.0, speeds))
    )
    conflict, unknown = told(way, ego=ego)
    assert not conflict.any()
    assert unknown.any() == perhaps


def test_who_goes_straight_on_goes_first():
    conflict, unknown = told(at(5.5), line=STRAIGHT_ON, turn="far", ego=EGO, route=("1", "9", "11"))
    assert not (conflict | unknown).any()


@pytest.mark.parametrize(("turn", "conflict"), [("near", True), ("far", False)])
def test_one_that_turns_itself(turn, conflict):
    """Who turns to the near side goes first, too; two who turn to the far side pass each other."""
    assert told(at(7.0, 5.0), turn=turn)[0].any() == conflict


def test_who_waits_in_the_junction_lets_it_pass():
    waits = np.interp(TIMES, [0, 4.5, 8, 10, 13.75], [32, 55.5, 55.5, 65, 90])
    assert not told(at(5.5), ego=waits)[0].any()


@pytest.mark.parametrize(("stops_m", "conflict"), [(57.0, "none"), (57.1, "open"), (57.3, "sure")])
def test_boxes_that_graze_do_not_tell_that_one_ran_into_who_waits(stops_m, conflict):
    """At 57 m, 5 m into the turn, a corner of its box is at the edge of the other one's way."""
    waits = np.interp(TIMES, [0, 4.5, 8, 10, 13.75], [32, stops_m, stops_m, 65, 90])
    found, unknown = told(at(5.5), ego=waits)
    assert (found.any(), unknown.any()) == (conflict == "sure", conflict == "open")


@pytest.mark.parametrize(("place_m", "conflict"), [(54.0, False), (55.0, True)])
def test_who_creeps_on_behind_one_that_does_not_brake_lets_it_pass(place_m, conflict):
    """At 1.1 m/s from so far along on, for 3 s: from 55 m on it would touch the other one."""
    places = [32, place_m, place_m + 3.4, place_m + 8, 95]
    found, unknown = told(at(5.5), ego=np.interp(TIMES, [0, 4.5, 7.5, 9, 13.75], places))
    assert (found.any(), unknown.any()) == (conflict, False)


def test_who_creeps_behind_one_that_is_all_but_past_does_not_hinder_it():
    """The bodies stay 0.9 m apart."""
    creeps = np.interp(TIMES, [0, 4.5, 7.5, 9, 13.75], [32, 53, 56.4, 61, 95])
    found, unknown = told(at(5.2), ego=creeps)
    assert not found.any()
    assert not unknown.any()


def test_one_that_has_to_give_way_by_its_sign():
    sign = {"signs": frozenset({"YIELD"})}
    assert not told(at(5.5), crossroads(its_entry=sign))[0].any()
    assert told(at(5.5), crossroads(entry=sign, its_entry=sign))[0].any()
    assert told(at(5.5), crossroads(entry=sign))[0].any()


def test_one_that_came_past_a_red_light():
    def light(changes_s):
        steps = round(changes_s / STEP_S)
        return {"lights": (Light(0, (("green", steps), ("red", 400))),)}

    assert not told(at(5.5), crossroads(its_entry=light(2.0)))[0].any()
    # It was green at the line, and red half a second later
    assert told(at(5.5), crossroads(its_entry=light(5.0)))[0].any()
    # Where the line is known to be at the junction, its front crossed it at about 5.3 s
    line = {"stop_line": np.array([(8.0, 0.0), (8.0, 4.0)])}
    assert told(at(5.5), crossroads(its_entry=light(4.0)))[0].any()
    assert not told(at(5.5), crossroads(its_entry=light(4.0) | line))[0].any()
    assert told(at(5.5), crossroads(its_entry=light(6.0) | line))[0].any()


def test_nobody_comes_on_foot():
    assert not told(at(5.5, 10.0), kind="pedestrian")[0].any()


@pytest.mark.parametrize(
    ("reaches_s", "unknown"), [(7.5, True), (20.0, False)], ids=["soon", "far away"]
)
def test_a_recording_that_ends_before_it_is_clear(reaches_s, unknown):
    """It ends at 6 s, when ego is on the other's lane until about 7.2 s."""
    road = crossroads()
    found = recording(road, [along(7, TURN, EGO[:24]), along(8, its("on"), at(reaches_s)[:24])])
    signals = words_of(priority_signals)(context_of(replace(found, step_s=STEP_S), ("1", "2", "3")))
    assert not values_of(signals, "in_way_of_oncoming").any()
    assert unknown_in(signals, "in_way_of_oncoming").any() == unknown


def test_one_that_is_lost_from_sight_may_have_come():
    # At 3 s, 25 m before the junction; in a simulation it has arrived where it was going
    found = recording(crossroads(), [along(7, TURN, EGO), along(8, its("on"), at(5.5)[:12])])
    found = replace(found, step_s=STEP_S)
    for complete, unknown in ((frozenset(), True), (frozenset({"arrivals"}), False)):
        lost = replace(found, complete=complete)
        signals = words_of(priority_signals)(context_of(lost, ("1", "2", "3")))
        assert not values_of(signals, "in_way_of_oncoming").any()
        assert unknown_in(signals, "in_way_of_oncoming").any() == unknown


@pytest.mark.parametrize("path", NETS, ids=lambda path: path.name.split(".")[0])
def test_who_goes_first_is_what_the_net_says(path):
    """Signs alone say what SUMO's `request` bits say of ways that turn across others."""
    net = read_net(path)
    told = net_lanelets(net, 0.5)
    bare = {name: replace(x, foes=None, first=None) for name, x in told.items()}
    drawn = Recording("drawn", 0.5, bare, (), ())
    far = 1 if net.side == "right" else -1
    pairs = 0
    for junction in junctions_of(drawn):
        for own, way in enumerate(junction.ways):
            first = told[way.lanelets[0].id].first
            for other, its_way in enumerate(junction.ways):
                towards = abs(
                    (way.headings[0] - its_way.headings[0] + np.pi) % (2 * np.pi) - np.pi
                ) > np.radians(135)
                across = way.turned * far > np.radians(45) >= its_way.turned * far
                if first is not None and towards and across and junction.meeting(own, other):
                    assert goes_first(way, its_way) == bool(first & its_way.names)
                    pairs += 1
    assert pairs or path.name.startswith(("motorway", "roundabout", "zebra"))

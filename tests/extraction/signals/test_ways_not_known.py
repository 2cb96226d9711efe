"""Where ego goes at a junction is not known if its drive ends before that shows.

Ego comes along y = 0 to a junction from x = 100 to 120, from where ways lead on, left and right.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import junction_signals, line_signals
from rulec.extraction.signals.relations import ahead_in_lane, measured_ahead
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

at_junctions = words_of(junction_signals, line_signals)

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}


def arc(x, y, radius, first, last):
    angles = np.radians(np.linspace(first, last, 19))
    return np.stack((x + radius * np.cos(angles), y + radius * np.sin(angles)), axis=1)


def road(turns=True, leaves=False):
    ways = (2, 3, 4) if turns else (2,)
    ramp = {"types": frozenset({"exitRamp"})} if leaves else {}
    lanes = [
        straight(1, -200, 100, successors=ways),
        straight(2, 100, 120, predecessors=(1,), successors=(5,), **INSIDE),
        straight(5, 120, 300, predecessors=(2,), **ramp),
    ]
    if turns:
        lanes += [
            lanelet(3, arc(100, 14, 14, -90, 0), predecessors=(1,), successors=(6,), **INSIDE),
            lanelet(4, arc(100, -14, 14, 90, 0), predecessors=(1,), successors=(7,), **INSIDE),
            lanelet(6, [(114, 14), (114, 200)], predecessors=(3,)),
            lanelet(7, [(114, -14), (114, -200)], predecessors=(4,)),
        ]
    return lanes


def told(word, xs, lanes=None, **thresholds):
    """A word's values by state, "?" where it is unknown; the same in the mirror."""
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})
    found = recording(lanes or road(), [ego])
    values = []
    for one, side in ((found, "right"), (mirrored_recording(found), "left")):
        signals = at_junctions(context_of(one, ("1", "2", "5"), side, **thresholds))
        column, unknown = values_of(signals, word), unknown_in(signals, word)
        values.append(np.where(unknown, "?", column).tolist())
    assert values[0] == values[1]
    return values[0]


def test_a_drive_that_ends_before_the_only_way_which_turns():
    """It may have got where it was going; who has driven in a good way turns."""
    bend = [
        straight(1, -200, 100, successors=(3,)),
        lanelet(3, arc(100, 14, 14, -90, 0), predecessors=(1,), successors=(6,), **INSIDE),
        lanelet(6, [(114, 14), (114, 200)], predecessors=(3,)),
    ]

    def turns(*places):
        found = recording(bend, [vehicle(7, dict(enumerate(places)))])
        signals = at_junctions(context_of(found, ("1", "3", "6")))
        column, unknown = values_of(signals, "turn"), unknown_in(signals, "turn")
        return np.where(unknown, "?", column).tolist()

    assert turns((80, 0), (94, 0), (97, 0)) == ["straight_on", "?", "?"]
    on = [(x, 0) for x in range(82, 100, 4)]
    onto = [(float(x), float(y)) for x, y in arc(100, 14, 14, -90, 0)[::3]]
    assert turns(*on, *onto, (114, 24), (114, 34))[-3] == "turn_far"


def test_a_drive_that_ends_in_a_junction_where_its_own_lane_leads_nowhere():
    """The map misses the way on from its lane: the road it is placed on turns beside it."""
    lanes = [
        straight(1, -200, 100, left_of="8"),
        straight(8, -200, 100, y=3.5, right_of="1", successors=(3,)),
        lanelet(3, arc(100, 17.5, 14, -90, 0), predecessors=(8,), successors=(6,), **INSIDE),
        lanelet(6, [(114, 17.5), (114, 200)], predecessors=(3,)),
    ]
    found = recording(lanes, [vehicle(7, {k: (x, 0) for k, x in enumerate((80, 94, 97, 103))})])
    signals = at_junctions(context_of(found, ("8", "3", "6")))
    assert values_of(signals, "turn")[-1] == "turn_far"
    assert unknown_in(signals, "turn").tolist() == [False, True, True, True]


def test_a_drive_that_ends_before_the_junction():
    # Fronts are 2 m ahead; the zone begins at 95
    assert told("turn", (80, 90, 94, 97)) == ["straight_on", "straight_on", "?", "?"]
    assert told("turn", (97,)) == ["?"]
    assert told("turn", (80,)) == ["straight_on"]


def test_a_drive_that_ends_within_it():
    # All ways begin alike: after 3 m nobody knows, after 18 m ego is on the one straight on
    assert told("turn", (90, 97, 103))[-1] == "?"
    assert told("turn", (90, 97, 105, 112, 118))[1:] == ["straight_on"] * 4


def test_a_drive_that_goes_through_it():
    assert told("turn", (90, 97, 105, 115, 125)) == ["straight_on"] * 5


def test_where_there_is_one_way_only():
    assert told("turn", (80, 97), road(turns=False)) == ["straight_on"] * 2


def test_what_ego_prepares_for_is_not_known_near_the_drive_s_end():
    # At 10 m/s, two states a second: the zone is 33 m ahead of the front when the drive ends
    xs = [10 + 5.0 * k for k in range(11)]
    found = told("preparing_to_leave", xs, preparing_s=5.0)
    # It would get there 3.3 s later: in the last 1.7 s it may be preparing, before it is not
    assert found == ["False"] * 7 + ["?"] * 4
    assert set(told("preparing_to_leave", xs, preparing_s=3.0)) == {"False"}
    assert told("preparing_to_leave", (90, 94, 97))[-1] == "?"
    # A road without junctions gives nothing to prepare for
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})
    alone = at_junctions(context_of(recording([straight(1, -200, 300)], [ego])))
    assert not unknown_in(alone, "preparing_to_leave").any()


@pytest.mark.parametrize(("preparing_s", "first"), [(10.0, 0), (2.0, 4)])
def test_who_leaves_by_a_ramp_has_prepared_for_it(preparing_s, first):
    lanes = road(turns=False, leaves=True)
    xs = [85 + 5.0 * k for k in range(10)]
    found = told("preparing_to_leave", xs, lanes, preparing_s=preparing_s)
    # The middle is on the ramp from 120 on, in state 8 (at 125; it is at its very end in state 7)
    assert found.index("True") in (first - 1, first)
    assert found[-1] == "True"


@pytest.mark.parametrize(
    ("xs", "lights"),
    [
        # Fronts are 2 m ahead: it is over the line at 100.3 m in the last state
        ((60, 94, 97, 98.5), ["green_light", "?", "?", "?"]),
        ((60, 94, 97, 98.5, 130), ["green_light"] * 4 + ["no_light"]),
    ],
)
def test_the_light_of_a_way_is_not_known_where_the_way_is_not(xs, lights):
    """Straight on is green, to the left red."""
    ways = {"2": Light(0, (("green", 9),)), "3": Light(0, (("red", 9),))}
    lanes = road()
    lanes[0] = replace(lanes[0], lights=tuple(ways.values()), lights_to=ways)
    assert told("light", xs, lanes) == lights
    crosses = [False, False, False, True, False][: len(xs)]
    assert told("crosses_light_line", xs, lanes) == [str(flag) for flag in crosses]


@pytest.mark.parametrize("complete", [True, False])
def test_a_way_without_a_light_beside_others_with_one_leads_past_it(complete):
    """There is one for the way to the left, and none for straight on, if the map has all."""
    red = {"3": Light(0, (("red", 9),))}
    lanes = road()
    lanes[0] = replace(lanes[0], lights=tuple(red.values()), lights_to=red)
    found = recording(lanes, [vehicle(7, {k: (x, 0) for k, x in enumerate((60, 97, 130))})])
    found = replace(found, complete=frozenset({"light"} if complete else ()))
    signals = at_junctions(context_of(found, ("1", "2", "5")))
    light = "no_light" if complete else "red_light"
    assert values_of(signals, "light").tolist() == [light] * 3


def test_who_follows_a_road_that_bends_may_not_have_turned():
    """The map calls the way to the left straight on."""
    lanes = [
        straight(1, -200, 100, successors=(3,)),
        lanelet(3, arc(100, 14, 14, -90, 0), predecessors=(1,), successors=(6,), **INSIDE),
        lanelet(6, [(114, 14), (114, 200)], predecessors=(3,)),
    ]
    places = [(60, 0), (98, 0), (110, 4.2), (114, 30)]
    ego = vehicle(7, dict(enumerate(places)))
    route = ("1", "3", "6")
    plain = at_junctions(context_of(recording(lanes, [ego]), route))
    assert values_of(plain, "turn").tolist() == [
        "straight_on",
        "turn_far",
        "turn_far",
        "straight_on",
    ]
    assert not unknown_in(plain, "turn").any()
    lanes[1] = replace(lanes[1], types=lanes[1].types | {"straightOn"})
    bends = at_junctions(context_of(recording(lanes, [ego]), route))
    assert unknown_in(bends, "turn").tolist() == [False, True, True, False]
    assert not values_of(bends, "preparing_to_leave").any()


def test_a_turn_behind_a_way_that_is_straight_on_is_one():
    """Two junctions without a road between them: straight on at the first, left at the other."""
    lanes = [
        straight(1, -200, 90, successors=(2,)),
        straight(2, 90, 100, predecessors=(1,), successors=(3,), **INSIDE),
        lanelet(3, arc(100, 14, 14, -90, 0), predecessors=(2,), successors=(6,), **INSIDE),
        lanelet(6, [(114, 14), (114, 200)], predecessors=(3,)),
    ]
    lanes[1] = replace(lanes[1], types=lanes[1].types | {"straightOn"})
    ego = vehicle(7, dict(enumerate([(60, 0), (92, 0), (110, 4.2), (114, 30)])))
    found = at_junctions(context_of(recording(lanes, [ego]), ("1", "2", "3", "6")))
    assert values_of(found, "turn").tolist() == [
        "straight_on",
        "turn_far",
        "turn_far",
        "straight_on",
    ]
    assert not unknown_in(found, "turn").any()


def is_sure_of_lane(xs, other, lanes=None):
    """By state, whether another one at a place ahead is surely in ego's lane."""
    there = vehicle(8, dict.fromkeys(range(len(xs)), (other, 0)))
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})
    context = context_of(recording(lanes or road(), [ego, there]), ("1", "2", "5"))
    ahead = ahead_in_lane(context)
    assert measured_ahead(context).all()
    assert ahead.possible.all()
    return ahead.sure[0].tolist()


def test_who_is_ahead_beyond_the_junction_may_be_on_another_way_than_ego():
    assert is_sure_of_lane([60, 75, 90], 140) == [False] * 3
    assert is_sure_of_lane([60, 75, 90], 96) == [True] * 3  # Its rear is still before it


def test_ego_is_known_to_follow_whom_it_follows_through_the_junction():
    assert is_sure_of_lane([60, 75, 115], 140) == [True] * 3
    assert is_sure_of_lane([60, 75, 90], 140, road(turns=False)) == [True] * 3


def test_a_way_back_is_no_other_way():
    *others, last = road(turns=False)
    first, *others = others
    back = straight(9, 100, -200, y=4.0)
    lanes = [replace(first, successors=("2", "9")), *others, last, back]
    assert is_sure_of_lane([60, 75, 90], 140, lanes) == [True] * 3

"""What ego does beyond following its lane, and whether anything makes it, on roads made by hand."""

from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.conduct import (
    lamp_signals,
    manoeuvre_signals,
    reason_signals,
    turning_conflicts,
)
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from rulec.extraction.signals.map import crossing_signals, lanes_ahead
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import HEADINGS, Light, Weather
from support.builders.drive_contexts import along, context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.defined_words import defined
from support.generators.random_recordings import lanes
from support.signal_arrays import said, unknown_in, values_of
from support.words import words_of

SIMULATED = ("arrivals", "light", "YIELD")
INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}


def told(group, word, road, *bodies, side="right", complete=(), route=("1",), **thresholds):
    """A word's first row, or its values, each as T or F, or ? where it is unknown."""
    found = replace(recording(road, bodies), complete=frozenset(complete))
    if side == "left":
        found = mirrored_recording(found)
    signals = group(context_of(found, route, side, **thresholds))
    column = said(signals, word)
    unknown = unknown_in(signals, word)
    column, unknown = (x[0] if x.ndim == 2 else x for x in (column, unknown))
    letters = {"True": "T", "False": "F", "own_side": "F", "oncoming_side": "T"}
    return "".join(
        "?" if dark else letters[str(value)] for value, dark in zip(column, unknown, strict=True)
    )


def impedes(road, *bodies, lines=""):
    found = replace(recording(road, bodies), complete=frozenset(SIMULATED))
    return defined("impedes_traffic", found, lines=lines)


def two_way():
    """Ego's lane along y = 0, and beside it one that leads the other way along y = 4."""
    return [straight(1, 0, 300), lanelet(2, [(300, 4), (0, 4)])]


def car(*places, **more):
    return vehicle(7, dict(enumerate(places)), **more)


def test_who_moves_against_its_heading_drives_backwards():
    backs = car(*((100 - 2 * k, 0.0) for k in range(5)), speed=-4)
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), backs) == "TTTTT"
    # 2 m in all, or what the file says has stood: a box drifts
    drifts = car(*((100 - k / 2, 0.0) for k in range(5)), speed=-1)
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), drifts) == "?????"
    stood = car(*((100 - 2 * k, 0.0) for k in range(5)), speed=0)
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), stood) == "?????"
    # What counts is the mean over a second, which is 2 m/s backwards before it has begun
    to_and_fro = car((100, 0), (102, 0), (104, 0), (104, 0), (102, 0), (100, 0), (98, 0), speed=4)
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), to_and_fro) == "FFFTTTT"


@pytest.mark.parametrize(
    ("xs", "expected"),
    [
        # Places of video are good to 0.3 m, and speeds to 0.3 m/s: who stands may be slow as well
        ((100.0, 100.0, 100.01, 100.0, 100.0, 99.99, 100.0), "FFFFFFF"),
        # 0.4 m in all, which two places may be wrong, at 1.4 km/h for a second
        ((100.0, 100.0, 99.8, 99.6, 99.6, 99.6, 99.6), "FFFFFFF"),
        # It creeps, and the track begins and ends with speeds that are known badly
        ((100.0, 100.1, 100.3, 100.6, 101.0, 101.5, 102.1), "FFFFFFF"),
        ((100.0, 99.4, 98.8, 98.2, 97.6, 97.0, 96.4), "TTTTTTT"),
        ((100.0, 99.8, 99.5, 99.2, 98.9, 98.6, 98.4), "???????"),
    ],
    ids=["stands", "within tolerance", "creeps on", "drives backwards", "a little"],
)
def test_who_comes_back_nowhere_does_not_drive_backwards(xs, expected):
    mps = np.gradient(xs, 0.5)
    body = car(*((x, 0.0) for x in xs))
    states = {k: replace(state, speed=float(mps[k])) for k, state in body.states.items()}
    found = recording(two_way(), [replace(body, states=states)])
    found = replace(found, name="USA_Lanker-1", complete=frozenset({HEADINGS}))
    signals = words_of(manoeuvre_signals)(context_of(found))
    values = np.where(said(signals, "reversing"), "T", "F")
    unknown = unknown_in(signals, "reversing")
    assert "".join(np.where(unknown, "?", values).ravel().tolist()) == expected


def test_who_moves_along_its_lane_by_headings_that_are_made_of_places_drives_forwards():
    on = steady(7, 50, 0)
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), on) == "FFFF"
    assert (
        told(words_of(manoeuvre_signals), "reversing", two_way(), on, complete=SIMULATED) == "FFFF"
    )
    measured = car((50, 0), (55, 0.2), (60, 0.1), (65, 0))
    assert told(words_of(manoeuvre_signals), "reversing", two_way(), measured) == "FFFF"


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("y", "expected"), [(0, "FFFF"), (1.9, "FFFF"), (2.1, "????"), (2.4, "TTTT"), (4, "TTTT")]
)
def test_whose_side_of_a_two_way_road(y, expected, side):
    # The middle of the road is at y = 2 m, and a side has been left 0.3 m beyond it
    ego = steady(7, 50, y)
    assert told(words_of(manoeuvre_signals), "driving_side", two_way(), ego, side=side) == expected


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("ys", "expected"),
    [
        # Over the middle for 1.5 s, of steps of 0.5 s, out and back; then for 2 s
        ((0, 2.1, 2.1, 2.1, 4, 4, 2.1, 0), "FFFFTTFF"),
        ((0, 2.1, 2.1, 2.1, 2.1, 4, 4, 4), "F????TTT"),
        # Who wavers may have been there, and of who comes from there before it was seen none knows
        ((0, 2.1, 0, 0, 0, 0, 0, 0), "F?FFFFFF"),
        ((2.1, 0, 0, 0, 0, 0, 0, 4), "?FFFFFFT"),
    ],
)
def test_only_when_one_goes_over_the_middle_is_in_doubt(ys, expected, side):
    ego = car(*((50.0 + 10 * k, y) for k, y in enumerate(ys)), heading=0.0)
    assert told(words_of(manoeuvre_signals), "driving_side", two_way(), ego, side=side) == expected


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("ys", "expected"),
    [
        # Of 2 m of width 0.3 m have to be on either side of the middle of the road, at y = 2
        ((0, 1.2, 1.6, 2.4, 3.6, 3.6, 2.1, 0), "FFTTFFTF"),
        # At the middle for longer than 2 s before it goes, and never going
        ((1.6, 1.6, 1.6, 1.6, 1.6, 1.6, 3, 4), "FFTTTTTF"),
        ((0, 1.6, 1.6, 1.6, 1.6, 1.6, 1.6, 0), "FFFFFFFF"),
        # Over the middle between two states, as where these are a second apart
        ((0, 0, 0, 4, 4, 4, 0, 0), "FFFTFFTF"),
        # Half over it in one state, and wholly in the next
        ((0, 1.6, 4, 4, 2.6, 0, 0, 0), "FTTFTTFF"),
    ],
)
def test_who_goes_over_the_middle_is_in_two_lanes(ys, expected, side):
    ego = car(*((50.0 + 10 * k, y) for k, y in enumerate(ys)), heading=0.0)
    assert told(words_of(ego_signals), "straddling", two_way(), ego, side=side) == expected


@pytest.mark.parametrize("side", ["right", "left"])
def test_who_goes_over_the_middle_by_places_known_badly_is_in_two_lanes(side):
    """With its middle 0.9 m beyond that of the road, half its width less 0.1 m, it is on one half.

    But with places known to 1.2 m it is certainly on the other one only from there on.
    """
    ys = (0, 1.6, 2.4, 2.9, 3.6, 3.6, 0, 0)
    ego = car(*((50.0 + 10 * k, y) for k, y in enumerate(ys)), heading=0.0)
    sides = told(
        words_of(manoeuvre_signals), "driving_side", two_way(), ego, side=side, place_error_m=0.6
    )
    assert sides[4:6] == "TT"
    found = told(words_of(ego_signals), "straddling", two_way(), ego, side=side, place_error_m=0.6)
    assert found == "FTTFTFTF"


def test_sides_that_are_nobody_s():
    # One way, not told, and where ego crosses the other half to somewhere
    ego = steady(7, 50, 2.4)
    alone = [straight(1, 0, 300)]
    assert (
        told(words_of(manoeuvre_signals), "driving_side", alone, ego, complete=SIMULATED) == "FFFF"
    )
    assert told(words_of(manoeuvre_signals), "driving_side", alone, ego) == "????"
    off = car(*((50 + k, 1 + 2 * k) for k in range(4)), heading=np.arctan(2))
    assert told(words_of(manoeuvre_signals), "driving_side", two_way(), off) == "FFFF"


def test_the_other_side_of_a_junction_is_passed_by_who_turns():
    road = [
        straight(1, 0, 100, successors=(3,)),
        lanelet(2, [(100, 4), (0, 4)]),
        straight(3, 100, 120, predecessors=(1,), successors=(4,), **INSIDE),
        straight(4, 120, 300, predecessors=(3,)),
        lanelet(5, [(300, 4), (120, 4)]),
    ]
    ego = steady(7, 70, 3, steps=12)
    found = told(words_of(manoeuvre_signals), "driving_side", road, ego, route=("1", "3", "4"))
    # From 15 m before to 15 m behind it: fronts up to 85, rears from 135
    assert found == "TTTFFFFFFFFF"


def arc(x, y, radius, first, last, step=6):
    angles = np.radians(np.arange(first, last + 1, step))
    return [(x + radius * np.cos(a), y + radius * np.sin(a), a + np.pi / 2) for a in angles]


def turning_round():
    """From (20, 0) on to x = 50, round to y = 10 and back."""
    there = [(20.0 + 3 * k, 0.0, 0.0) for k in range(10)]
    back = [(47.0 - 3 * k, 10.0, np.pi) for k in range(10)]
    poses = [*there, *arc(50, 5, 5, -90, 90), *back]
    bodies = [vehicle(7, {k: (x, y)}, heading=way) for k, (x, y, way) in enumerate(poses)]
    states = {k: body.states[k] for k, body in enumerate(bodies)}
    outlines = {k: body.outlines[k] for k, body in enumerate(bodies)}
    return replace(bodies[0], states=states, outlines=outlines)


def test_who_turns_round_on_the_road():
    found = told(words_of(manoeuvre_signals), "u_turn", [straight(1, 0, 300)], turning_round())
    assert found[:10] == "F" * 10
    # From 30° to 150° across, six degrees a state
    assert found[16:34] == "T" * 18
    assert found[-8:] == "F" * 8


def test_who_turns_round_in_a_junction_or_where_the_road_does():
    inside = [
        straight(1, 0, 45, successors=(2,)),
        straight(2, 45, 60, predecessors=(1,), successors=(3,), **INSIDE),
        straight(3, 60, 300, predecessors=(2,)),
        lanelet(4, [(52, -20), (52, 20)], **INSIDE),
    ]
    found = told(
        words_of(manoeuvre_signals), "u_turn", inside, turning_round(), route=("1", "2", "3")
    )
    assert set(found) == {"F"}
    line = [(x, y) for x, y, _ in [(0, 0, 0), *arc(50, 5, 5, -90, 90), (0, 10, 0)]]
    assert set(
        told(words_of(manoeuvre_signals), "u_turn", [lanelet(1, line)], turning_round())
    ) == {"F"}


@pytest.mark.parametrize("side", ["right", "left"])
def test_who_turns_round_over_the_next_lane_may_have_changed_to_none(side):
    found = told(
        words_of(lane_change_signals, indicator_signals),
        "lane_change",
        lanes(2),
        turning_round(),
        side=side,
    )
    assert (found.count("?"), set(found)) == (1, {"F", "?"})
    changes = car(*((20.0 + 3 * k, 0.4 * k) for k in range(11)))
    found = told(
        words_of(lane_change_signals, indicator_signals),
        "lane_change",
        lanes(2),
        changes,
        side=side,
    )
    assert (found.count("T"), set(found)) == (1, {"F", "T"})


def beside_the_road(*more, waits=6):
    """Ego stands 1 m off the lane, whose edge is at y = -2, and drives into it."""
    return car(*([(50.0, -3.0)] * waits), (51, -2.7), (53, -2), (56, -1), (60, 0), *more)


def test_who_sets_off_from_beside_the_road():
    found = told(
        words_of(manoeuvre_signals), "joins_road", two_way(), beside_the_road((65, 0), (70, 0))
    )
    # From when it moves until its middle is across the edge
    assert found == "FFFFFTTTFFFF"
    assert set(told(words_of(manoeuvre_signals), "joins_road", two_way(), steady(7, 50, 0))) == {
        "F"
    }
    # It came from beside the road, perhaps from one that the map leaves out
    comes = car((44, -8), (46, -6), (48, -4), (50, -2.5), (53, -1), (57, 0), (62, 0))
    assert "?" in told(words_of(manoeuvre_signals), "joins_road", two_way(), comes)
    assert "T" not in told(words_of(manoeuvre_signals), "joins_road", two_way(), comes)


def test_who_stands_across_on_its_way_round_joins_no_road():
    """It backs off the road while it turns, stands there with its middle beyond the edge."""
    there = [(20.0 + 3 * k, 0.0, 0.0) for k in range(10)]
    round_ = [(50 - k / 3, -k / 9, np.radians(5 * k)) for k in range(37)]
    waits = [(38.0, -4.0, np.pi)] * 4
    back = [(36.0 - 3 * k, max(-4.0 + 2 * k, -4), np.pi) for k in range(4)]
    poses = [*there, *round_, *waits, *back]
    bodies = [vehicle(7, {k: (x, y)}, heading=way) for k, (x, y, way) in enumerate(poses)]
    ego = replace(
        bodies[0],
        states={k: body.states[k] for k, body in enumerate(bodies)},
        outlines={k: body.outlines[k] for k, body in enumerate(bodies)},
    )
    found = told(words_of(manoeuvre_signals), "joins_road", two_way(), ego)
    assert ("T" in found, "?" in found) == (False, True)


BRAKES = [
    (50, 0),
    (60, 0),
    (69, 0),
    (77, 0),
    (84, 0),
    (90, 0),
    *((95 + 5 * k, 0) for k in range(60)),
]
LONG = [straight(1, 0, 900)]


def cause(*others, road=LONG, complete=SIMULATED, behind_m=20, route=("1",)):
    """Is there a cause to brake, for ego and one behind it that does as ego does?"""
    follower = vehicle(6, {k: (x - behind_m, y) for k, (x, y) in enumerate(BRAKES)})
    found = [car(*BRAKES), follower, *others]
    return told(
        words_of(reason_signals), "cause_to_brake", road, *found, complete=complete, route=route
    )


def test_nothing_makes_ego_brake():
    assert cause()[:10] == "F" * 10
    # At 4 m/s² and more with nobody behind by less than 3 s it takes nobody by surprise
    far = cause(behind_m=70)
    assert ("?" in far[:6], "T" in far, far[6:10]) == (True, False, "FFFF")
    # What a file has not recorded may: nobody is recorded ahead, or somebody farther than that
    assert cause(complete=("light",))[:10] == "?" * 10
    seen = steady(8, 330, 0, 20, 70)
    assert cause(seen, complete=("light",))[:10] == "F" * 10


@pytest.mark.parametrize(
    "other",
    [
        steady(8, 90, 0, 8, 70),
        vehicle(8, {k: (100, -15 + 2.0 * k) for k in range(15)}, "bicycle", heading=np.pi / 2),
        vehicle(8, {k: (90 + 5.0 * k, 4 - 0.2 * k) for k in range(20)}),
    ],
    ids=["ahead", "across", "comes over"],
)
def test_somebody_makes_ego_brake(other):
    found = cause(other)
    assert ("F" in found[:4], found[3]) == (False, "T")


def test_who_is_farther_off_makes_nobody_brake():
    assert cause(steady(8, 20, 0, 15, 70), steady(9, 90, 4.5, 26, 70))[:10] == "F" * 10
    # On the far side one that ego would pass; beside it one that it may want to follow
    assert cause(steady(9, 90, 4.5, 20, 70))[:2] == "??"
    assert cause(steady(9, 60, -4.5, 20, 70))[:4] == "????"


@pytest.mark.parametrize(
    ("leader", "expected"),
    [
        # It keeps its distance of 40 m, 2 s; it is slower; it brakes as ego does; it is near by
        (steady(8, 94, 0, 20, 70), "?"),
        (steady(8, 94, 0, 12, 70), "T"),
        (vehicle(8, {k: (x + 40, y) for k, (x, y) in enumerate(BRAKES)}), "T"),
        (steady(8, 72, 0, 20, 70), "T"),
    ],
    ids=["drives on", "slower", "brakes", "near"],
)
def test_one_ahead_is_a_reason_for_who_would_run_into_it(leader, expected):
    # 4 m/s² from the second state on; before that one that is no faster makes ego no slower
    assert set(cause(leader)[1:5]) == {expected}


@pytest.mark.parametrize(
    ("road", "expected"),
    [
        (
            [
                straight(1, 0, 110, successors=(2,)),
                straight(2, 110, 900, predecessors=(1,), **INSIDE),
            ],
            "??????",
        ),
        ([straight(1, 0, 130)], "??????"),
        (
            [
                straight(1, 0, 110, successors=(2,), limit_mps=30.0),
                straight(2, 110, 900, predecessors=(1,), limit_mps=14.0),
            ],
            # Who has become so slow need not brake for it any more
            "TTTT??",
        ),
        (
            [
                straight(1, 0, 110, successors=(2,), limit_mps=30.0),
                straight(2, 110, 900, predecessors=(1,), untold_signs=frozenset({"MAX_SPEED"})),
            ],
            "??????",
        ),
        ([lanelet(1, [(0, 0), (120, 0), (200, 60), (400, 400)])], "??????"),
    ],
    ids=["a junction", "an end", "a lower limit", "an untold limit", "a bend"],
)
def test_the_map_may_make_ego_brake(road, expected):
    route = tuple(x.id for x in road)
    found = told(
        words_of(reason_signals),
        "cause_to_brake",
        road,
        car(*BRAKES),
        complete=SIMULATED,
        route=route,
    )
    assert found[:6] == expected


def test_who_has_just_braked_for_a_lower_limit_still_seems_to_brake_hard():
    lower = [
        straight(1, 0, 78, successors=(2,), limit_mps=30.0),
        straight(2, 78, 900, predecessors=(1,), limit_mps=14.0),
    ]
    # In the fifth state its front is beyond the sign, but the mean over a second is -4 m/s²
    follower = vehicle(6, {k: (x - 20, y) for k, (x, y) in enumerate(BRAKES)})
    both = (car(*BRAKES), follower)
    found = told(
        words_of(reason_signals),
        "cause_to_brake",
        lower,
        *both,
        complete=SIMULATED,
        route=("1", "2"),
    )
    assert found[:8] == "TTTT?FFF"


@pytest.mark.parametrize(("last", "expected"), [(0, "????FF"), (2, "?????F"), (40, "??????")])
def test_who_brakes_for_somebody_beside_a_crossing_brakes_on_for_a_moment(last, expected):
    """One walks 8 m aside until state ``last``; the mean over a second is -4 m/s² for five states.

    That one will not cross is seen after 1 s, and half a second more is part of the mean.
    """
    crossing = lanelet(9, [(160, -6), (160, 6)], types=frozenset({"crosswalk"}))
    places = {k: (100.0 - k, 8.0) for k in range(last + 1)}
    walker = vehicle(8, places, "pedestrian", length=0.5, width=0.5)
    found = cause(walker, road=[*LONG, crossing])
    assert found[:6] == expected


def signed_junction(light=None, signs=(), first=frozenset()):
    """Ego's road, which leads straight on from 140 to 160 m, and one across that comes from -y."""
    lights = {} if light is None else {"lights": (light,), "lights_to": {"2": light}}
    across = [(150.0, -100.0), (150.0, -10.0), (150.0, 10.0), (150.0, 100.0)]
    others = {"types": frozenset({"intersection"}), "junction": "x", "first": frozenset({"2"})}
    return [
        straight(1, 0, 140, successors=(2,), signs=frozenset(signs), **lights),
        straight(2, 140, 160, predecessors=(1,), successors=(3,), first=first, **INSIDE),
        straight(3, 160, 900, predecessors=(2,)),
        lanelet(4, across[:2], successors=("5",)),
        lanelet(5, across[1:3], predecessors=("4",), successors=("6",), **others),
        lanelet(6, across[2:], predecessors=("5",)),
    ]


def shows(*colours):
    """A light with these colours, one for each state, and the last one for good."""
    return Light(0, (*((colour, 1) for colour in colours[:-1]), (colours[-1], 1000)))


NOBODY_FIRST, FIVE_FIRST = frozenset(), frozenset({"5"})


@pytest.mark.parametrize(
    ("road", "expected"),
    [
        (signed_junction(first=NOBODY_FIRST), "FFFF"),
        (signed_junction(first=FIVE_FIRST), "????"),
        (signed_junction(signs=["YIELD"]), "????"),
        (signed_junction(signs=["STOP"]), "TTTT"),
        (signed_junction(shows("green")), "FFFF"),
        (signed_junction(shows("red")), "TTTT"),
        # It has turned green, and ego may brake on for the second that it takes to see it
        (signed_junction(shows("red", "red", "green")), "T??F"),
    ],
    ids=["first", "not first", "gives way", "stop sign", "green", "red", "turns green"],
)
def test_a_junction_is_a_reason_for_who_has_to_wait_there(road, expected):
    found = cause(road=road, complete=SIMULATED, route=("1", "2", "3"))
    assert found[1:5] == expected


@pytest.mark.parametrize(
    ("y", "mps", "expected"),
    # It gets there before ego, which is 80 m away; it stands at its line; it drives off, long ago
    [(-60.0, 16.0, "T"), (-12.0, 0.0, "F"), (40.0, 16.0, "F"), (-60.0, 4.0, "?")],
    ids=["comes", "waits", "gone", "comes later"],
)
def test_who_comes_to_a_junction_makes_ego_brake(y, mps, expected):
    """Ego goes first: who drives towards its way may not wait all the same."""
    places = {k: (150.0, y + mps * k / 2) for k in range(30)}
    foe = vehicle(8, places, speed=mps, heading=np.pi / 2)
    found = cause(foe, road=signed_junction(), complete=SIMULATED, route=("1", "2", "3"))
    assert set(found[2:5]) == {expected}


@pytest.mark.parametrize(("mps", "expected"), [(0, "?"), (7, "?"), (15, "F"), (40, "F")])
def test_who_is_much_slower_beside_ego_s_lane_may_come_into_it(mps, expected):
    """Ego comes at 20 m/s, and 50 m ahead one is in the lane at its near side."""
    found = cause(steady(8, 100, -4, mps, 70))
    assert found[:4] == expected * 4


def test_who_comes_to_a_lane_that_joins_others_may_brake_for_a_gap():
    ramp = [
        straight(1, 0, 110, successors=(2,)),
        straight(2, 110, 1900, predecessors=(1,), types=frozenset({"accessRamp"})),
    ]
    ego = car(*BRAKES)
    found = told(
        words_of(reason_signals), "cause_to_brake", ramp, ego, complete=SIMULATED, route=("1", "2")
    )
    # At 20 m/s it looks ahead for 3 s, 50 m and 20 m
    assert found[:10] == "?" * 10
    far = [
        replace(ramp[0], types=frozenset({"accessRamp"})),
        straight(2, 110, 1900, predecessors=(1,)),
    ]
    found = told(
        words_of(reason_signals), "cause_to_brake", far, ego, complete=SIMULATED, route=("1", "2")
    )
    assert found[:10] == "?" * 10
    assert found[30:40] == "F" * 10


def test_who_has_waited_needs_a_moment_to_get_going():
    """One stands ahead of ego for 5 s, and drives off; ego stays, its hazard lights off.

    It need not set off for 2 s, and may take 5 s more.
    """
    shows = frozenset({"hazard_lights"})
    ego = steady(7, 50, 0, 0, 80)
    ego = replace(ego, lamps=dict.fromkeys(range(80), frozenset()), shows=shows)
    ahead = vehicle(8, {k: (60 + 10 * max(k - 10, 0), 0) for k in range(80)})
    found = told(words_of(reason_signals), "cause_to_brake", LONG, ego, ahead, complete=SIMULATED)
    gone = found.index("?")
    assert found[:gone] == "T" * gone
    assert found[gone:60] == "?" * 10 + "F" * (50 - gone)


@pytest.mark.parametrize(("fast", "expected"), [(20.0, "F"), (5.0, "?")])
def test_who_drives_on_later_has_not_broken_down(fast, expected):
    """It stands from 4 to 12 s, with nobody near; no lamp is told. Slowly it may be towed."""
    speeds = [*np.linspace(20, 0, 9), *[0.0] * 16, *np.linspace(0, fast, 16), *[fast] * 30]
    x = 50 + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    ego = vehicle(7, {k: (place, 0) for k, place in enumerate(x)})
    found = told(words_of(reason_signals), "cause_to_brake", LONG, ego, complete=SIMULATED)
    assert set(found[9:24]) == {expected}


@pytest.mark.parametrize(
    ("walker_y", "complete", "expected"),
    # Somebody is about, 25 m from ego's line; nobody is, 60 m away; not all traffic is recorded
    [(25.0, SIMULATED, "???"), (60.0, SIMULATED, "?FF"), (60.0, ("light", "YIELD"), "???")],
)
def test_who_stands_before_a_zebra_crossing_for_nobody_has_no_cause(walker_y, complete, expected):
    """It stands from 4.5 to 20 s, 4 m before the crossing."""
    speeds = [*np.linspace(20, 0, 9), *[0.0] * 32, *np.linspace(0, 20, 16), *[20.0] * 30]
    x = 50 + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    ego = vehicle(7, {k: (place, 0) for k, place in enumerate(x)})
    crossing = lanelet(9, [(x[10] + 8, -6), (x[10] + 8, 6)], types=frozenset({"crosswalk"}))
    places = {k: (float(x[10]), walker_y) for k in range(len(x))}
    walker = vehicle(8, places, "pedestrian", length=0.5, width=0.5)
    road = [*LONG, crossing]
    found = told(words_of(reason_signals), "cause_to_brake", road, ego, walker, complete=complete)
    # After 3 s of standing, in which somebody may have been about to come, and 5 s more
    assert "".join(found[k] for k in (14, 26, 38)) == expected


@pytest.mark.parametrize(
    ("other", "expected"),
    # Behind ego, waiting for it, or come as far from the side
    [((-8.0, 0.0, 0.0), "??F"), ((0.0, -15.0, 90.0), "???")],
)
def test_who_stands_in_a_junction_has_no_cause_in_who_waits_behind_it(other, expected):
    """It stands from 4.5 to 20 s, in the middle of 40 m."""
    speeds = [*np.linspace(20, 0, 9), *[0.0] * 32, *np.linspace(0, 20, 16), *[20.0] * 30]
    x = 50 + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    ego = vehicle(7, {k: (place, 0) for k, place in enumerate(x)})
    begin, end = float(x[10]) - 20, float(x[10]) + 20
    road = [
        straight(1, 0, begin, successors=(2,)),
        straight(2, begin, end, predecessors=(1,), successors=(3,), **INSIDE),
        straight(3, end, 900, predecessors=(2,)),
    ]
    ahead, left, turned = other
    places = dict.fromkeys(range(len(x)), (float(x[10]) + ahead, left))
    waits = vehicle(8, places, speed=0.0, heading=np.radians(turned))
    found = told(words_of(reason_signals), "cause_to_brake", road, ego, waits, complete=SIMULATED)
    assert "".join(found[k] for k in (15, 25, 38)) == expected


@pytest.mark.parametrize("hazards_told", [False, True])
def test_who_stands_when_it_is_first_seen_may_have_waited_until_then(hazards_told):
    speeds = [*[0.0] * 30, *np.linspace(0, 20, 16), *[20.0] * 20]
    x = 50 + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    ego = vehicle(7, {k: (place, 0) for k, place in enumerate(x)})
    if hazards_told:
        dark = dict.fromkeys(range(len(x)), frozenset())
        ego = replace(ego, lamps=dark, shows=frozenset({"hazard_lights"}))
    found = told(words_of(reason_signals), "cause_to_brake", LONG, ego, complete=SIMULATED)
    # It has the time to get going after 5 s
    assert (set(found[:11]), set(found[11:28])) == ({"?"}, {"F"})


@pytest.mark.parametrize(("back", "expected"), [(-2.0, "?"), (20.0, "F")])
def test_who_stands_before_it_backs_may_have_to(back, expected):
    """It stands from 4 to 8 s, backs for 4 s, or does not, and drives on."""
    later = [*np.linspace(0, back, 5), *[back] * 4, *np.linspace(back, 20, 12), *[20.0] * 30]
    speeds = [*np.linspace(20, 0, 9), *[0.0] * 8, *later]
    x = 50 + np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) / 2)))
    ego = vehicle(7, {k: (place, 0) for k, place in enumerate(x)}, speed=10.0)
    found = told(words_of(reason_signals), "cause_to_brake", LONG, ego, complete=SIMULATED)
    assert set(found[10:16]) == {expected}


def test_who_holds_up_others():
    road = [straight(1, 0, 2500, limit_mps=30.0)]
    slow, follower = steady(7, 100, 0, 10, 100), steady(8, 85, 0, 10, 100)
    found = impedes(road, slow, follower)
    # After ten seconds, of half a second each. Whether it has a reason in its last five is unknown
    assert found[:21] == "?" * 20 + "T"
    assert found[-11:] == "T" + "?" * 10
    assert found[40] == "T"
    assert set(impedes(road, slow)) == {"F"}
    # Who falls back, by 1.5 m/s, from 8 m to 23 m behind within 10 s, is slow by itself
    falls_back = steady(8, 85, 0, 8.5, 100)
    found = impedes(road, slow, falls_back)
    assert set(found) == {"F"}
    leader = steady(9, 115, 0, 10, 100)
    queue = impedes(road, slow, follower, leader)
    assert set(queue) == {"F"}


def test_who_gains_speed_is_not_slow_for_good():
    """From 2 to 14 m/s by 0.6 m/s² in 20 s, as a bus after its stop; half of the limit are 15."""
    road = [straight(1, 0, 2500, limit_mps=30.0)]
    way = [100 + 2 * t + 0.3 * t * t for t in np.arange(0, 20, 0.5)]
    ego, follower = (
        vehicle(n, {k: (x - d, 0) for k, x in enumerate(way)}) for n, d in ((7, 0), (8, 9))
    )
    found = impedes(road, ego, follower)
    assert "T" not in found


def test_a_cycle_holds_up_nobody():
    """The law asks for no more than its rider's strength."""
    road = [straight(1, 0, 2500, limit_mps=13.9)]
    rider = steady(7, 100, 0, 5, 100, kind="bicycle")
    follower = steady(8, 92, 0, 5, 100)
    found = impedes(road, rider, follower)
    assert set(found) == {"F"}
    moped = replace(rider, type="motorcycle")
    found = impedes(road, moped, follower)
    assert found[40] == "T"


def crossroads():
    turn = [(x, y) for x, y, _ in arc(100, -14, 14, 0, 90)][::-1]
    return [
        straight(1, 0, 100, successors=(2, 3)),
        straight(2, 100, 120, predecessors=(1,), successors=(4,), **INSIDE),
        lanelet(3, turn, predecessors=(1,), successors=(5,), **INSIDE),
        straight(4, 120, 300, predecessors=(2,)),
        lanelet(5, [(114, -14), (114, -200)], predecessors=(3,)),
    ]


def turns_before(start, mps, steps=40, kind="bicycle", y=-2.5, **thresholds):
    """Ego turns right at 5 m/s, its middle at the junction at 4 s; a rider goes straight on."""
    turn = [(x, y) for x, y, _ in arc(100, -14, 14, 0, 90)][::-1]
    ego = along(7, np.array([(0, 0), *turn, (114, -200)]), 80 + 2.5 * np.arange(steps))
    rider = vehicle(8, {k: (start + mps * k / 2, y) for k in range(steps)}, kind, length=2, width=1)
    route = ("1", "3", "5")
    return told(
        words_of(turning_conflicts),
        "turns_in_way_of",
        crossroads(),
        ego,
        rider,
        route=route,
        **thresholds,
    )


def test_who_seems_to_ride_behind_may_ride_beside_it_where_places_are_in_error():
    """It laps ego's side by 0.3 m."""
    assert set(turns_before(75, 5, y=-1.2)) == {"F"}
    found = turns_before(75, 5, y=-1.2, place_error_m=0.2)
    assert "?" in found
    assert "T" not in found


def test_who_turns_across_the_way_of_a_rider_beside_it():
    # The rider is 5 m behind ego's middle when ego gets to the junction, as fast as ego
    assert "T" in turns_before(75, 5)
    assert "?" not in turns_before(75, 5)


@pytest.mark.parametrize(("y", "told"), [(-2.5, "T"), (-1.5, "?"), (-1.3, "?"), (-1.0, "F")])
def test_who_hardly_clears_egos_side_may_ride_beside_or_behind_it(y, told):
    """Ego reaches to y = -1, and the rider is 1 m wide: clear by 1 m, just, hardly, or not."""
    found = turns_before(75, 5, y=y)
    assert (told in found) if told != "F" else set(found) == {"F"}
    assert "T" not in found or told == "T"


def test_who_rides_behind_one_that_turns_back_is_not_beside_it():
    """Ego has turned by 7° when it is first seen in the junction: to that, 25 m behind is aside."""
    turn = [(x, y) for x, y, _ in arc(100, 4, 4, -90, 30)]
    back = turn[-1][0] - 100, turn[-1][1] + 173
    lanes = [
        straight(1, 0, 100, successors=(3,)),
        lanelet(3, turn, predecessors=(1,), successors=(5,), **INSIDE),
        lanelet(5, [turn[-1], back], predecessors=(3,)),
        lanelet(6, [(110, -20), (110, 30)], **INSIDE),
    ]
    ego = along(7, np.array([(0, 0), *turn, back]), 96.5 + np.arange(40))
    rider = steady(8, 70, 0, 5, 40, kind="bicycle", length=1.8, width=0.6)
    route = ("1", "3", "5")
    assert set(
        told(words_of(turning_conflicts), "turns_in_way_of", lanes, ego, rider, route=route)
    ) == {"F"}


@pytest.mark.parametrize(
    ("start", "mps", "more"),
    [
        (40, 3, {}),
        (95, 5, {}),
        (75, 5, {"y": 3.0}),
        (75, 5, {"kind": "pedestrian"}),
        (75, 5, {"y": -1.2}),
    ],
    ids=["far behind", "ahead", "on the other side", "on foot", "behind it"],
)
def test_who_is_in_nobody_s_way_when_turning(start, mps, more):
    assert set(turns_before(start, mps, **more)) == {"F"}


def test_a_rider_who_is_lost_from_sight_before_it_gets_there():
    found = turns_before(75, 5, steps=40)
    assert found == turns_before(75, 5)
    turn = [(x, y) for x, y, _ in arc(100, -14, 14, 0, 90)][::-1]
    ego = along(7, np.array([(0, 0), *turn, (114, -200)]), 80 + 2.5 * np.arange(40))
    rider = vehicle(8, {k: (75 + 2.5 * k, -2.5) for k in range(9)}, "bicycle", length=2, width=1)
    lost = told(
        words_of(turning_conflicts),
        "turns_in_way_of",
        crossroads(),
        ego,
        rider,
        route=("1", "3", "5"),
    )
    assert "?" in lost
    assert "T" not in lost


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(("y", "expected"), [(-2.6, "T"), (-2.02, "?"), (-1.5, "F"), (1.5, "F")])
def test_who_is_beside_the_road_is_on_its_shoulder(y, expected, side):
    stands = steady(8, 80, y, speed=0)
    found = told(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals),
        "on_shoulder",
        two_way(),
        steady(7, 50, 0),
        stands,
        side=side,
    )
    assert set(found) == {expected}


def test_who_waits_in_a_side_road_is_not_on_the_shoulder():
    waits = steady(8, 80, -3, speed=0, heading=np.pi / 2)
    found = told(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals),
        "on_shoulder",
        two_way(),
        steady(7, 50, 0),
        waits,
    )
    assert set(found) == {"F"}


@pytest.mark.parametrize(
    ("ego_x", "queue_x", "expected"),
    [
        # The junction is from 100 to 120, fronts are 2 m ahead, ego is 4 m long and keeps 1 m
        (90, 126.5, "T"),
        # 5.5 m of room behind it; 16 m before it; in it, where the one ahead is 14 m off
        (90, 127.5, "?"),
        (82, 126.5, "?"),
        (108, 126.5, "?"),
    ],
    ids=["no room", "room", "far", "in it"],
)
def test_who_stands_before_a_junction_without_room_behind_it_has_a_cause(ego_x, queue_x, expected):
    lanes = [
        straight(1, 0, 100, successors=(2,)),
        straight(2, 100, 120, predecessors=(1,), successors=(3,), **INSIDE),
        straight(3, 120, 900, predecessors=(2,)),
    ]
    ego, queue = car(*[(ego_x, 0)] * 20), steady(8, queue_x, 0, 0, 20)
    found = told(
        words_of(reason_signals), "cause_to_brake", lanes, ego, queue, route=("1", "2", "3")
    )
    assert set(found) == {expected}


def test_the_nearest_to_the_crossing():
    zebra = lanelet(9, [(150, -5), (150, 5)], types=frozenset({"crosswalk"}))
    road, ego = [*two_way(), zebra], steady(7, 80, 0)
    near, far = steady(8, 125, 0, speed=5), steady(8, 115, 0, speed=5)
    ahead = steady(9, 120, 0, speed=5)
    nearest = "nearest_to_crossing"
    assert told(words_of(crossing_signals), nearest, road, ego, near, ahead) == "TTTT"
    assert told(words_of(crossing_signals), nearest, road, ego, far, ahead) == "FFFF"


BEAMS = frozenset({"dipped_beam", "main_beam", "rear_fog_lamp"})


@pytest.mark.parametrize(
    ("lit", "night", "expected"),
    [
        ({"main_beam", "dipped_beam"}, None, "main_beam"),
        ({"dipped_beam", "brake_light"}, True, "dipped_beam"),
        ({"rear_fog_lamp"}, True, "lamps_off"),
        (set(), False, None),
        (set(), None, None),
    ],
)
def test_the_brightest_of_ego_s_lamps(lit, night, expected):
    ego = replace(steady(7, 50, 0), shows=BEAMS, lamps={k: frozenset(lit) for k in range(3)})
    found = replace(recording(two_way(), [ego]), weather=Weather(night=night))
    signals = words_of(lamp_signals)(context_of(found))
    assert unknown_in(signals, "headlamps").tolist() == [*([expected is None] * 3), True]
    assert expected in (None, said(signals, "headlamps")[0])
    assert values_of(signals, "rear_fog_lamps").tolist() == [*(["rear_fog_lamp" in lit] * 3), False]
    # Of the others the file says nothing
    assert signals.world.keys() == {"headlamps", "rear_fog_lamps", "ego_on_call"}


@pytest.mark.parametrize(
    ("kind", "blue", "expected"),
    [
        ("priorityVehicle", None, "?" * 8),  # nobody tells of its lamps
        ("priorityVehicle", (), "F" * 8),
        ("priorityVehicle", (0, 1, 6, 7), "TTTTTTTT"),  # a flash is dark for a while
        ("priorityVehicle", (7,), "FFFFFTTT"),
        ("car", None, "F" * 8),
        ("vehicle", None, "F" * 8),
        ("car", (0,), "TTTFFFFF"),  # a police car without its colours
    ],
)
def test_ego_is_on_call_while_its_blue_lights_are_on(kind, blue, expected):
    ego = vehicle(7, {k: (10.0 * k, 0) for k in range(8)}, kind, speed=20)
    if blue is not None:
        lamps = {k: frozenset({"blue_light"} if k in blue else ()) for k in range(8)}
        ego = replace(ego, shows=frozenset({"blue_light"}), lamps=lamps)
    assert told(words_of(lamp_signals), "ego_on_call", two_way(), ego) == expected


@pytest.mark.parametrize("step_s", [0.1, 0.25, 0.5])
def test_who_turns_round_before_an_oncoming_one_does_so_in_steps_of_any_length(step_s):
    """Ego's drive along its own half ends as it is across: with long steps at 56° already.

    The other one comes at 14 m/s, is 11 m away then, and brakes.
    """
    t = np.arange(0, 12 + step_s / 2, step_s)
    begins, radius, mps = 7.2, 3.4, 15 / 3.6
    angle = np.clip((t - begins) * mps / radius, 0, np.pi)
    beyond = np.maximum((t - begins) * mps - np.pi * radius, 0)
    x = np.minimum(mps * t, mps * begins) + radius * np.sin(angle) - beyond
    y = -1.75 + radius * (1 - np.cos(angle))
    ego = rulec.build_participant("ego", "car", t, x, y, step_s=step_s, heading=angle)
    speed = np.clip(14 - 4.5 * (t - 7.0), 2, 14)
    braked = np.clip(t - 7.0, 0, 12 / 4.5)
    driven = 14 * np.minimum(t, 7.0) + 14 * braked - 2.25 * braked**2
    driven += 2 * np.maximum(t - 7.0 - 12 / 4.5, 0)
    other = rulec.build_participant(
        "o", "car", t, 30 + 25 + 98 - driven, 0 * t + 1.75, step_s=step_s, speed=speed
    )
    road = [
        rulec.build_lanelet("E", [(-20, -1.75), (300, -1.75)]),
        rulec.build_lanelet("W", [(300, 1.75), (-20, 1.75)]),
    ]
    made = rulec.build_recording(road, [ego, other], step_s=step_s, side="right", ego="ego")
    violated = {
        name for row in rulec.verify_recording(made, "fr").rows() for name in row["violated"]
    }
    assert "joining_road" in violated

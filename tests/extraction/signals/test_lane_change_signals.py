"""Signals of lane changes, and of the indicator."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.conduct.lane_changes import indicator_signals, lane_change_signals
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import possible_in, said, unknown_in, values_of
from support.words import words_of

# From the right lane to the left one, at 10 m/s; the middle crosses the mark before state 2
CHANGE = {0: (0, 0), 1: (5, 1.5), 2: (10, 2.5), 3: (15, 4)}


def changes(*others, body=None, side="right", **thresholds):
    ego = body or vehicle(7, CHANGE)
    return words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(2), [ego, *others]), side=side, **thresholds)
    )


def test_the_state_in_which_the_lane_is_another_one():
    assert values_of(changes(), "lane_change").tolist() == [False, False, True, False]
    assert values_of(changes(body=steady(7, 0, 0)), "lane_change").tolist() == [False] * 4


@pytest.mark.parametrize(
    ("ys", "changed", "lane"),
    [
        # The mark is at 2 m, and left behind 0.3 m farther on
        ((2.1, 2.2, 2.5, 4), "..T.", [False, False, True, True]),
        ((2.1, 2.0, 1.5, 0), "..T.", [False, False, True, True]),
        ((2.5, 2.5, 4.0, 4), "....", [True] * 4),
        ((2.1, 2.2, 2.1, 2.2), "....", [False] * 4),
    ],
    ids=["goes over", "goes back", "is over it", "stays there"],
)
def test_who_begins_on_a_mark_may_come_from_either_lane(ys, changed, lane):
    ego = vehicle(7, {k: (5.0 * k, y) for k, y in enumerate(ys)})
    context = context_of(recording(lanes(2), [ego]))
    found = words_of(lane_change_signals, indicator_signals)(context)
    assert np.flatnonzero(unknown_in(found, "lane_change")).tolist() == [
        k for k, mark in enumerate(changed) if mark == "T"
    ]
    assert (~unknown_in(words_of(ego_signals)(context), "lane")).tolist() == lane


@pytest.mark.parametrize(
    ("x", "unknown"),
    # Ego is 4 m long, and in the left lane, if it comes from the right one, from 10 m on
    [(0.0, True), (-5.0, True), (-40.0, False), (40.0, False)],
)
@pytest.mark.parametrize("to_left", [True, False])
def test_who_may_come_into_a_lane_may_be_in_the_way_there(x, unknown, to_left):
    """A drive that begins on the mark; the other one, 5 m/s faster, is at ``x`` from ego then."""
    ys = np.array([2.1, 2.2, 2.5, 4.0])
    ys = ys if to_left else 4.0 - ys
    ego = vehicle(7, {k: (5.0 * k, y) for k, y in enumerate(ys)})
    other = steady(8, 10.0 + x - 15.0, 4.0 if to_left else 0.0, speed=15.0)
    route = ("2",) if to_left else ("1",)
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(2), [ego, other]), route)
    )
    assert not values_of(found, "lane_change").any()
    assert unknown_in(found, "lane_is_clear").tolist() == [False, False, unknown, False]
    assert values_of(found, "lane_is_clear")[[0, 1, 3]].all()


@pytest.mark.parametrize(("states", "known"), [(4, False), (6, True)])
def test_who_is_back_within_half_a_second_has_changed_no_lanes(states, known):
    """Its middle is 1 m beyond the mark for 0.4 s or 0.6 s, as where headings jump."""
    ys = [0.0] * 10 + [3.0] * states + [0.0] * 10
    ego = vehicle(7, {k: (k, y) for k, y in enumerate(ys)})
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(2), [ego], step_s=0.1))
    )
    changed = np.flatnonzero(possible_in(found, "lane_change"))
    assert len(changed) == 2
    assert unknown_in(found, "lane_change")[changed].tolist() == [not known] * 2


@pytest.mark.parametrize(
    ("y", "states", "unknown"),
    # The mark is at 2 m, places are good to 5 cm, and a lane is left 0.3 m beyond
    [(2.2, 12, [10, 22]), (2.2, 6, []), (2.04, 12, []), (1.8, 12, [])],
    ids=["over it", "for a moment", "by an error", "short of it"],
)
def test_who_is_astride_for_a_second_and_comes_back_may_have_changed_lanes(y, states, unknown):
    ys = [0.0] * 10 + [y] * states + [0.0] * 10
    ego = vehicle(7, {k: (k, at) for k, at in enumerate(ys)})
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(2), [ego], step_s=0.1))
    )
    assert not values_of(found, "lane_change").any()
    assert np.flatnonzero(unknown_in(found, "lane_change")).tolist() == unknown


@pytest.mark.parametrize(("heading", "known"), [(0.0, False), (1.4, True)])
def test_who_stands_changes_no_lanes(heading, known):
    """Its place drifts over the mark, as of who waits in a simulation of ways beside each other.

    Who has turned goes there, however slowly along the road.
    """
    places = {k: (20, y) for k, y in enumerate([0, 1.2, 2.4, 2.6, 2.6, 2.6])}
    ego = vehicle(7, places, heading=heading)
    found = words_of(lane_change_signals, indicator_signals)(context_of(recording(lanes(2), [ego])))
    (change,) = np.flatnonzero(possible_in(found, "lane_change"))
    assert unknown_in(found, "lane_change")[change] == (not known)


@pytest.mark.parametrize(("x", "known"), [(98, False), (180, True)])
def test_who_follows_a_way_of_a_lane_that_forks_may_have_changed_to_none(x, known):
    """It forks at 100 m; ego's middle is 2.2 m to the left of where it was 10 m farther on."""
    road = [
        straight(1, 0, 100, successors=(2, 3)),
        straight(2, 100, 300, left_of=3, predecessors=(1,)),
        straight(3, 100, 300, 4, right_of=2, predecessors=(1,)),
    ]
    ego = vehicle(7, {k: (x + 5.0 * k, min(1.1 * k, 4)) for k in range(6)})
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(road, [ego]), ("1", "2"))
    )
    (change,) = np.flatnonzero(possible_in(found, "lane_change"))
    assert unknown_in(found, "lane_change")[change] == (not known)


@pytest.mark.parametrize(("x", "known"), [(76, False), (40, True)])
def test_who_follows_a_way_to_where_two_become_one_may_have_changed_to_none(x, known):
    """They do at 100 m; ego's middle is 2.2 m to the left of where it was 10 m before."""
    road = [
        straight(1, 0, 100, left_of=2, successors=(3,)),
        straight(2, 0, 100, 4, right_of=1, successors=(3,)),
        straight(3, 100, 300, 4, predecessors=(1, 2)),
    ]
    ego = vehicle(7, {k: (x + 5.0 * k, min(1.1 * k, 4)) for k in range(6)})
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(road, [ego]), ("2", "3"))
    )
    (change,) = np.flatnonzero(possible_in(found, "lane_change"))
    assert unknown_in(found, "lane_change")[change] == (not known)


def test_who_goes_straight_on_into_the_only_lane_may_have_changed_to_none():
    """The road comes over to ego's lane from 100 to 110 m; 20 m farther ego is in the only one."""
    road = [
        straight(1, 0, 100, left_of=2, successors=(4,)),
        straight(2, 0, 100, 4, right_of=1, successors=(5,)),
        lanelet(4, [(100, 0), (110, 4)], left_of=5, predecessors=(1,), successors=(3,)),
        straight(5, 100, 110, 4, right_of=4, predecessors=(2,), successors=(3,)),
        straight(3, 110, 300, 4, predecessors=(4, 5)),
    ]
    ego = vehicle(7, {k: (45 + 20.0 * k, 4) for k in range(6)})
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(road, [ego]), ("1", "4", "3"))
    )
    (change,) = np.flatnonzero(possible_in(found, "lane_change"))
    assert ego.states[change].x == 125
    assert unknown_in(found, "lane_change")[change]


@pytest.mark.parametrize(("y", "known"), [(0.0, False), (-2.5, True)])
def test_who_follows_a_way_that_parts_slowly_may_have_changed_to_none(y, known):
    """The ways are 4 m apart 60 m behind the fork, where the road goes on straight.

    Ego is on the one that bends off from the beginning, or comes to it from beside it.
    """
    off = [(100, 0), (160, 4), (300, 4)]
    road = [
        straight(1, 0, 100, successors=(2, 3)),
        lanelet(2, [(100, 0), (160, 0), (300, 0)], left_of=3, predecessors=(1,)),
        lanelet(3, off, right_of=2, predecessors=(1,)),
    ]
    xs = np.arange(90.0, 220.0, 5.0)
    ys = np.interp(xs, *np.array([(0, 0), *off]).T) + np.where(xs < 120, y, 0.0)
    ego = vehicle(7, dict(enumerate(zip(xs, ys, strict=True))))
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(road, [ego]), ("1", "2"))
    )
    (change,) = np.flatnonzero(possible_in(found, "lane_change"))
    assert xs[change] > 115
    assert unknown_in(found, "lane_change")[change] == (not known)


@pytest.mark.parametrize("ends", [False, True])
def test_who_comes_from_behind_on_a_lane_that_ends_does_not_come_into_egos(ends):
    """The left lane goes on at 100 m, or begins there anew. Ego changes to it at 140 m."""
    road = [
        straight(1, 0, 90, left_of=2, successors=(3,)),
        straight(2, 0, 90, 4, right_of=1, successors=() if ends else (4,)),
        straight(3, 90, 100, left_of=None if ends else 4, predecessors=(1,), successors=(5,)),
        straight(5, 100, 400, left_of=6, predecessors=(3,)),
        straight(6, 100, 400, 4, right_of=5, predecessors=() if ends else (4,)),
    ]
    if not ends:
        road.append(straight(4, 90, 100, 4, right_of=3, predecessors=(2,), successors=(6,)))
    ego = vehicle(7, {k: (120 + 5 * k, 0 if k < 4 else 4) for k in range(8)})
    other = vehicle(8, {k: (30 + 12.5 * k, 4) for k in range(5)}, speed=25.0)
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(road, [ego, other]), ("1", "3", "5"))
    )
    (change,) = np.flatnonzero(values_of(found, "lane_change"))
    assert values_of(found, "lane_is_clear")[change] == ends


@pytest.mark.parametrize("to_left", [True, False])
@pytest.mark.parametrize(
    ("goes", "steps", "clear"),
    [("left", 20, "left"), ("right", 20, "right"), ("left", 5, "?"), ("off", 20, "off")],
)
def test_who_comes_from_behind_on_a_lane_that_forks_goes_where_its_track_goes(
    to_left, goes, steps, clear
):
    """The lane forks at 100 m. Ego changes at 140 m at 10 m/s; the other one is at 84 m at 25."""
    road = [
        straight(1, 0, 100, successors=(2, 3, 4)),
        straight(2, 100, 400, left_of=3, predecessors=(1,)),
        straight(3, 100, 400, 4, right_of=2, predecessors=(1,)),
        lanelet(4, [(100, 0), (140, -20), (180, -90)], predecessors=(1,)),
    ]
    start, end = (0.0, 4.0) if to_left else (4.0, 0.0)
    ego = vehicle(7, {k: (120 + 5 * k, start if k < 4 else end) for k in range(20)})
    ways = {
        "left": lambda x: (x, min(max(x - 100, 0) / 4, 4.0)),
        "right": lambda x: (x, 0.0),
        "off": lambda x: (x, 0.0) if x < 100 else (100 + (x - 100) * 0.4, -(x - 100) * 0.9),
    }
    other = vehicle(8, {k: ways[goes](34 + 12.5 * k) for k in range(steps)}, speed=25.0)
    found = recording(road, [ego, other])
    elsewhere = np.zeros((2, 20), dtype=bool)
    elsewhere[1, 6:] = goes == "off"
    signals = words_of(lane_change_signals, indicator_signals)(
        context_of(found, ("1", "2"), elsewhere=elsewhere)
    )
    (change,) = np.flatnonzero(values_of(signals, "lane_change"))
    told = (
        "?"
        if unknown_in(signals, "lane_is_clear")[change]
        else values_of(signals, "lane_is_clear")[change]
    )
    assert told == ("?" if clear == "?" else clear != ("left" if to_left else "right"))


@pytest.mark.parametrize(
    ("ys", "name", "unknown"),
    [
        ((0, 1.5, 2.5, 4), "USA_Peach-1", False),
        # Video is good to 0.3 m: the mark, at y = 2, may be that far from where it is drawn
        ((1.6, 1.75, 2.35, 4), "USA_Peach-1", False),
        ((1.8, 1.75, 2.35, 4), "USA_Peach-1", True),
        ((1.8, 1.75, 2.35, 4), "DEU_Test-1", True),
        ((1.6, 1.75, 2.35, 2.0), "DEU_Test-1", False),
        # Back in its lane before it was clearly in the other one
        ((0, 1.5, 2.31, 0), "DEU_Test-1", False),
        ((4, 2.5, 1.69, 4), "DEU_Test-1", False),
        ((4, 2.5, 1.9, 1.69), "USA_Peach-1", False),
    ],
)
def test_a_mark_that_may_lie_elsewhere_may_not_have_been_crossed(ys, name, unknown):
    ego = vehicle(7, {k: (5 * k, y) for k, y in enumerate(ys)})
    signals = words_of(lane_change_signals, indicator_signals)(
        context_of(replace(recording(lanes(2), [ego]), name=name))
    )
    changed = possible_in(signals, "lane_change")
    assert changed.any()
    assert bool(unknown_in(signals, "lane_change")[changed.argmax()]) == unknown
    assert not unknown_in(signals, "lane_change")[~changed].any()


LEFT = frozenset({"left_indicator"})
INDICATORS = frozenset({"left_indicator", "right_indicator"})


@pytest.mark.parametrize(
    ("lit", "expected"),
    [
        # Up to the state before the change, which is state 2
        ({0: LEFT, 1: LEFT, 2: frozenset(), 3: frozenset()}, "far_indicator"),
        ({0: LEFT, 1: frozenset(), 2: frozenset(), 3: frozenset()}, "no_indicator"),
        ({0: frozenset(), 1: frozenset(), 2: frozenset(), 3: LEFT}, "no_indicator"),
    ],
)
def test_the_indicator_before_a_change_of_lanes_counts(lit, expected):
    body = replace(vehicle(7, CHANGE), lamps=lit, shows=INDICATORS)
    found = changes(body=body)
    assert said(found, "indicator")[2] == expected
    assert not unknown_in(found, "indicator").any()


@pytest.mark.parametrize(
    ("last_lit", "expected"),
    [(2, "no_indicator"), (3, "far_indicator"), (7, "far_indicator")],
)
def test_an_indicator_that_goes_out_while_ego_lies_across_the_mark_counts(last_lit, expected):
    """Of 0.5 m a state to the left the body, 1.8 m wide, reaches the mark at y = 2 in state 3."""
    places = {k: (5 * k, 0.5 * (k - 0.5)) for k in range(9)}
    lit = {k: LEFT if k <= last_lit else frozenset() for k in range(9)}
    body = replace(vehicle(7, places, width=1.8), lamps=lit, shows=INDICATORS)
    found = changes(body=body)
    change = values_of(found, "lane_change").tolist().index(True)
    assert change == 6
    assert said(found, "indicator")[change] == expected
    if expected == "far_indicator":
        # In all states up to the change, as it was lit in all up to the mark
        assert set(said(found, "indicator")[: change + 1]) == {"far_indicator"}
    # A lamp that was lit longer ago announces nothing
    assert said(changes(body=body, signalling_s=0.5), "indicator")[change] == (
        expected if last_lit > change - 2 else "no_indicator"
    )


def test_what_was_lit_for_too_short_before_the_mark_stays_so():
    """Two states before it goes out, it was dark: so it is two states before the change."""
    places = {k: (5 * k, 0.5 * (k - 0.5)) for k in range(9)}
    lit = {k: LEFT if k in (3, 4) else frozenset() for k in range(9)}
    body = replace(vehicle(7, places, width=1.8), lamps=lit, shows=INDICATORS)
    shown = said(changes(body=body), "indicator")
    assert [value == "far_indicator" for value in shown[:7]] == [False] * 5 + [True] * 2


@pytest.mark.parametrize(("y", "unknown"), [(2.4, False), (2.6, True), (4.0, True)])
@pytest.mark.parametrize("lamp", ["none", "left_indicator"])
def test_of_who_jumps_to_another_lane_unlit_nobody_knows(y, unknown, lamp):
    """A state takes 0.5 s here, so that 2.5 m across are 5 m/s."""
    on = frozenset({lamp}) & INDICATORS
    path = {0: (0, 0), 1: (5, 0), 2: (10, y), 3: (15, max(y, 3))}
    body = replace(vehicle(7, path), lamps=dict.fromkeys(range(4), on), shows=INDICATORS)
    found = changes(body=body)
    assert values_of(found, "lane_change").tolist() == [False, False, True, False]
    # Nor whether it did before what takes half a second there
    dark = not on
    assert unknown_in(found, "indicator").tolist() == [dark, dark, unknown and dark, False]


def test_of_who_drives_over_the_mark_unlit_it_is_known_that_it_did_not_announce_it():
    """At 2.4 m/s across, faster than which nobody changes lanes but simulators."""
    path = {k: (5 * k, y) for k, y in enumerate((0, 1.2, 2.4, 3.6))}
    body = replace(vehicle(7, path), lamps=dict.fromkeys(path, frozenset()), shows=INDICATORS)
    found = changes(body=body)
    assert values_of(found, "lane_change").tolist() == [False, False, True, False]
    assert not unknown_in(found, "indicator").any()


@pytest.mark.parametrize(
    ("across", "change", "unknown"),
    [
        # The mark is at y = 2: a jump that ends short of it, one from just behind it, and neither
        ((-1.0, 1.7, 3.0, 3.0, 3.0), 2, True),
        ((0.0, 1.2, 2.7, 5.3, 5.3), 2, True),
        ((-1.0, 1.7, 1.8, 3.0, 3.0), 3, False),
    ],
)
def test_who_jumps_just_before_or_behind_the_mark_jumps_over_it(across, change, unknown):
    path = {k: (5 * k, y) for k, y in enumerate(across)}
    body = replace(vehicle(7, path), lamps=dict.fromkeys(path, frozenset()), shows=INDICATORS)
    found = changes(body=body)
    flags = [k == change for k in path]
    assert values_of(found, "lane_change").tolist() == flags
    assert unknown_in(found, "indicator")[change] == unknown


@pytest.mark.parametrize(("y", "unknown"), [(-2.4, False), (-3.0, True)])
def test_of_who_jumps_off_the_edge_of_the_road_unlit_nobody_knows(y, unknown):
    path = {0: (0, y), 1: (0, y), 2: (5, 0), 3: (10, 0)}
    body = replace(vehicle(7, path), lamps=dict.fromkeys(range(4), frozenset()), shows=INDICATORS)
    found = changes(body=body)
    assert not values_of(found, "lane_change").any()
    assert unknown_in(found, "indicator").tolist() == [False, unknown, unknown, False]


def clear(x, speed, **thresholds):
    """Is the left lane clear in the state of the change, when ego is at 10 m?"""
    other = steady(8, x - 1.0 * speed, 4, speed=speed)
    return bool(values_of(changes(other, **thresholds), "lane_is_clear")[2])


@pytest.mark.parametrize(
    ("x", "speed", "expected"),
    [
        (10, 10, False),  # beside ego
        (30, 10, True),  # ahead of it
        (0, 10, True),  # 6 m behind, but no faster
        # 5 m/s faster: after a second of reaction it needs 25 / (2 x 2) = 6.25 m
        (-6, 15, True),  # 12 m behind, 7 m after the reaction
        (-5, 15, False),  # 11 m behind, 6 m after the reaction
        (3, 15, False),  # 3 m behind: there is no room left after the reaction
    ],
)
def test_who_would_have_to_brake_is_disturbed(x, speed, expected):
    assert clear(x, speed) is expected


@pytest.mark.parametrize(
    ("x", "speed", "unknown"),
    [
        (11, 15, True),  # 3 m of ego are beside it, at 5 m/s more: 0.6 s
        (11, 12, False),  # 1.5 s at 2 m/s more
        (9.9, 15, False),  # ego reaches farther ahead
    ],
)
def test_nobody_knows_whether_one_that_is_about_to_be_past_is_disturbed(x, speed, unknown):
    found = changes(steady(8, x - 1.0 * speed, 4, speed=speed))
    assert not values_of(found, "lane_is_clear")[2]
    assert unknown_in(found, "lane_is_clear").tolist() == [False, False, unknown, False]


@pytest.mark.parametrize(("y", "unknown"), [(4.0, False), (5.9, False), (6.6, True)])
def test_who_only_reaches_over_from_the_lane_beyond_may_not_have_to_brake(y, unknown):
    """Of three lanes ego goes to the middle one, which reaches from y = 2 to 6; cars are 2 m wide.

    Beyond 6 m its middle is in the third.
    """
    found = recording(lanes(3), [vehicle(7, CHANGE), steady(8, 0, y, 10)])
    signals = words_of(lane_change_signals, indicator_signals)(context_of(found))
    assert not values_of(signals, "lane_is_clear")[2]
    assert unknown_in(signals, "lane_is_clear").tolist() == [False, False, unknown, False]


@pytest.mark.parametrize(
    ("others", "named", "unknown"),
    [({"8"}, ("8",), True), ({"9"}, ("9",), False), ({"8", "9"}, ("9",), False)],
)
def test_who_perhaps_has_to_brake_is_not_named_beside_who_surely_has_to(others, named, unknown):
    """8 only reaches over from the lane beyond; 9, 5 m/s faster and 3 m behind, is in the lane."""
    bodies = {"8": steady(8, 0, 6.6, 10), "9": steady(9, 3 - 15, 4, speed=15)}
    there = [body for name, body in bodies.items() if name in others]
    signals = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(3), [vehicle(7, CHANGE), *there]))
    )
    assert signals.whom["lane_is_clear"].tolist() == [(), (), named, ()]
    assert unknown_in(signals, "lane_is_clear").tolist() == [False, False, unknown, False]


@pytest.mark.parametrize(
    ("mps", "error_mps", "unknown"), [(0.0, 0.0, True), (2.0, 0.0, False), (2.0, 1.8, True)]
)
def test_who_stands_and_drifts_across_a_mark_does_not_surely_disturb_others(
    mps, error_mps, unknown
):
    """It drifts by 0.1 m/s, 0.3 m beyond the mark from state 23 on. Below 0.28 m/s it stands."""
    places = {k: (mps * k / 2, 1.18 + 0.05 * k) for k in range(30)}
    ego = vehicle(7, places, speed=mps)
    other = steady(8, places[23][0] - 15 - 5.0 * 23, 4, speed=10, steps=30)
    there = recording(lanes(2), [ego, other])
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(there, ("1",), speed_error_mps=error_mps)
    )
    assert np.flatnonzero(~values_of(found, "lane_is_clear")).tolist() == [23]
    assert unknown_in(found, "lane_is_clear")[23] == unknown


@pytest.mark.parametrize(("moves_off", "unknown"), [(22, True), (10, False)])
def test_who_moves_off_when_it_has_slid_across_a_mark_does_not_surely_disturb_others(
    moves_off, unknown
):
    """As above, but it moves off, at 2 m/s, shortly before it is as far beyond, or long before."""
    places = {k: (max(k - moves_off, 0), 1.18 + 0.05 * k) for k in range(30)}
    ego = vehicle(7, places, speed=2.0)
    other = steady(8, places[23][0] - 15 - 5.0 * 23, 4, speed=10, steps=30)
    found = words_of(lane_change_signals, indicator_signals)(
        context_of(recording(lanes(2), [ego, other]), ("1",))
    )
    assert np.flatnonzero(~values_of(found, "lane_is_clear")).tolist() == [23]
    assert unknown_in(found, "lane_is_clear")[23] == unknown


def test_comfort_and_reaction_are_thresholds():
    assert clear(-5, 15, disturbing_mps2=2.1)
    assert not clear(-6, 15, reaction_s=1.2)


def test_the_lane_is_clear_while_ego_does_not_change():
    other = steady(8, 0, 4)
    assert values_of(changes(other), "lane_is_clear").tolist() == [True, True, False, True]
    assert changes(other).whom["lane_is_clear"].tolist() == [(), (), ("8",), ()]


def test_indicators_by_side_and_where_lamps_are_unknown():
    lamps = {
        0: frozenset(),
        1: frozenset({"left_indicator"}),
        2: frozenset({"left_indicator", "right_indicator"}),
    }
    body = replace(vehicle(7, CHANGE), lamps=lamps)
    found = changes(body=body)
    assert said(found, "indicator").tolist()[:3] == [
        "no_indicator",
        "far_indicator",
        "no_indicator",
    ]
    assert unknown_in(found, "indicator").tolist() == [False, False, False, True]
    left = changes(body=body, side="left")
    assert said(left, "indicator")[1] == "near_indicator"
    assert "indicator" not in changes().world


@pytest.mark.parametrize(("hazards", "unknown"), [(True, False), (False, True)])
def test_both_indicators_are_hazard_lights_or_nobody_knows(hazards, unknown):
    """A file may say of both that they are on, and of the hazard lights that they are off."""
    lit = {"left_indicator", "right_indicator"} | ({"hazard_lights"} if hazards else set())
    shows = frozenset({"left_indicator", "right_indicator", "hazard_lights"})
    lamps = dict.fromkeys(range(4), frozenset(lit))
    found = changes(body=replace(vehicle(7, CHANGE), lamps=lamps, shows=shows))
    assert set(said(found, "indicator").tolist()) == {"no_indicator"}
    assert unknown_in(found, "indicator").tolist() == [unknown] * 4


def test_hazard_lights_of_a_drive_whose_file_contradicts_itself_are_not_known():
    """Both are lit in states 1 and 2, and in state 2 the hazard lights are off."""
    both, shows = {"left_indicator", "right_indicator"}, {"hazard_lights"}
    lit = [{"left_indicator"}, both | shows, both, {"left_indicator"}]
    body = vehicle(7, CHANGE)
    body = replace(body, lamps=dict(enumerate(map(frozenset, lit))), shows=frozenset(both | shows))
    assert unknown_in(changes(body=body), "indicator").tolist() == [False, True, True, False]


@pytest.mark.parametrize(
    ("heading", "length", "known"), [(0.4, 9, False), (0.1, 16, False), (0.1, 9, True)]
)
def test_who_turns_off_swings_over_the_lanes_of_the_road_that_it_comes_to(heading, length, known):
    """A truck turns right into a road of two lanes, its rear in the junction yet.

    Its middle is beyond their mark in state 3, and back in state 5.
    """
    inside = frozenset({"intersection"})
    bend = [(0, -10), (0, -4), (4, 0), (10, 0)]
    road = [
        lanelet(1, [(0, -60), (0, -10)], successors=("2",)),
        lanelet(2, bend, predecessors=("1",), successors=("3",), types=inside),
        straight(3, 10, 90, predecessors=("2",), left_of=4),
        straight(4, 10, 90, 4, right_of=3),
        # Another way leads straight on
        lanelet(5, [(0, -10), (0, 10)], types=inside),
    ]
    north = {k: (0, -50 + 15 * k) for k in range(3)}
    east = {3: (12, 2.5), 4: (14, 2.5), 5: (16, 1), 6: (19, 0), 7: (22, 0)}
    first, then = (
        vehicle(7, places, "truck", length=length, heading=angle)
        for places, angle in ((north, np.pi / 2), (east, heading))
    )
    ego = replace(first, states=first.states | then.states, outlines=first.outlines | then.outlines)
    context = context_of(recording(road, [ego]), ("1", "2", "3"))
    found = words_of(lane_change_signals, indicator_signals)(context)
    across = words_of(ego_signals)(context)
    for signals, word in ((found, "lane_change"), (across, "straddling")):
        assert possible_in(signals, word)[3]
        assert unknown_in(signals, word)[3] == (not known)

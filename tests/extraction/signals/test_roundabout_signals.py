"""Roundabouts: rings of lanelets that are round, who drives into one, and who comes around.

The ring has a radius of 15 m about the origin and four arms; traffic keeps to the right. Ego comes
from the west on y = -4 and gets to the ring at 200°.
"""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from rulec.extraction.signals.conduct import next_lane_signals
from rulec.extraction.signals.map import (
    junction_signals,
    lanes_ahead,
    priority_signals,
    roundabout_signals,
)
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.extraction.tracks.at_junctions.rings import ring_lanelets
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of, steady, told_on_both_sides
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import all_said, unknown_in, values_of
from support.words import words_of

RADIUS_M, STEP_S = 15.0, 0.25
ARMS = (180, 270, 0, 90)
INSIDE = frozenset({"intersection"})


def around(first, last, count=13, radius=RADIUS_M):
    angles = np.radians(np.linspace(first, last, count))
    return radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)


def joining(start, heading, end, leaving):
    """A curve from a place and direction (degrees) to another."""
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    far = np.hypot(*(end - start)) / 2.5
    first, last = (
        far * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        for angle in (heading, leaving)
    )
    t = np.linspace(0, 1, 13)[:, None]
    corners = start, start + first, end - last, end
    shares = (1 - t) ** 3, 3 * (1 - t) ** 2 * t, 3 * (1 - t) * t**2, t**3
    return sum(share * corner for share, corner in zip(shares, corners, strict=True))


def turned(points, angle):
    turn = np.radians(angle)
    return np.asarray(points, dtype=float) @ np.array(
        [(np.cos(turn), np.sin(turn)), (-np.sin(turn), np.cos(turn))]
    )


WAVERS = (200 - 20 / 3, 0.01), (200 - 10 / 3, -0.01), (200, 0.0)
"""Angles at which the ring has points, and how far (m) outside it the entry is there."""

ENTRY = joining((-30, -4), 0, around(200, 200, 1)[0], 290)
EXIT = joining(around(160, 160, 1)[0], 250 - 360 + 360, (-30, 4), 180)


@cache
def roundabout(style, signs=()):
    """``style``: which lanelets are in junctions: none, those at the arms, or all of the ring."""
    at_arms = {"types": INSIDE} if style in ("arms", "all") else {}
    on_ring = {"types": INSIDE} if style == "all" else {}
    lanes = []
    for k, arm in enumerate(ARMS):
        own = {"junction": f"arm {k}"} if style == "arms" else {}
        after = (k + 1) % 4
        way_in, way_out, before, inner, piece = (f"{name}{k}" for name in "abcde")
        lanes += [
            lanelet(
                way_in,
                turned([(-90, -4), (-30, -4)], arm - 180),
                successors=(before,),
                signs=frozenset(signs),
            ),
            lanelet(
                before,
                turned(ENTRY, arm - 180),
                predecessors=(way_in,),
                successors=(piece,),
                **at_arms,
                **own,
            ),
            lanelet(
                inner,
                around(arm - 20, arm + 20),
                predecessors=(f"e{(k - 1) % 4}",),
                successors=(piece,),
                **at_arms,
                **own,
            ),
            lanelet(
                piece,
                around(arm + 20, arm + 70),
                predecessors=(before, inner),
                successors=(f"d{after}", f"f{after}"),
                **on_ring,
            ),
            lanelet(
                f"f{k}",
                turned(EXIT, arm - 180),
                predecessors=(f"e{(k - 1) % 4}",),
                successors=(way_out,),
                **at_arms,
                **own,
            ),
            lanelet(way_out, turned([(-30, 4), (-90, 4)], arm - 180), predecessors=(f"f{k}",)),
        ]
    return tuple(lanes)


RING = {f"{name}{k}" for name in "de" for k in range(4)}


@pytest.mark.parametrize("style", ["none", "arms", "all"])
def test_the_ring_is_found_however_junctions_are_drawn(style):
    found = recording(roundabout(style))
    assert ring_lanelets(found, "right") == RING
    # The other way round nobody drives around it
    assert ring_lanelets(found, "left") == frozenset()
    assert ring_lanelets(mirrored_recording(found), "left") == RING


def block(side_m, corner_m=6.0):
    """The left turns around a block of streets, and the streets that go on."""
    half = side_m / 2
    lanes = []
    for k in range(4):
        way = [(-half + corner_m, -half), (half - corner_m, -half)]
        angles = np.radians(np.linspace(-90, 0, 10))
        centre = half - corner_m
        bend = np.stack(
            (centre + corner_m * np.cos(angles), -centre + corner_m * np.sin(angles)), axis=1
        )
        on = [(half - corner_m, -half), (half + 60, -half)]
        names = (f"s{k}", f"t{k}", f"o{k}")
        after = f"s{(k + 1) % 4}"
        lanes += [
            lanelet(names[0], turned(way, 90 * k), successors=(names[1], names[2])),
            lanelet(names[1], turned(bend, 90 * k), predecessors=(names[0],), successors=(after,)),
            lanelet(names[2], turned(on, 90 * k), predecessors=(names[0],)),
        ]
    return lanes


def test_streets_around_a_block_are_no_roundabout():
    assert ring_lanelets(recording(block(60)), "right") == frozenset()
    assert ring_lanelets(recording(block(70)), "right") == frozenset()


def test_an_entry_may_touch_the_ring_twice_but_a_street_leads_through():
    """Its centre comes inside that of the ring by 1 cm before it ends on it."""
    lanes = list(roundabout("arms"))
    (entry,) = (k for k, lane in enumerate(lanes) if lane.id == "b0")
    onto = np.concatenate([around(angle, angle, 1, RADIUS_M + aside) for angle, aside in WAVERS])
    lanes[entry] = lanelet(
        "b0",
        np.concatenate((ENTRY[:-2], onto)),
        predecessors=("a0",),
        successors=("e0",),
        types=INSIDE,
        junction="arm 0",
    )
    assert ring_lanelets(recording(lanes), "right") == RING
    for y in (0, 10):
        through = lanelet("through", [(-40, y), (40, y)])
        assert not ring_lanelets(recording([*lanes, through]), "right")


@pytest.mark.parametrize("back_m", [0.2, 1.5])
def test_a_ring_whose_line_steps_back_between_its_pieces_is_one(back_m):
    """As lanes inside a bend of OpenDRIVE do; the last piece ends with such a step."""

    def with_steps_back(line):
        points = [line[0]]
        for before, point in pairwise(line):
            ahead = (point - before) / np.hypot(*(point - before))
            # Back a little to the right of the line, which turns left
            aside = np.array([ahead[1], -ahead[0]]) * 0.01
            points += [point, point - back_m * (ahead - aside)]
        return np.array([*points[:-1], points[-2] + back_m * ahead, line[-1]])

    lanes = [
        replace(x, centre=with_steps_back(x.centre)) if x.id in ("e0", "e1") else x
        for x in roundabout("arms")
    ]
    assert ring_lanelets(recording(lanes), "right") == RING


def test_a_map_without_lanes_has_none():
    walk = lanelet(1, [(0, 0), (9, 0)], types=frozenset({"sidewalk"}))
    assert ring_lanelets(recording([walk]), "right") == frozenset()


def test_a_net_names_its_own():
    found = replace(recording(roundabout("arms")), complete=frozenset({"roundabout"}))
    assert ring_lanelets(found, "right") == frozenset()
    marked = [
        replace(x, types=x.types | {"roundabout"}) if x.id[0] == "e" else x
        for x in roundabout("arms")
    ]
    # What leads from one part of it to the next is of it, too
    assert ring_lanelets(replace(recording(marked), complete=found.complete), "right") == RING


TIMES = np.arange(0, 12, STEP_S)
ENTERING = np.concatenate(
    ([(-90.0, -4.0)], ENTRY, around(200, 340), turned(EXIT, -180), turned([(-90, 4)], -180))
)
CIRCLING = np.concatenate((turned([(-90, -4)], -90), turned(ENTRY, -90), around(110, 470, 200)))


# At 6 m/s: the middle is at the entry, 60 m along, at 3 s, and on the ring, 81 m along, at 6.5 s
EGO = 42 + 6 * TIMES
ROUTE = ("a0", "c0", "e0", "d1", "e1", "f2", "b2")


def seen(style, *others, signs=(), ego=EGO, complete=()):
    found = recording(roundabout(style, signs), [along(7, ENTERING, ego), *others])
    return replace(found, step_s=STEP_S, complete=frozenset(complete))


def both_sides(signals_of, found):
    right = signals_of(context_of(found, ROUTE))
    left = signals_of(context_of(mirrored_recording(found), ROUTE, "left"))
    for name in ("enters_roundabout", "roundabout", "conflict_on_roundabout"):
        if name in right.world:
            assert values_of(right, name).tolist() == values_of(left, name).tolist()
    return right


@pytest.mark.parametrize("style", ["none", "arms", "all"])
def test_where_ego_enters_it_and_is_on_it(style):
    found = both_sides(words_of(roundabout_signals), seen(style))
    (entered,) = np.flatnonzero(values_of(found, "enters_roundabout"))
    inside = np.flatnonzero(values_of(found, "roundabout"))
    # With a junction at the arm ego's front is there at 2.7 s; else on the ring at about 5.5 s
    expected = 5.5 if style == "none" else 2.7
    assert TIMES[entered] == pytest.approx(expected, abs=0.5)
    assert TIMES[inside[0]] == pytest.approx(expected + 0.3, abs=0.6)
    assert inside[-1] == len(TIMES) - 1


def test_one_turns_where_one_leaves_it():
    """Onto it and along it the road bends, which is no turn that anybody signals."""
    way = 42 + 9 * TIMES
    context = context_of(seen("arms", ego=way), ROUTE)
    turn = values_of(words_of(junction_signals)(context, frozenset({"turn"})), "turn")
    # The ring begins 60 m and the entry along; ego is on it from 200° to 340°
    leaves = 60 + np.hypot(*np.diff(ENTRY, axis=0).T).sum() + np.radians(140) * RADIUS_M
    turns = turn != "straight_on"
    assert set(turn[turns].tolist()) == {"turn_near"}
    assert way[turns].min() > leaves - context.thresholds.zone_m - 5.0
    assert turns[np.abs(way - leaves).argmin()]


def test_a_drive_that_begins_on_it_does_not_enter_it():
    found = both_sides(words_of(roundabout_signals), seen("arms", ego=EGO[30:]))
    assert not values_of(found, "enters_roundabout").any()
    assert values_of(found, "roundabout").all()


def test_signs_before_the_ring():
    signed = words_of(roundabout_signals)(context_of(seen("arms", signs=("YIELD",)), ROUTE))
    assert values_of(signed, "roundabout_signed").any()
    bare = words_of(roundabout_signals)(context_of(seen("arms"), ROUTE))
    assert not values_of(bare, "roundabout_signed").any()
    assert unknown_in(bare, "roundabout_signed").any()
    net = words_of(roundabout_signals)(context_of(seen("arms", complete=["YIELD"]), ROUTE))
    assert not (values_of(net, "roundabout_signed") | unknown_in(net, "roundabout_signed")).any()


@pytest.mark.parametrize(
    ("signs", "complete", "told"),
    [
        (("YIELD", "ROUNDABOUT"), (), True),
        (("YIELD",), (), None),
        (("YIELD",), ("YIELD",), None),
        ((), ("ROUNDABOUT",), False),
    ],
)
def test_who_has_to_give_way_need_not_see_the_sign_of_the_ring(signs, complete, told):
    """SUMO's nets say who gives way, and never by which signs."""
    found = words_of(roundabout_signals)(
        context_of(seen("arms", signs=signs, complete=complete), ROUTE)
    )
    holds, unknown = (
        values_of(found, "compulsory_roundabout"),
        unknown_in(found, "compulsory_roundabout"),
    )
    assert (holds.any(), unknown.any()) == (told is True, told is None)
    assert values_of(found, "roundabout_signed").any() == bool(signs)


def circling(at_entry_s, mps=6.0):
    """One that has come from the north, and is at 200°, where ego joins the ring, at a time."""
    before = 60 + np.hypot(*np.diff(ENTRY, axis=0).T).sum() + np.radians(90) * RADIUS_M
    way = before + mps * (TIMES - at_entry_s)
    return along(8, CIRCLING, np.clip(way, 0.0, None))


@pytest.mark.parametrize("style", ["arms", "all"])
@pytest.mark.parametrize(
    ("at_s", "conflict"), [(7.3, True), (4.5, False), (11.5, False)], ids=["next", "gone", "far"]
)
def test_who_comes_around(style, at_s, conflict):
    # Ego's front gets to the ring at about 6 s, its rear leaves the place at about 7.5 s
    found = both_sides(words_of(priority_signals), seen(style, circling(at_s)))
    (entered,) = np.flatnonzero(
        values_of(words_of(roundabout_signals)(context_of(seen(style), ROUTE)), "enters_roundabout")
    )
    assert bool(values_of(found, "conflict_on_roundabout")[entered]) == conflict
    assert not unknown_in(found, "conflict_on_roundabout")[entered]


def small_ring(angle, on_map=True):
    """Ego (1, 2) joins a ring (4, 5, 3) on which others come in a direction (degrees)."""
    end, inside = np.array([4.0, -3.0]), {"types": INSIDE, "junction": "x"}
    ahead, mean, away = (np.radians(x) for x in (angle, (angle - 45) / 2, -45))
    start = end - 7 * np.array([np.cos(mean), np.sin(mean)])
    before = start - 60 * np.array([np.cos(ahead), np.sin(ahead)])
    beyond = end + 60 * np.array([np.cos(away), np.sin(away)])
    own = joining((-4, 0), 0, end, -45)
    its = joining(start, angle, end, -45)
    ring = {"types": frozenset({"roundabout"})}
    lanes = [
        straight(1, -90, -4, successors=(2,)),
        lanelet(2, own, predecessors=(1,), successors=(3,), **inside),
        lanelet(3, [end, beyond], predecessors=(2, 5), **ring),
        lanelet(4, [before, start], successors=(5,), **ring),
        lanelet(5, its, predecessors=(4,), successors=(3,), **inside),
    ]
    lines = [
        np.concatenate(([first], line, [beyond]))
        for first, line in (((-90, 0), own), (before, its))
    ]
    # Both at 5 m/s, the other one's middle where the ways join a second after ego's
    joins = [np.hypot(*np.diff(line[:-1], axis=0).T).sum() for line in lines]
    ego, other = (
        along(number, line, np.clip(join + 5 * (TIMES - at_s), 0.0, None))
        for number, line, join, at_s in zip((7, 8), lines, joins, (7.0, 8.0), strict=True)
    )
    shown = lanes if on_map else lanes[:4]
    found = replace(recording(shown, [ego, other]), step_s=STEP_S)
    return replace(found, complete=frozenset({"roundabout"}))


@pytest.mark.parametrize("angle", [-175, -150, -138, -90, -45, -20])
def test_who_comes_around_a_small_ring_comes_from_its_side_whatever_the_angle(angle):
    found = small_ring(angle)
    contexts = (
        context_of(found, ("1", "2", "3")),
        context_of(mirrored_recording(found), ("1", "2", "3"), "left"),
    )
    right, left = (all_said(words_of(priority_signals)(context)) for context in contexts)
    # Ego drives in at 5 s and leaves the place where the ways join at 7.5 s
    entered = round(5.5 / STEP_S)
    assert right["conflict_on_roundabout"][entered]
    assert left["conflict_on_roundabout"][entered]
    assert right["conflict_from_left"][entered]
    assert left["conflict_from_right"][entered]
    assert not right["conflict_from_right"].any()
    assert not right["in_way_of_oncoming"].any()


@pytest.mark.parametrize("angle", [-150, -90])
def test_who_is_at_the_ring_on_no_way_of_the_map_may_come_around(angle):
    signals = words_of(priority_signals)(
        context_of(small_ring(angle, on_map=False), ("1", "2", "3"))
    )
    assert unknown_in(signals, "conflict_on_roundabout")[round(5.5 / STEP_S)]


def test_without_a_junction_on_the_map_nobody_knows():
    found = both_sides(words_of(priority_signals), seen("none", circling(7.3)))
    (entered,) = np.flatnonzero(
        values_of(
            words_of(roundabout_signals)(context_of(seen("none"), ROUTE)), "enters_roundabout"
        )
    )
    assert not values_of(found, "conflict_on_roundabout").any()
    assert unknown_in(found, "conflict_on_roundabout")[entered]


def test_a_straight_road_has_nothing_of_it():
    road = [straight(1, 0, 200)]
    found = recording(road, [vehicle(7, {0: (10, 0), 1: (20, 0)})])
    signals = words_of(roundabout_signals)(context_of(found))
    for name in ("roundabout", "enters_roundabout", "roundabout_signed", "compulsory_roundabout"):
        assert not values_of(signals, name).any()
    assert not unknown_in(
        words_of(priority_signals)(context_of(found)), "conflict_on_roundabout"
    ).any()


@pytest.mark.parametrize(("own", "unknown"), [(False, True), (True, False)])
def test_before_a_ring_drivers_choose_lanes_by_where_they_leave_it(own, unknown):
    """Two lanes lead to it, and go on in it; one waits 30 m before it on the other, or on ego's."""
    bend = joining((-30, 0), 0, around(200, 200, 1, radius=11)[0], 290)
    inside = {"types": INSIDE, "junction": "arm 0"}
    second = {
        "a0": straight("x0", -90, -30, right_of="a0", successors=("y0",)),
        "c0": lanelet(
            "y0", bend, right_of="c0", predecessors=("x0",), successors=("z0",), **inside
        ),
        "e0": lanelet("z0", around(200, 250, radius=11), right_of="e0", predecessors=("y0",)),
    }
    road = [
        replace(lane, left_of=second[lane.id].id) if lane.id in second else lane
        for lane in roundabout("arms")
    ]
    other = vehicle(8, dict.fromkeys(range(len(TIMES)), (-60.0, -4.0 if own else 0.0)))
    bodies = [along(7, ENTERING, EGO - 30), other]
    found = recording([*road, *second.values()], bodies, step_s=STEP_S)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, ROUTE)
    )
    assert unknown_in(signals, "leads_elsewhere")[0, 0] == unknown
    assert not values_of(signals, "leads_elsewhere")[0, 0]


@pytest.mark.parametrize(("metres_away", "free"), [(30, "?"), (190, "True")])
def test_before_a_ring_drivers_sort_themselves_by_lanes(metres_away, free):
    """Nobody sees by which exit they mean to leave it; 10 s of driving are 100 m at 10 m/s."""
    first, before, inner, piece, *others = roundabout("arms")
    near = lanelet("a0", [(-290, -4), (-30, -4)], successors=first.successors, left_of="a")
    beside = [replace(before, left_of="b"), inner, replace(piece, left_of="d")]
    onto = joining((-30, 0), 0, around(200, 200, 1, RADIUS_M - 4)[0], 290)
    ways = {"a": [(-290, 0), (-30, 0)], "b": onto, "d": around(200, 250, 13, RADIUS_M - 4)}
    far = [lanelet(name, way, right_of=f"{name}0") for name, way in ways.items()]
    far = [replace(one, successors=(on,)) for one, on in zip(far, ("b", "d"), strict=False)] + far[
        2:
    ]
    start = -30 - metres_away
    bodies = [steady(7, start, 0), steady(9, start - 90, 0)]
    lanes = recording((near, *beside, *others, *far), bodies, step_s=0.5)
    told = told_on_both_sides(words_of(next_lane_signals), lanes, ("a", "b", "d"))
    assert told["near_lane_is_free"][0] == free

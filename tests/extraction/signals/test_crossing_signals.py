"""Signals of pedestrians at a crossing, and of vehicles that stop for them.

The crossing reaches from x = 58 to 62, over a road of one lane from y = -2 to 2.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import crossing_signals
from support.builders.drive_contexts import along, context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import possible_in, said, unknown_in, values_of
from support.words import words_of

ZEBRA = lanelet(9, [(60, -8), (60, 8)], width=4, types=frozenset({"crosswalk"}))


def use(x, y, along=0.0, across=0.0, **thresholds):
    """How a pedestrian uses the crossing; its speeds along the road and to its left are m/s."""
    places = {k: (x + along * 0.5 * k, y + across * 0.5 * k) for k in range(2)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    ego = steady(7, 20, 0, steps=2)
    context = context_of(recording([*lanes(1), ZEBRA], [ego, walker]), **thresholds)
    return str(said(words_of(crossing_signals)(context), "crossing_use")[0, 0])


@pytest.mark.parametrize(
    ("x", "y", "across", "expected"),
    [
        (60, 0, 0, "on_crossing"),
        (60, 0, 1.5, "on_crossing"),
        (60, 0, -1.5, "on_crossing"),
        (70, 0, 0, "not_crossing"),
        # 1.8 m from the lane, within the 2 m of a kerb
        (60, -4, 0, "waiting_to_cross"),
        (60, -4.5, 0, "not_crossing"),
        # 1.8 m at 1 m/s are 1.8 s, at 4 m/s 0.45 s
        (60, -4, 1, "about_to_cross"),
        (60, -4, 4, "entering_crossing"),
        (60, 4, -1, "about_to_cross"),
        # Away from the lane
        (60, -4, -1, "not_crossing"),
        # 4.8 m at 2 m/s are 2.4 s
        (60, -7, 2, "not_crossing"),
    ],
)
def test_uses_of_the_crossing(x, y, across, expected):
    assert use(x, y, across=across) == expected


@pytest.mark.parametrize(
    ("along", "across", "expected"),
    [(1.4, -0.3, "not_crossing"), (0.3, -1.4, "on_crossing"), (0, 0, "on_crossing")],
)
def test_who_walks_along_the_far_edge_of_the_road_does_not_cross_it(along, across, expected):
    """At the edge of the lane of those who come towards ego, which reaches to y = 6."""
    road = [straight(1, 0, 120), lanelet(2, [(120, 4), (0, 4)])]
    places = {k: (60 + along * 0.5 * k, 5.9 + across * 0.5 * k) for k in range(2)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    found = recording([*road, ZEBRA], [steady(7, 20, 0, steps=2), walker])
    signals = words_of(crossing_signals)(context_of(found, ("1",)))
    assert str(said(signals, "crossing_use")[0, 0]) == expected


@pytest.mark.parametrize(
    ("y", "across", "expected"),
    [
        # 3.8 m from the lane, where another one was beside it up to x = 40
        (-6, 1.5, "not_crossing"),
        (-6, 0, "not_crossing"),
        (-4, 1, "about_to_cross"),
    ],
)
def test_one_comes_to_the_lanes_that_there_are_at_the_crossing(y, across, expected):
    road = [
        straight(1, 0, 40, successors=(2,), right_of=3),
        straight(2, 40, 120, predecessors=(1,)),
        straight(3, 0, 40, -4, left_of=1),
    ]
    places = {k: (60, y + across * 0.5 * k) for k in range(2)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    found = recording([*road, ZEBRA], [steady(7, 20, 0, steps=2), walker])
    signals = words_of(crossing_signals)(context_of(found, ("1", "2")))
    assert str(said(signals, "crossing_use")[0, 0]) == expected


@pytest.mark.parametrize(
    ("y", "across", "expected"),
    [
        # Ego's lane is the right one, up to y = 2, its body reaches to y = 1
        (2.5, 1.5, "not_crossing"),
        (1.9, 1.5, "on_crossing"),
        (2.5, 0, "on_crossing"),
        (2.5, -1.5, "on_crossing"),
        (-1, 1.5, "on_crossing"),
    ],
)
def test_who_has_crossed_egos_lane_is_let_across(y, across, expected):
    places = {k: (60, y + across * 0.5 * k) for k in range(2)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    beside = steady(9, 50, 4, speed=0, steps=2)
    found = recording([*lanes(2), ZEBRA], [steady(7, 20, 0, steps=2), walker, beside])
    signals = words_of(crossing_signals)(context_of(found))
    assert str(said(signals, "crossing_use")[0, 0]) == expected
    # Whoever stands in the next lane stands for it all the same
    assert values_of(signals, "stopped_for_pedestrian")[1, 0]


def test_who_has_crossed_egos_lane_has_done_so_while_it_turns_along_the_road():
    # Across ego's lane, up to y = 2, until 2 s; then along the next one for 3 s, and back
    y = np.interp(np.arange(60) * 0.1, [0, 2, 5, 6], [-0.2, 2.8, 2.8, 1.8])
    places = {k: (60, y[k]) for k in range(60)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    ego = steady(7, 0, 0, speed=2, steps=60, step_s=0.1)
    context = context_of(recording([*lanes(2), ZEBRA], [ego, walker], step_s=0.1))
    uses = said(words_of(crossing_signals)(context), "crossing_use")[0]
    assert uses[5] == "on_crossing"
    assert set(uses[17:28]) == {"not_crossing"}
    # Who stays there for longer than a second may come back
    assert uses[40] == uses[55] == "on_crossing"


@pytest.mark.parametrize(
    ("jumps_to", "expected"),
    [(2.3, "not_crossing"), (2.1, "not_crossing"), (1.9, "on_crossing")],
    ids=["beside ego's lane", "reaches into it", "in it"],
)
def test_who_has_crossed_egos_lane_is_back_in_it_with_its_middle(jumps_to, expected):
    """It walks on at 1.5 m/s, but is seen 0.7 m or so back at 2.1 s; ego's lane ends at y = 2."""
    y = np.interp(np.arange(40) * 0.1, [0, 2, 2.1, 3.1, 3.9], [-0.2, 2.8, jumps_to, 4, 5.2])
    walker = vehicle(8, {k: (60, y[k]) for k in range(40)}, "pedestrian", length=0.4, width=0.4)
    ego = steady(7, 0, 0, speed=2, steps=40, step_s=0.1)
    context = context_of(recording([*lanes(2), ZEBRA], [ego, walker], step_s=0.1))
    uses = said(words_of(crossing_signals)(context), "crossing_use")[0]
    assert uses[5] == "on_crossing"
    assert [uses[k] for k in (19, 21, 25)] == ["not_crossing", expected, "not_crossing"]


@pytest.mark.parametrize(
    ("turn", "expected"), [(-1, "not_crossing"), (0, "on_crossing"), (1, "on_crossing")]
)
def test_who_turns_away_from_those_who_have_crossed_its_lane_is_not_in_their_way(turn, expected):
    """Ego stands askew, its rear 1 m in the left lane; who walks there has left the right one."""
    walker = vehicle(8, {0: (60, 2.5), 1: (60, 3.25)}, "pedestrian", length=0.4, width=0.4)
    ego = vehicle(7, {0: (54, 1.6), 1: (54.5, 1.6 + 0.2 * turn)}, heading=-0.6, speed=1.0)
    found = recording([*lanes(2), ZEBRA], [ego, walker])
    signals = words_of(crossing_signals)(context_of(found))
    assert str(said(signals, "crossing_use")[0, 0]) == expected


def test_walking_along_the_pavement_is_not_coming_to_cross():
    assert use(60, -3, along=1.5, across=0.5) == "not_crossing"
    assert use(60, -3, along=0.5, across=1.5) == "about_to_cross"


def test_the_kerb_reaches_two_metres_beyond_the_crossing():
    # It ends at 62 m; the body reaches 0.2 m back
    assert use(64.1, -4) == "waiting_to_cross"
    assert use(64.3, -4) == "not_crossing"
    assert use(64.3, -4, kerb_m=2.5) == "waiting_to_cross"


def stopped(x, speed=0.0, walks=True):
    """Has a vehicle ahead of ego stopped for a pedestrian on the crossing?"""
    walker = vehicle(8, {0: (60, 0), 1: (60, 0)}, "pedestrian", length=0.4, width=0.4)
    others = [steady(9, x, 0, speed=speed, steps=2)] + ([walker] if walks else [])
    context = context_of(recording([*lanes(1), ZEBRA], [steady(7, 20, 0, steps=2), *others]))
    signals = words_of(crossing_signals)(context)
    assert signals.only["stopped_for_pedestrian"].tolist() == [True, False][: len(others)]
    return bool(values_of(signals, "stopped_for_pedestrian")[0, 0])


def test_who_stands_behind_another_one_may_have_stopped_for_that_one():
    walker = vehicle(8, {0: (60, 0), 1: (60, 0)}, "pedestrian", length=0.4, width=0.4)
    first, second = steady(9, 55, 0, speed=0, steps=2), steady(10, 50, 0, speed=0, steps=2)
    beside = steady(11, 50, 4, speed=0, steps=2)
    bodies = [steady(7, 20, 0, steps=2), first, second, beside, walker]
    signals = words_of(crossing_signals)(context_of(recording([*lanes(2), ZEBRA], bodies)))
    assert possible_in(signals, "stopped_for_pedestrian")[:, 0].tolist() == [
        True,
        True,
        True,
        False,
    ]
    unknown = unknown_in(signals, "stopped_for_pedestrian")[:, 0].tolist()
    assert unknown == [False, True, False, False]


@pytest.mark.parametrize(("y", "stopped_for"), [(-4.0, False), (0.0, True)])
def test_at_a_crossing_with_lights_who_waits_at_the_kerb_waits_for_these(y, stopped_for):
    lit = replace(ZEBRA, types=ZEBRA.types | {"directed"})
    walker = vehicle(8, {0: (60, y), 1: (60, y)}, "pedestrian", length=0.4, width=0.4)
    bodies = [steady(7, 20, 0, steps=2), steady(9, 55, 0, speed=0, steps=2), walker]
    road = recording([*lanes(1), lit], bodies)
    signals = words_of(crossing_signals)(context_of(replace(road, complete=frozenset({"light"}))))
    assert bool(values_of(signals, "stopped_for_pedestrian")[0, 0]) == stopped_for


def test_vehicles_that_stand_before_the_crossing_have_stopped_for_a_pedestrian():
    # The front is 2 m ahead of the middle; the crossing begins at 58 m, 10 m before it at 48
    assert stopped(55)
    assert stopped(50)
    assert stopped(46.1)
    assert not stopped(45.9)
    assert not stopped(57)
    assert not stopped(55, speed=2)
    assert not stopped(50, walks=False)


def over_the_crossing(comes_s, front=30.0, speed=10.0, states=50):
    """Uses by time of one that walks up from the right and is on the lane after so many seconds."""
    step_s = 0.1
    walker = {k: (60, -2.2 - 1.5 * (comes_s - step_s * k)) for k in range(states)}
    people = [
        steady(7, front - 2, 0, speed=speed, steps=states, step_s=step_s),
        vehicle(8, walker, "pedestrian", length=0.4, width=0.4),
    ]
    signals = words_of(crossing_signals)(
        context_of(recording([*lanes(1), ZEBRA], people, step_s=step_s))
    )
    uses = said(signals, "crossing_use")[0]
    return uses, unknown_in(signals, "crossing_use")[0]


def test_who_comes_when_ego_can_still_wait_is_let_across():
    # Ego gets to the crossing at 2.8 s and stops within 100 / 16 = 6.25 m, so until 2.2 s it can
    uses, unknown = over_the_crossing(3.5)
    assert uses[13] == "not_crossing"
    assert uses[16] == "about_to_cross"
    assert uses[30] == "entering_crossing"
    assert not unknown.any()


def test_who_comes_when_ego_cannot_wait_any_more_is_not():
    # About to cross from 2.9 s on: ego has been on the crossing since 2.8 s
    uses, unknown = over_the_crossing(4.9)
    assert set(uses) == {"not_crossing"}
    assert not unknown.any()
    # Who stands on the crossing could wait, as long as the other one is ahead
    uses, _ = over_the_crossing(4.9, front=59.0, speed=0.0)
    assert uses[40] == "about_to_cross"


def test_who_is_about_to_cross_when_first_seen_may_have_come_just_then():
    # At 10 m/s; half a second earlier it would have stopped 0.35 m too far
    uses, unknown = over_the_crossing(1.5, front=58.9, states=5)
    assert set(uses) == {"about_to_cross"}
    assert unknown.all()
    # Who is on it has come up to it for 2 s, since ego was 20 m before
    uses, unknown = over_the_crossing(-0.5, front=58.9, states=5)
    assert set(uses) == {"on_crossing"}
    assert not unknown.any()


def side_road(walker, stops_at=None, more=(), x=12.0, **limits):
    """T, F or ? by step of 0.5 s: ego comes from the south, turns right at (0, 0), drives off.

    ``walker`` are the places of a pedestrian, or only their y if all are at ``x``.
    """
    inside = {"types": frozenset({"intersection"}), "junction": "x"}
    bend = [(8 - 8 * np.cos(a), -8 + 8 * np.sin(a)) for a in np.linspace(0, np.pi / 2, 7)]
    road = [
        lanelet(1, [(0, -60), (0, -8)], successors=("2",)),
        lanelet(2, bend, predecessors=("1",), successors=("3",), **inside),
        lanelet(3, [(8, 0), (80, 0)], predecessors=("2",)),
        lanelet(4, [(0, -8), (0, 40)], **inside),
        *more,
    ]
    line = np.array([(0, -60), *bend, (80, 0)])
    way = 30 + 2.5 * np.arange(40)
    if stops_at is not None:
        way = np.concatenate([np.minimum(way[:20], stops_at), stops_at + 2.5 * np.arange(20)])
    places = {k: at if isinstance(at, tuple) else (x, at) for k, at in enumerate(walker)}
    body = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    found = recording(road, [along(7, line, way), body])
    context = context_of(found, ("1", "2", "3"), **limits)
    found = words_of(crossing_signals)(context, frozenset({"crosses_side_road"}))
    columns = [of(found, "crosses_side_road")[0] for of in (values_of, unknown_in)]
    told = zip(*columns, strict=True)
    return "".join("?" if dark else "FT"[int(flag)] for flag, dark in told)


# Ego is at the junction, 52 m along, in state 9, and at the walker, some 69 m along, in state 15
CROSSES = [-6 + 0.6 * k for k in range(40)]


def test_one_in_the_side_road_while_ego_goes_by():
    assert side_road(CROSSES)[9] == "F"  # it is 4 m beyond ego's lane by then
    assert side_road([y - 3 for y in CROSSES])[9] == "T"
    assert side_road([2 - y for y in CROSSES])[9] == "T"


def test_one_that_comes_to_the_road_while_ego_turns():
    """It stands 4 m from the road until state 10, and goes then at 2 m/s."""
    comes = [-6.0] * 10 + [-6.0 + k for k in range(30)]
    assert side_road(comes)[7:10] == "FTT"
    assert side_road(comes, stops_at=64.0)[9] == "F"
    # It stops at the kerb and is gone before ego comes by, or walks off along the pavement
    assert side_road([-6.0] * 40)[9] == "F"


@pytest.mark.parametrize(("inside", "told"), [(0.4, "?"), (0.9, "?"), (1.5, "T")])
def test_who_stops_at_the_kerb_as_ego_comes_and_stays_may_wait_for_green(inside, told):
    """It gets to its place, the road's edge being at y = -2, as ego turns; ego is gone by 17."""
    comes = [min(-2 + inside, -6.0 + 0.6 * k) for k in range(40)]
    assert side_road(comes)[9] == told
    # Had it waited for ego only, it would have gone on as ego was past
    goes_on = [*comes[:22], *(comes[21] + 0.6 * k for k in range(18))]
    assert side_road(goes_on)[9] == "T"


def test_one_on_a_crossing_that_is_drawn_within_the_junction():
    """The junction ends at x = 8, and the crossing is from 4 to 8 m."""
    crossing = lanelet(9, [(6, -10), (6, 10)], width=4.0, types=frozenset({"crosswalk"}))
    walker = [y - 3 for y in CROSSES]
    assert side_road(walker, more=[crossing], x=5.5)[9] == "T"
    assert side_road(walker, x=5.5)[9] == "F"


def test_one_that_ego_lets_go_while_it_waits_in_the_junction():
    slow = [y - 3 for y in CROSSES]
    assert side_road(slow, stops_at=64.0)[9] == "F"


def test_one_behind_whom_ego_waits_though_it_is_as_far_along_the_road():
    """As at the inner side of a bend; ego's front is 2 m ahead of its middle, 69 m along."""
    slow = [y - 3 for y in CROSSES]
    assert side_road(slow, stops_at=67.2)[9] == "F"
    # Here it drives on though the other one has stopped in its lane
    stands = [min(y, 0.0) for y in slow]
    assert side_road(stands, stops_at=67.2)[9] == "T"


@pytest.mark.parametrize(("y", "told"), [(5.5, "T"), (8.0, "?")])
def test_who_waits_far_off_may_wait_for_others(y, told):
    """It stands on the other half of the road, 3.5 m or 6 m off ego's lane: 2.5 s or 4.3 s."""
    oncoming = lanelet(6, [(80, 6), (8, 6)], width=8)
    walks = [*[y] * 18, *(y - 0.6 * k for k in range(22))]
    assert side_road(walks, more=[oncoming])[9] == told


def test_who_walks_on_a_corner_of_the_pavement_is_not_in_the_road():
    """Ways of those who turn may lie over it, also where ego comes by."""
    corner = lanelet(5, [(8, -2), (16, -2)], width=4, types=frozenset({"sidewalk"}))
    walks = [-4.5 + 0.2 * k for k in range(40)]
    assert side_road(walks)[9] == "T"
    assert side_road(walks, more=[corner])[9] == "F"


CORNER = (3.6, -3.8)
COMES_TO_THE_CORNER = [(3.6, -3.8 - 0.6 * (8 - k)) for k in range(8)]


def at_the_corner(then, entry=True):
    """``side_road`` for one that comes to a corner 3 s before ego, which turns over it.

    A crossing of ego's old road ends there, if ``entry``, and one of its new road.
    """
    drawn = [lanelet(9, [(6, -10), (6, 10)], width=4.0, types=frozenset({"crosswalk"}))]
    if entry:
        drawn.append(lanelet(10, [(-6, -6), (4, -6)], width=4.0, types=frozenset({"crosswalk"})))
    return side_road([*COMES_TO_THE_CORNER, *then], more=drawn)[9]


def test_who_waits_on_a_corner_to_cross_the_road_from_which_ego_comes():
    """It stays at the crossing of that road, where ways of those who turn lie over the corner."""
    stays = [CORNER] * 32
    assert at_the_corner(stays) == "F"
    # With no other crossing drawn it may wait for something else, as it never goes
    assert at_the_corner(stays, entry=False) == "?"
    goes = [(5.0, -3.8 + 0.6 * k) for k in range(16)]
    assert at_the_corner([*stays[:16], *goes], entry=False) == "T"
    crosses = [(3.6 - 0.6 * k, -4.2) for k in range(16)]
    assert at_the_corner([*stays[:16], *crosses]) == "F"


def test_who_waits_on_that_corner_to_cross_the_road_into_which_ego_turns():
    assert at_the_corner([*[CORNER] * 12, *[(5.0, -3.8 + 0.6 * k) for k in range(20)]]) == "T"
    # As one that walks on from the one crossing to the other without waiting
    walks = [(5.0, -3.8 + 0.3 * k) for k in range(32)]
    assert at_the_corner(walks) == "T"


def test_who_gets_to_egos_lane_long_after_ego_may_not_have_to_be_let_across():
    """Ego's front is 2 m before the crossing, its rear off it in 1 s; its lane ends at y = 2."""
    for y, across, known in ((7, -1.4, True), (8, -1.4, False), (8, -1.9, True), (8, 0, False)):
        places = {k: (60, y + 0.1 * across * k) for k in range(2)}
        walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
        ego = steady(7, 54, 0, speed=10.0, steps=2, step_s=0.1)
        road = recording([*lanes(4), ZEBRA], [ego, walker], step_s=0.1)
        found = words_of(crossing_signals)(context_of(road))
        assert said(found, "crossing_use")[0, 0] == "on_crossing"
        assert unknown_in(found, "crossing_use")[0, 0] == (not known)


@pytest.mark.parametrize(("y", "expected"), [(-1.7, "not_crossing"), (-1.5, "on_crossing")])
def test_who_walks_along_the_edge_of_the_road_has_its_middle_hardly_in_it(y, expected):
    """The lane's edge is at y = -2, and nobody's place is told better than to 0.4 m there."""
    assert use(60, y, along=1.4) == expected


def test_one_that_waits_until_ego_is_gone():
    waits = [-3.5] * 18
    assert side_road([*waits, *(-3.5 + 0.6 * k for k in range(22))])[9] == "T"
    # It stands there for something else
    assert side_road([-3.5] * 40)[9] == "F"
    # Its track ends before it goes
    assert side_road([-3.5] * 25)[9] == "?"


def test_of_who_still_stands_there_as_the_drive_ends_nobody_knows():
    """Ego waits in the junction until state 20; ten seconds later would be behind its end."""
    assert side_road([-3.5] * 40, stops_at=64.0)[18:22] == "FF??"


def test_who_stands_at_a_lanes_bound_does_not_step_over_it():
    """Its place drifts by 0.5 m at 0.2 m/s, so that it reaches into the lane once ego is gone."""
    drifts = [-2.4 + 0.1 * k for k in range(6)]
    assert side_road([-2.4] * 20 + drifts + [-1.9] * 14)[9] == "?"
    assert side_road([-2.4] * 20 + [-2.4 + 0.6 * k for k in range(20)])[9] == "T"


@pytest.mark.parametrize(("comes", "goes", "told"), [(0, 30, "?"), (8, 40, "T"), (0, 22, "T")])
def test_who_stood_in_the_side_road_long_before_ego_and_after_may_not_want_to_cross(
    comes, goes, told
):
    """Ego is at the walker from state 15 to state 17; 5 s are 10 states."""
    before = [1.0 - 0.6 * (comes - k) for k in range(comes)]
    after = [1.0 + 0.6 * k for k in range(40 - goes)]
    assert side_road([*before, *[1.0] * (goes - comes), *after])[9] == told


def test_noise_does_not_make_one_at_a_lanes_bound_walk():
    """It stands 0.4 m before the lane. Single places are off by half a metre, one reaches into it.

    In means over a second it moves at 0.5 m/s around these; it never gets away from its place.
    """
    stands = {8: -2.9, 19: -1.9}
    assert side_road([stands.get(k, -2.4) for k in range(40)])[9] == "?"
    # So it is with places that are off for longer, if they may be off by so much
    longer = {7: -2.9, 8: -2.9, 9: -2.9, 19: -1.9, 20: -1.9, 21: -1.9}
    shifted = [longer.get(k, -2.4) for k in range(40)]
    assert side_road(shifted, place_error_m=0.3)[9] == "?"
    walks = [-2.4] * 20 + [-2.4 + 0.6 * k for k in range(20)]
    assert side_road(walks, place_error_m=0.3)[9] == "T"

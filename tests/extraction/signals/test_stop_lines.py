"""Where lines are that have a place on the map, what holds up to them, and rails that cross.

Ego comes along y = 0 on a lanelet that ends at x = 100, before a junction up to 120.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import (
    junction_signals,
    line_signals,
    map_signals,
    priority_signals,
)
from rulec.extraction.signals.map.stop_lines import stop_line
from rulec.recordings.building import build_participant
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import all_said, bounds_of, possible_in, unknown_in, values_of
from support.words import words_of

at_junctions = words_of(junction_signals, line_signals)

INSIDE = frozenset({"intersection"})
RED = Light(0, (("red", 99),))


def road(drawn=None, signs=(), *more):
    line = None if drawn is None else np.array([(drawn, -2.0), (drawn, 2.0)])
    return [
        straight(1, 0, 100, successors=(2,), signs=frozenset(signs), stop_line=line),
        straight(2, 100, 120, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
        straight(3, 120, 300, predecessors=(2,)),
        *more,
    ]


def context(lanes, *xs, y=0.0, route=("1", "2", "3")):
    return context_of(recording(lanes, [vehicle(7, {k: (x, y) for k, x in enumerate(xs)})]), route)


@pytest.mark.parametrize(
    ("drawn", "first"),
    [(95.0, 95.0), (110.0, 110.0), (None, 100.0), (30.0, 100.0)],
    ids=["before the end", "beyond it", "not drawn", "too far away to be this one"],
)
def test_where_a_line_is(drawn, first):
    begins, ends = stop_line(context(road(drawn), 50, 60), 0, 0)
    assert begins == pytest.approx(first, abs=0.05)
    # Whose front is beyond a line by a hand's breadth stands at it
    assert ends == pytest.approx(first + 0.3, abs=0.05)


def test_a_line_is_near_its_lanelets_end_though_the_road_comes_by_again():
    """On a road that goes round a block and passes close by the line, nearer than its own lane."""
    line = np.array([(95.0, 0.4), (95.0, 4.4)])
    first = straight(1, 0, 100, successors=(2,), signs=frozenset({"STOP"}), stop_line=line)
    block = [(100, 0), (200, 0), (200, 60), (-50, 60), (-50, 2.5), (150, 2.5)]
    lanes = [first, lanelet(2, block, 4.0, predecessors=(1,))]
    ego = context(lanes, 50, 60, route=("1", "2"))
    assert stop_line(ego, 0, 0) == pytest.approx((95.0, 95.3), abs=0.05)


@pytest.mark.parametrize(
    ("xs", "crosses"),
    [
        ((88, 92, 94), [False, False, True]),  # fronts at 90, 94 and 96
        ((92, 93.2, 93.2), [False, False, False]),  # 95.2: at the line
        ((92, 93.2, 94), [False, False, True]),
        ((94, 96, 98), [False, False, False]),  # over it from the start
    ],
)
def test_a_line_before_the_lanelet_s_end(xs, crosses):
    found = at_junctions(context(road(95.0, ["STOP"]), *xs))
    assert values_of(found, "crosses_stop_line").tolist() == crosses


@pytest.mark.parametrize("what", [{"signs": frozenset({"STOP"})}, {"lights": (RED,)}])
def test_a_lane_in_two_pieces_has_its_line_at_the_end(what):
    """The map says of both pieces what holds on them; one stops once, before the junction."""
    halves = [
        straight("1a", 0, 60, successors=(1,), **what),
        straight(1, 60, 100, predecessors=("1a",), successors=(2,), **what),
    ]
    _, *further = road()
    found = at_junctions(context([*halves, *further], 55, 62, 95, 101, route=("1a", "1", "2", "3")))
    name = "crosses_stop_line" if "signs" in what else "crosses_light_line"
    assert values_of(found, name).tolist() == [False, False, False, True]
    assert values_of(found, "distance_to_stop_line").tolist() == [43.0, 36.0, 3.0, 0.0]


@pytest.mark.parametrize(
    ("drawn", "xs", "unknown"),
    [
        # From 20 m/s at the lanelet's end down to 1 m/s where another way crosses
        (None, (40, 60, 80, 99, 104, 105, 106, 107, 108, 109), True),
        (100.0, (40, 60, 80, 99, 104, 105, 106, 107, 108, 109), False),
        (None, (20, 40, 60, 80, 100, 120, 140, 160, 180, 200), False),
    ],
    ids=["slow at some of the places", "a line that is drawn", "fast at all of them"],
)
def test_amber_lights_whose_line_may_be_where_ego_could_not_stop(drawn, xs, unknown):
    """Nobody knows whether ego was at the line before or after it had slowed down."""
    before, *further = road(drawn)
    yellow = replace(before, lights=(Light(0, (("yellow", 99),)),))
    across = lanelet(5, [(108, -30), (108, 30)], types=INSIDE, junction="x")
    found = at_junctions(context([yellow, *further, across], *xs))
    (state,) = np.flatnonzero(possible_in(found, "crosses_light_line"))
    assert values_of(found, "light")[state] == "amber_light"
    assert unknown_in(found, "crosses_light_line").tolist() == [
        unknown and k == state for k in range(len(xs))
    ]


@pytest.mark.parametrize(("kind", "length", "width"), [("car", 4, 2), ("truck", 7.1, 2.4)])
def test_who_stands_before_a_line_behind_which_its_way_turns_round(kind, length, width):
    """Its front is at the line; a corner is nearest to a place farther round the bend."""
    back = [(100, 0), (101, 0.8), (101.2, 2), (101, 3.2), (100, 4)]
    lanes = [
        road(None, ["STOP"])[0],
        lanelet(2, back, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
        lanelet(3, [(100, 4), (0, 4)], predecessors=(2,)),
    ]
    places = {k: (front - length / 2, 0) for k, front in enumerate((92, 96, 99.8, 99.9))}
    ego = vehicle(7, places, kind, length=length, width=width)
    stands = context_of(recording(lanes, [ego]), ("1", "2", "3"))
    assert stands.ego_extents.s_max[0, -1] > stop_line(stands, 0, 0)[1]
    assert not values_of(at_junctions(stands), "crosses_stop_line").any()


@pytest.mark.parametrize(("marked", "length"), [(True, 10), (False, 10 + 40)])
def test_a_line_before_a_junction_in_which_no_way_crosses(marked, length):
    """Two roads meet in a corner: the line is not as far away as where others join the road."""
    lanes = road(None, ["STOP"])
    if not marked:
        lanes[1] = replace(lanes[1], types=frozenset(), junction=None)
    begins = 120 + length
    lanes[2] = straight(3, 120, begins, predecessors=(2,), successors=(4,))
    inside = {"types": INSIDE, "junction": "z"}
    lanes += [
        straight(4, begins, begins + 20, predecessors=(3,), successors=(5,), **inside),
        straight(5, begins + 20, 300, predecessors=(4,)),
        lanelet(6, [(begins + 5, -30), (begins + 5, 30)], **inside),
    ]
    ego = context(lanes, 90, 96, 99, 110, route=("1", "2", "3", "4", "5"))
    assert stop_line(ego, 0, 0) == pytest.approx((100.0, 100.3), abs=0.05)


@pytest.mark.parametrize(
    ("xs", "unknown"),
    [
        ((92, 94, 96, 98.2), True),  # its front is at 100.2 m when the drive ends
        ((92, 94, 96, 98), False),
        ((98.2, 98.2, 98.2, 98.2), False),  # it stands
    ],
)
def test_a_drive_that_ends_where_the_line_may_be(xs, unknown):
    """It is somewhere between 100 and 100.3 m."""
    found = at_junctions(context(road(None, ["STOP"]), *xs))
    assert not values_of(found, "crosses_stop_line").any()
    assert unknown_in(found, "crosses_stop_line").tolist() == [False, False, False, unknown]


def test_signs_hold_up_to_the_drawn_line():
    # By where the front was one state before, so that they hold while it crosses
    signs = ["STOP", "GREEN_ARROW", "NO_TURN_ON_RED"]
    found = all_said(words_of(map_signals)(context(road(110.0, signs), 95, 106, 109, 112)))
    for name in ("stop_sign", "turn_on_red_sign", "no_turn_on_red_sign"):
        assert found[name].tolist() == [True, True, True, False], name
    near = all_said(words_of(map_signals)(context(road(95.0, signs), 88, 92, 95, 99)))
    assert near["turn_on_red_sign"].tolist() == [True, True, True, False]


@pytest.mark.parametrize(
    ("drawn", "signs", "name"),
    [(95.0, "STOP", "stop_sign"), (88.0, "YIELD", "give_way_sign"), (110.0, "STOP", "stop_sign")],
)
def test_signs_of_who_goes_first_hold_until_ego_drives_in(drawn, signs, name):
    """However far before the junction the line is: who is to give way does so as it drives in."""
    ego = context(road(drawn, [signs]), 84, 88, 93, 97, 99, 109, 112)
    enters = values_of(at_junctions(ego), "enters_junction")
    (state,) = np.flatnonzero(enters)
    assert ego.ego_extents.s_max[0, state] > 100
    found = values_of(words_of(map_signals)(ego), name)
    assert found[: state + 1].all()
    assert not found[-1]


def test_a_sign_within_a_junction_does_not_hold_up_to_the_next_one():
    """As on the way onto a ring that has a junction for each of its roads."""
    lanes = road(None)
    lanes[1] = replace(lanes[1], signs=frozenset({"YIELD"}))
    lanes[2] = straight(3, 120, 130, predecessors=(2,), successors=(4,))
    lanes += [
        straight(4, 130, 150, predecessors=(3,), successors=(5,), types=INSIDE, junction="z"),
        straight(5, 150, 300, predecessors=(4,)),
    ]
    ego = context(lanes, 105, 117, 121, 124, 130, route=("1", "2", "3", "4", "5"))
    assert values_of(words_of(map_signals)(ego), "give_way_sign").tolist() == [
        True,
        True,
        True,
        False,
        False,
    ]


def test_signs_do_not_hold_up_to_a_junction_far_behind_their_line():
    lanes = road(75.0, ["YIELD"])
    found = values_of(words_of(map_signals)(context(lanes, 60, 72, 76, 90, 102)), "give_way_sign")
    assert found.tolist() == [True, True, True, False, False]


def test_a_sign_of_the_lane_beside_is_not_ego_s():
    lanes = road(None, ["GREEN_ARROW"])
    lanes[0] = replace(lanes[0], left_of="4")
    lanes.append(straight(4, 0, 100, 4, right_of=1))
    assert values_of(words_of(map_signals)(context(lanes, 50, 60)), "turn_on_red_sign").all()
    beside = values_of(words_of(map_signals)(context(lanes, 50, 60, y=4.0)), "turn_on_red_sign")
    assert not beside.any()
    assert "turn_on_red_sign" not in words_of(map_signals)(context(road(), 50, 60)).world


def rails():
    rail = {"types": frozenset({"rail", "restricted_area"})}
    inside = lanelet(
        6, [(110, -10), (110, 10)], predecessors=(5,), successors=(8,), junction="x", **rail
    )
    return [
        lanelet(5, [(110, -90), (110, -10)], successors=(6,), **rail),
        inside,
        lanelet(8, [(110, 10), (110, 90)], predecessors=(6,), **rail),
    ]


@pytest.mark.parametrize(("comes_s", "conflict"), [(3.0, True), (8.0, False), (0.5, False)])
def test_a_train_whose_way_crosses_ego_s(comes_s, conflict):
    # Ego's front is on the rails at 2.3 s, its rear has left them at 3.3 s
    ego = vehicle(7, {k: (83 + 5 * k, 0) for k in range(24)})
    places = {k: (110.0, -10 + 10 * (k / 2 - comes_s)) for k in range(24)}
    train = vehicle(9, places, "train", heading=np.pi / 2, length=12)
    found = recording(road(None, (), *rails()), [ego, train])
    signals = words_of(priority_signals)(context_of(found, ("1", "2", "3")))
    assert bool(values_of(signals, "conflict_with_rail").any()) == conflict
    assert not values_of(signals, "conflict_from_right").any()


def test_the_way_and_the_time_to_a_line():
    # Fronts at 52, 62, 72, 82, 92 and 102 m, 20 m/s
    found = words_of(line_signals)(context(road(95.0, ["STOP"]), 50, 60, 70, 80, 90, 100))
    way, time = values_of(found, "distance_to_stop_line"), values_of(found, "time_to_stop_line")
    assert way.tolist() == pytest.approx([43, 33, 23, 13, 3, 0], abs=0.05)
    assert time.tolist() == pytest.approx([2.15, 1.65, 1.15, 0.65, 0.15, 0], abs=0.01)
    near, far = bounds_of(found, "distance_to_stop_line")
    assert (near[1], far[1]) == (pytest.approx(32.95, abs=0.05), pytest.approx(33.05, abs=0.05))
    # Over it there is none any more
    assert (near[5], far[5], bounds_of(found, "time_to_stop_line")[1][5]) == (0, 0, 0)


def test_one_that_stands_takes_for_ever_to_a_line():
    found = words_of(line_signals)(context(road(95.0, ["STOP"]), 90, 90, 90))
    assert values_of(found, "time_to_stop_line").tolist() == [1000.0] * 3


def test_without_lights_and_stop_signs_nobody_knows_of_lines():
    assert words_of(line_signals)(context(road(), 50, 60)).world.keys() == {"distance_to_junction"}


def test_the_way_to_a_junction():
    found = values_of(
        words_of(line_signals)(context(road(), 50, 96, 99, 118, 125)), "distance_to_junction"
    )
    assert found.tolist() == pytest.approx([48, 2, 0, 0, 1000], abs=0.05)


@pytest.mark.parametrize(
    ("own", "other", "comes_from", "all_stop", "unknown"),
    [
        ("STOP", ["STOP"], 4, True, False),
        ("STOP_4_WAY", [], 4, True, False),
        ("STOP", [], 4, False, False),
        ("STOP", ["YIELD"], 4, False, False),
        ("STOP", [], None, False, True),
    ],
    ids=["both", "a plate says so", "one", "the other gives way", "nobody knows the other"],
)
def test_where_all_have_to_stop(own, other, comes_from, all_stop, unknown):
    before = () if comes_from is None else (comes_from,)
    across = [
        lanelet(4, [(110, -90), (110, -10)], successors=(5,), signs=frozenset(other)),
        lanelet(5, [(110, -10), (110, 10)], predecessors=before, types=INSIDE, junction="x"),
    ]
    lanes = road(None, [own], *(across if comes_from else across[1:]))
    found = at_junctions(context(lanes, 80, 90, 102))
    assert values_of(found, "all_way_stop").tolist() == [all_stop] * 3
    assert unknown_in(found, "all_way_stop").tolist() == [unknown] * 3
    assert values_of(words_of(map_signals)(context(lanes, 80, 90, 99)), "stop_sign").all()


@pytest.mark.parametrize(
    ("fronts", "may"),
    [
        # Lines are at 95.3 for who stands; places are good to 0.5 m here, states a second apart
        ([90, 94, 97, 99], "...."),
        ([90, 95, 95.7, 97], "...."),
        ([90, 95, 95.5, 95.2, 95.6, 95.4, 97], ".?????."),
        ([90, 95.1, 94], ".?."),
        ([90, 94, 95.5], "..?"),
        ([95.5, 97, 99], "?.."),
    ],
    ids=["drives over it", "over it in a moment", "stands on it", "rolls back", "ends", "begins"],
)
def test_places_do_not_tell_whether_one_that_stands_at_a_line_has_crossed_it(fronts, may):
    told = context(road(95.0, ["STOP"]), *[front - 2 for front in fronts])
    told.__dict__["tolerances"] = replace(told.tolerances, place_m=0.5)
    found = at_junctions(told)
    assert "".join(".?"[x] for x in unknown_in(found, "crosses_stop_line").tolist()) == may
    assert not (
        values_of(found, "crosses_stop_line") & unknown_in(found, "crosses_stop_line")
    ).any()


@pytest.mark.parametrize(
    ("places", "known"),
    [
        ([80, 90, 97, 97, 97], "FFFFF"),
        ([80, 90, 100, 100, 100], "FF?FF"),
        ([80, 90, 100, 106], "FFFT"),
        ([80, 90, 100, 100, 100, 106], "FF?FFT"),
    ],
    ids=["stops before the junction", "stops in it", "drives on", "stops, and drives on"],
)
def test_who_stops_in_a_junction_may_have_crossed_a_line_that_is_not_drawn(places, known):
    """Its front is 2.25 m ahead of these places; the other way is 4 m wide, from x = 106 on."""
    crossing = [lanelet(4, [(108, -50), (108, 50)], 4.0, types=INSIDE, junction="x")]
    lanes = road(None, (), *crossing)
    lanes[0] = replace(lanes[0], lights=(RED,))
    t = np.arange(len(places)) * 0.5
    ego = build_participant("7", "car", t, places, 0 * t, step_s=0.5)
    found = words_of(line_signals)(context_of(recording(lanes, [ego]), ("1", "2", "3")))
    crosses, unknown = (of(found, "crosses_light_line") for of in (values_of, unknown_in))
    told = zip(crosses.tolist(), unknown.tolist(), strict=True)
    assert "".join("?" if dark else "FT"[crossed] for crossed, dark in told) == known


def first_known(signals, ego, name):
    """Whether a word of an ego is known in its first state, and nowhere unknown after it."""
    found = signals(ego)
    unknown = unknown_in(found, name).tolist()
    assert not any(unknown[1:])
    return not unknown[0]


@pytest.mark.parametrize(
    ("front", "moves", "known"),
    # It drives 1 m in a step of 0.5 s, and may have braked
    [(100.4, 1.0, False), (101.4, 1.0, False), (103.0, 1.0, True), (101.4, 0.0, True)],
    ids=["just beyond it", "a step beyond it", "farther", "standing there"],
)
def test_where_a_drive_begins_ego_may_just_have_crossed_a_line(front, moves, known):
    xs = [front - 2 + moves * k for k in range(8)]
    lit = [replace(one, lights=(RED,) if one.id == "1" else ()) for one in road(100.0)]
    crossed = first_known(words_of(line_signals), context(lit, *xs), "crosses_light_line")
    signed = context(road(99.9, ["STOP"]), *xs)
    assert crossed == first_known(words_of(junction_signals), signed, "crosses_stop_line") == known
    assert first_known(words_of(junction_signals), signed, "enters_junction") == known


@pytest.mark.parametrize(("front", "known"), [(100.4, False), (103.0, True)])
def test_a_sign_whose_line_ego_may_just_have_crossed_may_hold(front, known):
    ego = context(road(99.9, ["STOP"]), *[front - 2 + k for k in range(8)])
    assert first_known(words_of(map_signals), ego, "stop_sign") == known
    assert not values_of(words_of(map_signals)(ego), "stop_sign").any()


@pytest.mark.parametrize(("resumes", "known"), [(None, True), (8, False)])
def test_after_a_hole_ego_may_have_crossed_a_line_in_it(resumes, known):
    body = replace(vehicle(7, {k: (88.0 + k, 0.0) for k in range(13, 18)}), resumes=resumes)
    ego = context_of(recording(road(99.9, ["STOP"]), [body]), ("1", "2", "3"))
    assert first_known(words_of(junction_signals), ego, "crosses_stop_line") == known


def test_the_light_of_a_line_is_what_it_showed_while_ego_was_not_seen():
    turned = Light(0, (("red", 12), ("green", 99)))
    lit = [replace(one, lights=(turned,) if one.id == "1" else ()) for one in road(100.0)]
    places = {k: (86.0 + k, 0.0) for k in range(13, 18)}
    other = vehicle(8, dict.fromkeys(range(18), (10.0, 0.0)))
    for resumes, light in ((12, "green_light"), (9, "")):
        body = replace(vehicle(7, places), resumes=resumes)
        found = words_of(line_signals)(context_of(recording(lit, [body, other]), ("1", "2", "3")))
        assert unknown_in(found, "crosses_light_line").tolist() == [True] + [False] * 4
        assert values_of(found, "light")[0] == light

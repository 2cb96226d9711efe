"""Signals of the map where ego is."""

import numpy as np
import pytest

from rulec.extraction.signals.map import junction_signals, map_signals
from rulec.extraction.signals.map.map_signals import (
    NO_CROSSING_M,
    NO_LIMIT_KMH,
    distance_to_crossing,
    next_crossing,
)
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import all_said, letters, said, unknown_in, values_of
from support.words import words_of


def context(xs, *others, first=None, second=None):
    lanes = [
        straight(1, 0, 100, successors=(2,), **(first or {})),
        straight(2, 100, 200, predecessors=(1,), **(second or {})),
        *others,
    ]
    body = vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})
    return context_of(recording(lanes, [body]), ("1", "2"))


def zebra(number, x):
    return lanelet(number, [(x, -6), (x, 6)], width=4, types=frozenset({"crosswalk"}))


@pytest.mark.parametrize(
    ("limits", "told"),
    # From 2 m before ego's middle is on the second lane its front is past the sign
    [((30, 50), [30.0, 30.0, 50.0, 50.0]), ((50, 30), [50.0, 50.0, 50.0, 30.0])],
)
def test_one_may_be_faster_from_where_the_front_is_past_a_sign(limits, told):
    first, second = ({"limit_mps": limit / 3.6} for limit in limits)
    found = values_of(
        words_of(map_signals)(context([90, 97, 99, 101], first=first, second=second)), "limit"
    )
    assert found.tolist() == told


def test_the_limit_of_the_lanelet_under_ego():
    found = values_of(
        words_of(map_signals)(context([90, 110], first={"limit_mps": 50 / 3.6})), "limit"
    )
    assert found.tolist() == [50.0, NO_LIMIT_KMH]
    assert "limit" not in words_of(map_signals)(context([90, 110])).world


def test_the_least_speed_of_the_lanelet_under_ego():
    found = all_said(words_of(map_signals)(context([90, 110], first={"minimum_mps": 70 / 3.6})))
    assert found["minimum_limit"].tolist() == [70.0, 0.0]
    assert (
        "minimum_limit"
        not in words_of(map_signals)(context([90, 110], first={"limit_mps": 9.0})).world
    )


def test_the_limit_is_unknown_where_a_sign_may_be_another():
    """Also as soon as ego's front is past it, from where a higher limit would apply."""
    untold = {"untold_signs": frozenset({"MAX_SPEED"})}
    drive = context([90, 97, 99, 110], first={"limit_mps": 50 / 3.6}, second=untold)
    assert unknown_in(words_of(map_signals)(drive), "limit").tolist() == [False, False, True, True]
    nowhere = context([90, 110], first={"limit_mps": 50 / 3.6})
    assert not unknown_in(words_of(map_signals)(nowhere), "limit").any()


def test_the_limit_of_a_junction_is_unknown_where_that_before_it_is():
    road = [
        straight(1, 0, 100, successors=(2,), untold_signs=frozenset({"MAX_SPEED"})),
        straight(
            2, 100, 120, predecessors=(1,), successors=(3,), types=frozenset({"intersection"})
        ),
        straight(3, 120, 220, predecessors=(2,), limit_mps=14.0),
    ]
    body = vehicle(7, {0: (110, 0), 1: (150, 0)})
    found = words_of(map_signals)(context_of(recording(road, [body]), ("1", "2", "3")))
    assert unknown_in(found, "limit").tolist() == [True, False]


@pytest.mark.parametrize(
    ("sign", "told", "word"),
    [
        ("MIN_SPEED", {"minimum_mps": 20.0}, "minimum_limit"),
        (
            "NO_OVERTAKING_START",
            {"signs": frozenset({"NO_OVERTAKING_START"})},
            "no_overtaking_sign",
        ),
    ],
)
def test_what_a_sign_says_is_unknown_where_it_may_hold(sign, told, word):
    drive = context([90, 110], first=told, second={"untold_signs": frozenset({sign})})
    assert unknown_in(words_of(map_signals)(drive), word).tolist() == [False, True]


@pytest.mark.parametrize(
    ("after", "turned", "limit"),
    [(70, 0, 70.0), (50, 0, NO_LIMIT_KMH), (None, 0, NO_LIMIT_KMH), (70, 90, NO_LIMIT_KMH)],
)
def test_a_limit_goes_on_through_a_junction_for_who_goes_straight_on(after, turned, limit):
    road = [
        lanelet(1, [(0, 0), (100, 0)], successors=(2,), limit_mps=70 / 3.6),
        lanelet(
            2,
            [(100, 0), (110, 0), (110 + 10 * (turned == 0), 20 * (turned > 0))],
            predecessors=(1,),
            successors=(3,),
            types=frozenset({"intersection"}),
        ),
    ]
    (x, y), onward = road[1].centre[-1], (0, 100) if turned else (100, 0)
    end = [(x, y), (x + onward[0], y + onward[1])]
    road.append(lanelet(3, end, predecessors=(2,), limit_mps=after and after / 3.6))
    body = vehicle(7, {0: (90, 0), 1: (105, 0)})
    found = values_of(
        words_of(map_signals)(context_of(recording(road, [body]), ("1", "2", "3"))), "limit"
    )
    assert found.tolist() == [70.0, limit]


def test_signs_of_lines_hold_until_the_line_is_crossed():
    signs = {"signs": frozenset({"STOP", "NO_OVERTAKING_START"})}
    # The front is at 92, 101, 105, the middle at 90, 99, 103
    found = all_said(words_of(map_signals)(context([90, 99, 103], first=signs)))
    assert found["stop_sign"].tolist() == [True, True, False]
    assert found["no_overtaking_sign"].tolist() == [True, True, False]
    assert "give_way_sign" not in found
    late = all_said(words_of(map_signals)(context([90, 103, 107], first=signs)))
    assert late["stop_sign"].tolist() == [True, True, False]
    assert late["no_overtaking_sign"].tolist() == [True, False, False]


def test_a_sign_holds_when_one_crosses_its_line_askew():
    """A corner of the body is 0.2 m ahead of the middle of its front, and over the line before it.

    That middle is at 99.9, 100.1, 100.2, 100.4, 100.6 m. Who is beyond by up to 0.3 m stands there.
    """
    middles = [97.9, 98.1, 98.2, 98.4, 98.6]
    lanes = [straight(1, 0, 100, successors=(2,), signs=frozenset({"STOP"}))]
    lanes.append(straight(2, 100, 200, predecessors=(1,)))
    body = vehicle(7, {k: (x, 0) for k, x in enumerate(middles)}, heading=0.6)
    askew = context_of(recording(lanes, [body]), ("1", "2"))
    crosses = values_of(words_of(junction_signals)(askew), "crosses_stop_line")
    assert crosses.tolist() == [False, False, False, True, False]
    assert values_of(words_of(map_signals)(askew), "stop_sign").tolist() == [
        True,
        True,
        True,
        True,
        False,
    ]


def test_the_distance_to_the_next_crossing_is_from_front_to_its_edge():
    found = context([10, 36, 41, 70, 90], zebra(8, 40), zebra(9, 80))
    start, end = next_crossing(found)
    assert start == pytest.approx([38, 38, 38, 78, np.inf], abs=0.05)
    assert end == pytest.approx([42, 42, 42, 82, np.inf], abs=0.05)
    # Fronts are at 12, 38, 43, 72 and 92
    expected = [26, 0, 0, 6, NO_CROSSING_M]
    assert distance_to_crossing(found) == pytest.approx(expected, abs=0.05)
    signals = words_of(map_signals)(found)
    # At this speed ego may be past a crossing of 4 m by the middle of the step
    assert letters(signals, "crossing_zone") == "F???F"
    assert said(signals, "surface").tolist() == [
        "carriageway",
        *(["crossing"] * 2),
        "carriageway",
        "carriageway",
    ]


def test_surfaces_by_ego_s_middle():
    junction = {"types": frozenset({"intersection"})}
    assert values_of(
        words_of(map_signals)(context([97, 101, 103], second=junction)), "surface"
    ).tolist() == [
        "carriageway",
        "junction",
        "junction",
    ]
    bus_lane = {"types": frozenset({"busLane"})}
    assert values_of(
        words_of(map_signals)(context([97, 101], second=bus_lane)), "surface"
    ).tolist() == [
        "carriageway",
        "bus_lane",
    ]
    for_cycles = {"types": frozenset({"bicycleLane"})}
    assert values_of(
        words_of(map_signals)(context([97, 101], second=for_cycles)), "surface"
    ).tolist() == [
        "carriageway",
        "cycle_lane",
    ]


@pytest.mark.parametrize(
    ("kind", "allowed", "last"),
    [
        ("bicycle", "", "?"),
        ("taxi", "", "?"),
        ("car", "", "bus_lane"),
        ("bicycle", "busesOnly", "bus_lane"),
        ("taxi", "busesOnly", "bus_lane"),
        ("bicycle", "cyclesAllowed", "carriageway"),
        ("car", "cyclesAllowed", "bus_lane"),
        ("taxi", "busesOnly cyclesAllowed", "bus_lane"),
        ("taxi", "taxisAllowed", "carriageway"),
        ("car", "taxisAllowed", "bus_lane"),
    ],
)
def test_a_lane_for_buses_that_others_may_use(kind, allowed, last):
    types = frozenset({"busLane", *allowed.split()})
    shared = straight(2, 100, 200, types=types, predecessors=(1,))
    ego = vehicle(7, {0: (97.0, 0.0), 1: (103.0, 0.0)}, kind, length=1.6, width=0.6)
    assert surfaces(ego, [LANES[0], shared]) == ["carriageway", last]


@pytest.mark.parametrize(("front", "word"), [(41.5, "carriageway"), (43, "crossing")])
def test_a_crossing_that_lies_askew_begins_later_at_one_edge_of_a_lane(front, word):
    """It begins at x = 40 at the right edge, and at 42.2 where the cycle is."""
    askew = lanelet(8, [(40, -6), (52, 14)], width=4, types=frozenset({"crosswalk"}))
    ego = vehicle(7, dict.fromkeys(range(4), (front - 0.9, 1.5)), "bicycle", 1.8, 0.6)
    assert surfaces(ego, [*LANES, askew]) == [word] * 4


def surfaces(bodies, lanes, route=("1", "2")):
    found = words_of(map_signals)(context_of(recording(lanes, [bodies]), route))
    unknown = unknown_in(found, "surface").tolist()
    return [
        "?" if u else word
        for word, u in zip(values_of(found, "surface").tolist(), unknown, strict=True)
    ]


LANES = [straight(1, 0, 100, successors=(2,)), straight(2, 100, 200, predecessors=(1,))]


@pytest.mark.parametrize(
    ("x", "word"),
    # The front is 2 m ahead, the crossing begins at 58, places are known to 0.05 m
    [(55.94, "carriageway"), (55.98, "?"), (56.03, "?"), (56.06, "crossing")],
)
def test_who_stands_with_its_nose_at_the_edge_of_a_crossing(x, word):
    places = dict.fromkeys(range(4), (x, 0))
    assert surfaces(vehicle(7, places), [*LANES, zebra(8, 60)]) == [word] * 4


def test_who_drives_onto_a_crossing_is_on_it_once():
    places = {k: (x, 0) for k, x in enumerate((52, 56.01, 60, 64.01, 70))}
    found = surfaces(vehicle(7, places), [*LANES, zebra(8, 60)])
    assert found == ["carriageway", *["crossing"] * 2, *["carriageway"] * 2]


@pytest.mark.parametrize(
    ("heading", "word"), [(0.0, "carriageway"), (0.52, "?"), (np.pi / 2, "carriageway")]
)
def test_a_corner_that_is_turned_onto_a_crossing_decides_nothing(heading, word):
    # Half a metre of a body turned by 30°: the middle of its front is at 57.6, a corner at 58.1
    places = dict.fromkeys(range(4), (55.9, 0))
    assert surfaces(vehicle(7, places, heading=heading), [*LANES, zebra(8, 60)]) == [word] * 4


def test_who_stands_where_a_junction_or_a_bus_lane_begins():
    for kind, word in (("intersection", "junction"), ("busLane", "bus_lane")):
        lanes = [LANES[0], straight(2, 100, 200, predecessors=(1,), types=frozenset({kind}))]
        for x, found in ((99.9, "carriageway"), (99.97, "?"), (100.02, "?"), (100.1, word)):
            assert surfaces(vehicle(7, dict.fromkeys(range(4), (x, 0))), lanes) == [found] * 4


def test_the_zone_before_a_crossing_begins_within_the_tolerance():
    for x, word in ((50.9, False), (50.98, "?"), (51.02, "?"), (51.1, True)):
        found = words_of(map_signals)(context([x] * 3, zebra(8, 60)))
        known = ~unknown_in(found, "crossing_zone")
        assert known.all() == (word != "?")
        assert not known.any() or set(values_of(found, "crossing_zone").tolist()) == {word}


def shoulder_at(y, kind="shoulder"):
    """A lanelet beside the road, 2.9 m wide about ``y``, that the map does not link to it."""
    return lanelet(9, [(0, y), (200, y)], 2.9, types=frozenset({kind}))


@pytest.mark.parametrize(
    ("y", "word"),
    [
        (-1.5, "carriageway"),
        # The road's edge is 2 m aside, the shoulder reaches from there to 4.9 m
        (-2.2, "?"),
        (-3.4, "hard_shoulder"),
        (-4.8, "hard_shoulder"),
        (-5.0, "?"),
        (-6.0, "carriageway"),
        (3.4, "carriageway"),
    ],
)
def test_a_hard_shoulder_that_the_map_does_not_link_to_the_road(y, word):
    body = vehicle(7, {k: (20 + 10 * k, y) for k in range(6)}, speed=20.0)
    assert surfaces(body, [*LANES, shoulder_at(-3.45)]) == [word] * 6
    mirrored = vehicle(7, {k: (20 + 10 * k, -y) for k in range(6)}, speed=20.0)
    assert surfaces(mirrored, [*LANES, shoulder_at(3.45)]) == [word] * 6
    assert surfaces(body, [*LANES, shoulder_at(-3.45, "sidewalk")]) == ["carriageway"] * 6


def test_when_one_drives_onto_such_a_shoulder_and_back():
    """Within two seconds it gets from surely on the road to surely on the shoulder."""
    ys = [0, 0, -1.0, -1.8, -2.2, -3.4, -3.4, -3.4, -2.2, -1.8, -1.0, 0, 0]
    body = vehicle(7, {k: (20 + 10 * k, y) for k, y in enumerate(ys)}, speed=20.0)
    on_it = [y < -2.0 for y in ys]
    words = ["hard_shoulder" if there else "carriageway" for there in on_it]
    assert surfaces(body, [*LANES, shoulder_at(-3.45)]) == words

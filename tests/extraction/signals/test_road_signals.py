"""The road as a whole: towns, classes, directions, kinds of lanes, weather.

Ego drives along y = 0 from the lanelet 1 through 2, from x = 100 to 120, to 3.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import road_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import BROAD_LEFT, BROAD_RIGHT, Weather
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = frozenset({"intersection"})
XS = (50, 110, 150)


def road(first=(), second=(), third=(), *more, limit_kmh=None):
    limit = None if limit_kmh is None else limit_kmh / 3.6
    types = [frozenset(x) for x in (first, second, third)]
    return [
        straight(1, 0, 100, successors=(2,), types=types[0], limit_mps=limit),
        straight(2, 100, 120, predecessors=(1,), successors=(3,), types=types[1]),
        straight(3, 120, 300, predecessors=(2,), types=types[2]),
        *more,
    ]


def against(y=4.0, start=300, end=0, number=5, **more):
    return lanelet(number, [(start, y), (end, y)], **more)


def told(word, lanes, *, complete=(), xs=XS, weather=None, route=("1", "2", "3"), y=0.0):
    """A word's values at three places, "?" where it is unknown; the same in the mirror."""
    ego = vehicle(7, {k: (x, y) for k, x in enumerate(xs)})
    found = replace(
        recording(lanes, [ego]), complete=frozenset(complete), weather=weather or Weather()
    )
    sides = (found, "right"), (mirrored_recording(found), "left")
    values = []
    for one, side in sides:
        signals = words_of(road_signals)(context_of(one, route, side))
        if word not in signals.world:
            values.append(None)
            continue
        column = values_of(signals, word)
        unknown = unknown_in(signals, word)
        values.append(np.where(unknown, "?", column).tolist())
    assert values[0] == values[1]
    return values[0]


ZEBRA = lanelet(9, [(200, -6), (200, 6)], types=frozenset({"crosswalk"}))
MAIN_BESIDE = [straight(11, 0, 100), straight(12, 120, 300)]
SIDE_ROAD = lanelet(8, [(110, -90), (110, 90)], types=INSIDE)


@pytest.mark.parametrize(
    ("lanes", "words"),
    [
        (road(), None),
        # A street with a junction, or with a pedestrian crossing, on a map that calls it urban
        (road(["urban"], ["intersection"], ["urban"]), ["True"] * 3),
        (road(["urban"], ["urban"], ["urban"], ZEBRA), ["True"] * 3),
        # With neither of these maps call motorways urban, too; and a limit may contradict it
        (road(["urban"], ["urban"], ["urban"]), ["?"] * 3),
        (road(["urban"], ["urban"], ["urban"], ZEBRA, limit_kmh=80), ["?"] * 3),
        (road(["urban"], ["urban"], ["urban"], ZEBRA, limit_kmh=70), ["True"] * 3),
        (road(["country"], ["intersection"], ["urban"]), ["False", "False", "True"]),
        (road(["interstate"], ["highway"], ["mainCarriageWay"]), ["False", "False", "?"]),
        (road(["urban", "highway"], [], ["country"]), ["?", "?", "False"]),
    ],
)
def test_built_up_areas(lanes, words):
    assert told("built_up", lanes) == words


@pytest.mark.parametrize(
    ("lanes", "words"),
    [
        (road(), None),
        (road(["interstate"], [], ["country"]), ["motorway", "?", "ordinary_road"]),
        # A road in a town is an ordinary one, as far as it is known to be in one
        (road(["urban"], ["intersection"], ["urban"]), ["ordinary_road"] * 3),
        (road(["urban"], ["urban"], ["urban"]), None),
    ],
)
def test_classes_of_roads(lanes, words):
    assert told("road_class", lanes) == words


def test_a_shoulder_is_of_the_class_of_the_lane_beside_it():
    shoulders = [replace(one, left_of="9") for one in road(["shoulder"], ["shoulder", "country"])]
    beside = straight(9, 0, 300, 4.0, right_of=1, types=frozenset({"interstate"}))
    assert told("road_class", [*shoulders, beside]) == ["motorway", "ordinary_road", "?"]
    assert told("built_up", [*shoulders, beside]) == ["False", "False", "?"]


def test_a_road_of_two_directions():
    lanes = road((), (), (), against())
    assert told("one_way", lanes) == ["False"] * 3
    assert told("divided", lanes) == ["False"] * 3


def test_a_road_that_a_strip_divides():
    # The lanes' edges are at 2 and 4 m, 2 m apart
    lanes = road((), (), (), against(6.0))
    assert told("one_way", lanes) == ["True"] * 3
    assert told("divided", lanes) == ["True"] * 3


@pytest.mark.parametrize("corners", [(), (180,), (130,)])
def test_the_other_direction_is_looked_for_beside_the_middle_wherever_corners_are(corners):
    """It is beside the middle 20 m of the second lanelet, of 120 m."""
    xs = (100, *corners, 220)
    first, _, third = road()
    second = lanelet(2, [(x, 0) for x in xs], predecessors=(1,), successors=(3,))
    third = straight(3, 220, 300, predecessors=(2,))
    lanes = [first, second, third, against(start=170, end=150)]
    assert told("one_way", lanes, xs=(110, 160, 210)) == ["False"] * 3


def test_a_map_without_any_road_of_two_directions_says_nothing():
    assert told("one_way", road()) is None
    assert told("divided", road()) is None
    # A net has all of them
    assert told("one_way", road(), complete=["light"]) == ["True"] * 3
    assert told("divided", road(), complete=["light"]) == ["False"] * 3


def test_where_the_other_direction_ends():
    lanes = road((), (), (), against(end=105))
    # On a map with roads of two directions this one is one-way before; whether another carriageway
    # is farther away is not told
    assert told("one_way", lanes) == ["True", "False", "False"]
    assert told("divided", lanes) == ["?", "False", "False"]


def test_in_a_junction_the_road_that_leads_there_counts():
    inside = road((), INSIDE, (), against(start=100), against(start=300, end=120, number=6))
    assert told("one_way", inside) == ["False"] * 3
    two = [
        *inside[:1],
        straight(2, 100, 110, predecessors=(1,), successors=(7,), types=INSIDE),
        straight(7, 110, 120, predecessors=(2,), successors=(3,), types=INSIDE),
        straight(3, 120, 300, predecessors=(7,)),
        *inside[3:],
    ]
    ego = vehicle(7, {0: (115, 0), 1: (118, 0)})
    signals = words_of(road_signals)(context_of(recording(two, [ego]), ("1", "2", "7", "3")))
    assert values_of(signals, "one_way").tolist() == [False, False]


def test_a_lane_that_crosses_is_not_the_other_direction():
    lanes = road((), INSIDE, (), SIDE_ROAD, against(40.0, number=6))
    assert told("one_way", lanes) is None


def test_lanes_that_lead_on_join_and_leave():
    lanes = road(["accessRamp"], ["mainCarriageWay"], ["exitRamp"], *MAIN_BESIDE)
    lanes[0], lanes[2] = replace(lanes[0], left_of="11"), replace(lanes[2], left_of="12")
    assert told("lane_kind", lanes) == ["entry_lane", "through_lane", "exit_lane"]
    assert told("lane_kind", [*road(["exitRamp"]), *MAIN_BESIDE]) == ["?", "?", "?"]
    assert told("lane_kind", road(["urban"])) is None


@pytest.mark.parametrize("kind", ["accessRamp", "exitRamp"])
def test_a_ramp_that_runs_by_itself_has_no_entry_or_exit_lanes(kind):
    ramp, second = road([kind], [kind], [kind]), straight(11, 0, 100, types=frozenset({kind}))
    assert told("lane_kind", ramp) == ["?", "?", "?"]
    two = [replace(ramp[0], left_of="11"), *ramp[1:], replace(second, right_of="1")]
    assert told("lane_kind", two) == ["?", "?", "?"]


def test_lanes_beyond_a_broad_line():
    """They may leave the road farther ahead (§ 7a(1) StVO): of two beyond it neither is told."""
    main = {"types": frozenset({"mainCarriageWay"})}
    broad = {"types": main["types"] | {BROAD_LEFT}}
    first, second, third = (straight(k, 0, 300, y=4.0 * (k - 1), **main) for k in (1, 2, 3))
    first, third = replace(first, left_of="2"), replace(third, right_of="2")
    second = replace(second, left_of="3", right_of="1", **broad)
    assert told("lane_kind", [first, second, third], route=("1",)) == ["?"] * 3
    assert told("lane_kind", [first, second, third], route=("2",), y=4.0) == ["?"] * 3
    assert told("lane_kind", [first, second, third], route=("3",), y=8.0) == ["through_lane"] * 3
    second = replace(second, **main)
    assert told("lane_kind", [first, second, third], route=("1",)) == ["through_lane"] * 3
    # The line on its other side is where the road's edge is, or more lanes that leave
    second = replace(second, types=main["types"] | {BROAD_RIGHT})
    assert told("lane_kind", [first, second, third], route=("1",)) == ["through_lane"] * 3


def test_lanes_that_are_left_of_each_other_have_no_end():
    main = {"types": frozenset({"mainCarriageWay"})}
    first, second = (straight(k, 0, 300, y=4.0 * (k - 1), **main) for k in (1, 2))
    lanes = [replace(first, left_of="2", right_of="2"), replace(second, left_of="1", right_of="1")]
    assert told("lane_kind", lanes, route=("1",)) == ["through_lane"] * 3


def test_tunnels_are_told_by_maps_that_have_one():
    assert told("tunnel", road((), ["tunnel"])) == ["False", "True", "False"]
    assert told("tunnel", road()) is None


def test_what_the_file_says_of_the_weather():
    assert told("wet", road()) is None
    weather = Weather(wet=True, icy=False, visibility_m=1000.0)
    assert told("wet", road(), weather=weather) == ["True"] * 3
    assert told("icy", road(), weather=weather) == ["False"] * 3
    assert told("visibility", road(), weather=weather) == ["1000.0"] * 3


def test_nobody_directs_a_simulation():
    assert told("told_to_go", road()) is None
    assert told("told_to_go", road(), complete=["officer"]) == ["False"] * 3


def test_a_drive_of_one_state():
    lanes = road(["urban"], ["intersection"], ["urban"], against())
    assert told("built_up", lanes, xs=(50,)) == ["True"]
    assert told("one_way", lanes, xs=(50,)) == ["False"]

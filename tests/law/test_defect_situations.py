"""The situations in which readers of the statutes found books wrong, judged as they should be.

Each is the finding's own, not an example of the book; ``test_defects`` holds the examples.
"""

import pytest

import rulec
from rulec.monitoring.batch.verify import verify
from rulec.trace import Trace
from support.builders.national_books import compiled, read

FAR, NEAR = "far", "near"
PAST = ("behind", "beside", "in_front_of")
MOTORWAY = {"road_class": "motorway", "one_way": True, "divided": True, "marked_lanes": True}
LORRY = {"ego_type": "ego_truck", "ego_mass": 40, "ego_length": 16}
PLATE = {"light": "red_light", "turn": "turn_near", "turn_on_red_sign": True}
STOP = {"stop_sign": True}
ENTERS = {"enters_junction": True, "junction_zone": True, "speed": 20}
TRUCK_AHEAD = {"station": {"v": "behind"}, "lateral": {"v": "same_lane"}, "precedes": {"v": True}}
GREEN_TURN = {
    "light": "green_light",
    "turn": "turn_near",
    "crossing_kind": "directed_crossing",
    "crossing_use": {"p": "on_crossing"},
    "crosses_side_road": {"p": True},
    "station": {"p": "behind"},
    "speed": 15,
}


def past(one, side=FAR, stations=PAST, **throughout):
    """States in which ego goes past one, on that side of it."""
    return [
        {"speed": 50, "station": {one: at}, "lateral": {one: side}, **throughout} for at in stations
    ]


def amber(seconds):
    """Light turns amber so long before ego, at 50 km/h, reaches the line; it drives on."""
    metres = seconds * 50 / 3.6
    near = {"time_to_stop_line": seconds, "distance_to_stop_line": metres, "speed": 50}
    return [
        {**near, "light": "green_light"},
        {**near, "light": "amber_light"},
        {"light": "amber_light", "crosses_light_line": True, "speed": 50},
    ]


def of_each(books, finding, rule, violated, states, objects=None):
    return [(finding, book, rule, violated, states, objects or {}) for book in books.split()]


SITUATIONS = [
    *of_each(
        "de fr gb us-ca in",
        1,
        "stop_sign",
        False,
        [{**STOP, "speed": 0}, {**STOP, "speed": 9, "crosses_stop_line": True}],
    ),
    *of_each(
        "de pl us-ca au-nsw",
        1,
        "red_light",
        False,
        [{**PLATE, "speed": 0}, {**PLATE, "speed": 5, "crosses_light_line": True}],
    ),
    (1, "jp", "stop_at_level_crossings", False, [{}, {"enters_level_crossing": True}], {}),
    *of_each(
        "de fr pl gb ie it us-ca au-nsw",
        2,
        "lateral_gap",
        False,
        past("c", NEAR, PAST[::-1], speed=0, built_up=True, lateral_gap={"c": 0.8}),
        {"c": "cyclist"},
    ),
    *of_each(
        "de fr pl gb ie it us-ca au-nsw",
        2,
        "lateral_gap",
        True,
        past("c", built_up=True, lateral_gap={"c": 0.6}, speed_difference={"c": 30}),
        {"c": "cyclist"},
    ),
    (3, "de", "speed_limit", False, [{"speed": 160, "divided": True}], {}),
    (
        3,
        "de",
        "speed_limit",
        False,
        [{"speed": 110, "marked_lanes": True, "lanes": "two_lanes"}],
        {},
    ),
    (3, "de", "speed_limit", True, [{"speed": 110}], {}),
    (3, "de", "speed_limit_advisory", True, [{"speed": 140, "divided": True}], {}),
    *of_each(
        "de at nl se pl gb ie it us-ca jp in",
        4,
        "speed_limit_by_class",
        True,
        [{**MOTORWAY, **LORRY, "ego_tows": True, "speed": 105}],
    ),
    *of_each("fr au-nsw", 4, "speed_limit_by_class", True, [{**LORRY, "speed": 105}]),
    *of_each(
        "de at nl se pl it jp",
        5,
        "give_way_sign",
        True,
        [{"give_way_sign": True, **ENTERS, "conflict_from_left": True}],
    ),
    *of_each(
        "us-ca jp au-nsw",
        7,
        "give_way_to_pedestrians_when_turning",
        True,
        [{**GREEN_TURN, **ENTERS, "surface": "crossing", "crossing_zone": True}],
        {"p": "pedestrian"},
    ),
    *of_each("fr de gb at nl se pl jp", 8, "amber_light", True, amber(5)),
    *of_each("fr de gb at nl se pl jp", 8, "amber_light", False, amber(1)),
    (
        10,
        "de",
        "rail_priority",
        False,
        [
            {
                **ENTERS,
                "unregulated_junction": True,
                "conflict_with_rail": True,
                "conflict_from_left": True,
            }
        ],
        {},
    ),
    *of_each(
        "vienna fr",
        12,
        "junction_overtaking",
        False,
        past("v", junction_zone=True, on_priority_road=True),
        {"v": "car"},
    ),
    *of_each(
        "vienna fr",
        12,
        "junction_overtaking",
        True,
        past("v", junction_zone=True, give_way_sign=True),
        {"v": "car"},
    ),
    (
        12,
        "vienna",
        "level_crossing_overtaking",
        False,
        past("v", level_crossing_zone=True, two_wheeled={"v": True}),
        {"v": "motorcycle"},
    ),
    *of_each("vienna at", 13, "emergency_vehicles", True, [{"emergency_vehicle_near": True}] * 5),
    (14, "de", "rail_side", False, past("r", tracks_at_kerb=True), {"r": "tram"}),
    *of_each(
        "de fr se nl pl gb at",
        15,
        "bus_leaving",
        False,
        past("b", stations=("beside", "beside"), speed=0, built_up=True, leaving_stop={"b": True}),
        {"b": "bus"},
    ),
    *of_each(
        "de fr se nl pl gb at",
        15,
        "bus_leaving",
        True,
        past("b", speed=30, built_up=True, limit=40, leaving_stop={"b": True}),
        {"b": "bus"},
    ),
    (
        16,
        "us-ca",
        "near_side_passing",
        False,
        past("v", NEAR, built_up=True, lanes="two_lanes"),
        {"v": "car"},
    ),
    (17, "us-ca", "solid_line", False, [{"on_solid_line": True, "single_line": True}], {}),
    (
        18,
        "us-ca",
        "move_over",
        False,
        past("v", hazard_lights={"v": True}),
        {"v": "car"},
    ),
    (
        18,
        "fr",
        "move_over",
        False,
        past("v", parked={"v": True}, stopped={"v": True}, hazard_lights={"v": True}),
        {"v": "car"},
    ),
    (
        19,
        "fr",
        "speed_limit",
        True,
        [{**MOTORWAY, "limit": 110, "raining": True, "speed": 108}],
        {},
    ),
    (19, "fr", "speed_limit", False, [{**MOTORWAY, "wet": True, "speed": 128}], {}),
    (19, "fr", "speed_limit_without_sight", True, [{"visibility": 40, "speed": 55}], {}),
    (
        20,
        "fr",
        "roundabout_priority",
        False,
        [{"enters_roundabout": True, "roundabout_signed": False, "conflict_on_roundabout": True}],
        {},
    ),
    (
        21,
        "fr",
        "following_distance_heavy",
        True,
        [{**TRUCK_AHEAD, **LORRY, "gap": {"v": 35}, "speed_difference": {"v": 0.4}, "speed": 80}]
        * 6,
        {"v": "truck"},
    ),
    (
        22,
        "jp",
        "give_way_to_pedestrians",
        False,
        [
            {
                "surface": "crossing",
                "crossing_kind": "unmarked_crossing",
                "crossing_use": {"p": "waiting_to_cross"},
                "speed": 30,
            }
        ],
        {"p": "pedestrian"},
    ),
    (
        22,
        "jp",
        "keep_near_side",
        False,
        [{"lanes": "two_lanes", "lane": "far_lane", "dense_all_lanes": True, "speed": 10}] * 5,
        {},
    ),
    (
        22,
        "jp",
        "crossing_overtaking",
        False,
        past("v", crossing_zone=True, crossing_kind="directed_crossing", light="green_light"),
        {"v": "car"},
    ),
    (
        23,
        "pl",
        "keep_near_side",
        True,
        [{**MOTORWAY, "lanes": "two_lanes", "lane": "far_lane", "speed": 130}] * 6,
        {},
    ),
    (
        24,
        "gb",
        "following_distance",
        False,
        [{**TRUCK_AHEAD, "icy": True, "speed": 60, "gap": {"v": 310}, "time_headway": {"v": 18.6}}]
        * 4,
        {"v": "car"},
    ),
    *of_each("de at nl fr gb", 25, "closed_lane", True, [{"light": "red_cross", "speed": 50}]),
    *of_each(
        "de at fr nl pl",
        25,
        "stopping_on_motorways",
        True,
        [{**MOTORWAY, "cause_to_brake": False, "speed": 0}] * 3,
    ),
]


@pytest.mark.parametrize(("finding", "book", "rule", "violated", "states", "objects"), SITUATIONS)
def test_a_finding_s_own_situation(finding, book, rule, violated, states, objects):
    sides = ("right_of", "left_of")
    near, far = sides if read(book).rulebook.traffic == "right" else sides[::-1]
    meant = {NEAR: near, FAR: far}
    said = []
    for state in states:
        if "lateral" in state:
            state = {
                **state,
                "lateral": {one: meant.get(at, at) for one, at in state["lateral"].items()},
            }
        said.append(state)
    found = verify(Trace(str(finding), 1.0, objects, tuple(said)), compiled(book)).violations
    assert rule in {one.name for one in read(book).rulebook.rules}
    assert (rule in {one.rule for one in found}) is violated


@pytest.mark.parametrize("book", ["vienna", "de"])
def test_a_duty_that_is_pending_where_a_trace_is_cut_is_open(book):
    states = ({"speed": 30}, {"speed": 30, "emergency_vehicle_near": True})
    verdict = rulec.verify(rulec.Trace("t", 1.0, {}, states, ends="cut"), rulec.compile(book))
    assert "emergency_vehicles" not in {one.rule for one in verdict.violations}
    assert "emergency_vehicles" in {one.rule for one in verdict.open}

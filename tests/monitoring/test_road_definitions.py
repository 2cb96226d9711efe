"""What words of `road` mean by their definitions, where a source tells what they are made of."""

import pytest

from rulec import Trace, compile_rulebook, parse_rulebook, verify
from rulec.extraction.traffic_thresholds import USUAL, thresholds_by
from rulec.monitoring.batch.by_states import verify_by_states

TYPES = {"car", "vehicle", "road_user"}
ABOUT = {"gap", "speed_difference", "oncoming", "goes_across", "parked", "on_shoulder"}
PLACES = {"station": "in_front_of", "lateral": "same_lane", "gap": 1000.0, "speed_difference": 0.0}
ALONE = dict.fromkeys(ABOUT - PLACES.keys(), False) | PLACES
"""A car that is told of: it goes along far behind ego, as fast, in its lane."""


def value(word, cars=(), untold=(), **ego):
    """T, F or ? by arrays; the same by states. ``cars`` have what differs from ``ALONE``."""
    about = "(o)" if word == "holds_up_oncoming" else ""
    head = "hard rule holds (o: car)" if about else "hard rule holds"
    book = compile_rulebook(
        parse_rulebook(f"rulebook b\nuse road\n{head} {{ require always {word}{about} }}")
    )
    objects = {f"c{n}": "car" for n in range(len(cars))}
    state = dict(ego)
    for name, usual in ALONE.items():
        state[name] = {item: own.get(name, usual) for item, own in zip(objects, cars, strict=True)}
    told = frozenset({*state, *TYPES}) - {*untold}
    state = {name: own for name, own in state.items() if name in told}
    trace = Trace("t", 1.0, objects, (state,), ends="complete", told=told)
    verdict = verify(trace, book)
    assert verdict == verify_by_states(trace, book)
    if verdict.not_judged:
        return "never false"
    return "?" if verdict.open else "F" if verdict.violations else "T"


@pytest.mark.parametrize(
    ("speed", "place", "expected"),
    [
        (0.0, "centred", "T"),
        (20.0, "at_near_edge", "T"),
        (20.0, "at_far_edge", "T"),
        (20.0, "centred", "F"),
    ],
)
def test_the_way_is_cleared_at_an_edge_or_standing(speed, place, expected):
    assert value("way_cleared", speed=speed, lane_position=place) == expected


FASTER = {"lateral": "right_of", "speed_difference": -18.0, "gap": 10.0}
"""On the next lane, by 5 m/s: two seconds behind ego."""


@pytest.mark.parametrize(
    ("differs", "expected"),
    [
        ({}, "T"),
        ({"gap": 10.1}, "F"),
        ({"gap": 0.0, "station": "beside", "speed_difference": -5.0}, "T"),
        # Only as fast as vehicles beside each other are
        ({"gap": 0.0, "station": "beside", "speed_difference": -4.9}, "F"),
        ({"lateral": "same_lane"}, "F"),
        ({"oncoming": True}, "F"),
        ({"station": "behind"}, "F"),
    ],
)
def test_who_is_faster_beside_ego_or_soon_overtakes_it(differs, expected):
    cars = [{}, FASTER | differs]
    assert value("being_overtaken", cars, dense_all_lanes=False) == expected
    # In queues on all lanes nobody overtakes; whether there are some may be all that is not told
    assert value("being_overtaken", cars, dense_all_lanes=True) == "F"
    unsaid = value("being_overtaken", cars, dense_all_lanes=False, untold=["dense_all_lanes"])
    assert unsaid == {"T": "?", "F": "F"}[expected]


BEHIND = {"speed_difference": -36.0, "gap": 35.0}
"""In ego's lane, by 10 m/s: with 2 m/s² it needs 25 m, and 10 m to react."""


@pytest.mark.parametrize(
    ("differs", "expected"),
    [
        ({}, "T"),
        ({"gap": 34.9}, "F"),
        # So near that it cannot even react, or not faster
        ({"gap": 5.0}, "F"),
        ({"gap": 0.1, "speed_difference": 0.0}, "T"),
        ({"gap": 0.0, "station": "beside", "speed_difference": 20.0}, "F"),
        ({"gap": 5.0, "lateral": "left_of"}, "T"),
        ({"gap": 5.0, "station": "behind"}, "T"),
        ({"gap": 5.0, "oncoming": True}, "T"),
    ],
)
def test_a_lane_is_clear_if_nobody_has_to_brake(differs, expected):
    cars = [{}, BEHIND | differs]
    for changes, joins in ((True, False), (False, True)):
        assert value("lane_is_clear", cars, lane_change=changes, joins_road=joins) == expected
    assert value("lane_is_clear", cars, lane_change=False, joins_road=False) == "T"


AHEAD = {"station": "behind", "oncoming": True, "speed_difference": 90.0, "gap": 71.2}
"""It comes at 54 km/h, ego at 36: with 2 m/s² it needs 56.25 m, and 15 m to react."""


@pytest.mark.parametrize(
    ("differs", "expected"),
    [
        ({}, "T"),
        ({"gap": 71.3}, "F"),
        ({"lateral": "left_of"}, "F"),
        ({"oncoming": False}, "F"),
        ({"station": "in_front_of"}, "F"),
    ],
)
def test_who_holds_up_oncoming_traffic(differs, expected):
    own = {"speed": 36.0, "straddling": False, "driving_side": "oncoming_side"}
    assert value("holds_up_oncoming", [AHEAD | differs], **own) == expected
    own |= {"straddling": True, "driving_side": "own_side"}
    assert value("holds_up_oncoming", [AHEAD | differs], **own) == expected
    assert value("holds_up_oncoming", [AHEAD | differs], **own | {"straddling": False}) == "F"


def around(*speeds, own=20.0, **differs):
    """Cars at these speeds (km/h), 50 m from ego."""
    return [{"gap": 50.0, "speed_difference": own - speed} | differs for speed in speeds]


@pytest.mark.parametrize(
    ("cars", "speed", "expected"),
    [
        (around(20, 25), 20.0, "TF"),
        (around(20), 20.0, "FF"),
        # Half of them, or ego alone, is not most of them
        (around(20, 25, 40), 20.0, "TF"),
        (around(20, 25, 40, 40), 20.0, "FF"),
        (around(20, 25, own=40.0), 40.0, "FF"),
        (around(8, 9, own=5.0), 5.0, "TT"),
        (around(8, 11, own=5.0), 5.0, "TF"),
        (around(20, 25, gap=101.0), 20.0, "FF"),
        (around(20, 25, oncoming=True), 20.0, "FF"),
        (around(0, 0, parked=True), 20.0, "FF"),
        (around(0, 0, on_shoulder=True), 20.0, "FF"),
        (around(1, 1, goes_across=True), 20.0, "FF"),
    ],
)
def test_traffic_is_slow_if_most_is(cars, speed, expected):
    words = ("congested", "walking_pace_flow")
    assert "".join(value(word, cars, speed=speed) for word in words) == expected


def test_recordings_are_read_with_the_numbers_of_the_definitions():
    """The usual thresholds are those of the vocabulary, and a rulebook sets them in its units."""
    rule = "hard rule any { require always (speed >= 0) }"
    usual = parse_rulebook(f"rulebook b\nuse road\n{rule}").vocabulary
    assert thresholds_by(usual, USUAL) == USUAL
    lines = (
        "set bearable_braking = 3 m/s^2\nset overtaken_by = 10 m/s\nset flow_reach = 0.2 km\n"
        "set congested_below = 20 m/s\nset walking_below = 5 km/h\nset hard_braking = 3 m/s^2"
    )
    own = thresholds_by(parse_rulebook(f"rulebook b\nuse road\n{lines}\n{rule}").vocabulary, USUAL)
    assert (own.disturbing_mps2, own.clearly_faster_kmh, own.flow_reach_m) == (3, 36, 200)
    assert (own.congested_kmh, own.walking_pace_kmh, own.braking_hard_mps2) == (72, 5, 3)

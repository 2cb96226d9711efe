"""Situations of recordings in which violations were told that are none, and true ones beside them.

Each row is what a recording showed, in the words of the books; `docs/looked_up.md` has the cases.
"""

import pytest

from rulec.monitoring.batch.verify import verify
from rulec.trace import Trace
from support.builders.national_books import compiled, read

STOP = {"stop_sign": True}
MARK = {"straddling": True, "indicator": "no_indicator"}


def of_each(books, rule, violated, states, objects=None):
    return [(book, rule, violated, states, objects or {}) for book in books.split()]


WEAVES = {"dense_all_lanes": True, "lane_change": True, "lanes": "two_lanes", "lane": "far_lane"}


def turned_after_the_lamp(seconds):
    """A turn to the far side so long after the lamp went out."""
    lit = {"indicator": "far_indicator", "turn": "turn_far", "speed": 20}
    dark = {**lit, "indicator": "no_indicator"}
    return [lit, *[dark] * (seconds - 1), {**dark, "enters_junction": True}, {"speed": 20}]


def stopped_before(fastest, *before):
    """Ego stands, and is as fast as that just before the line of its stop sign."""
    return [
        {**STOP, "speed": 0},
        *({**STOP, "speed": speed} for speed in (*before, fastest)),
        {**STOP, "speed": fastest, "crosses_stop_line": True},
    ]


SITUATIONS = [
    # 3 m/s^2 from 6 m before the line make 6 m/s, 21.6 km/h, on it; from 7 m 23.3 km/h
    *of_each("de fr gb us-ca in", "stop_sign", False, stopped_before(21.6)),
    *of_each("de fr gb us-ca in", "stop_sign", True, stopped_before(23.3)),
    # A simulated car stood 16 m before the line, and rolled up to it for longer
    *of_each("de fr gb us-ca in", "stop_sign", True, stopped_before(21.3, 5, 3, 6, 12)),
    *of_each("de fr gb us-ca in", "stop_sign", False, stopped_before(17.6, 5, 3, 6, 12)),
    # The lamp is off again when ego turns, as a stalk springs back early
    *of_each("de gb us-ca jp", "indicator_when_turning", False, turned_after_the_lamp(2)),
    *of_each("de gb us-ca jp", "indicator_when_turning", True, turned_after_the_lamp(3)),
    # Three cars one after the other at 100 km/h are no queue
    *of_each("fr gb es", "queue_weaving", False, [{"speed": 100}, {**WEAVES, "speed": 100}]),
    *of_each("fr gb es", "queue_weaving", True, [{"speed": 70}, {**WEAVES, "speed": 70}]),
    # One parked beside a street, of which nobody knows that a system drives it
    *of_each("un-r157 un-r79", "road_of_the_system", False, [{"speed": 0}] * 3),
    *of_each("un-r157 un-r79", "road_of_the_system", True, [{"speed": 0}, {"speed": 20}]),
    # And its box drifts over the mark
    *of_each(
        "un-r79", "indicator_when_changing_lanes", False, [{"speed": 0}, {**MARK, "speed": 0}]
    ),
    *of_each("un-r79", "indicator_when_changing_lanes", True, [{"speed": 9}, {**MARK, "speed": 9}]),
]


@pytest.mark.parametrize(("book", "rule", "violated", "states", "objects"), SITUATIONS)
def test_a_situation_of_a_recording(book, rule, violated, states, objects):
    found = verify(Trace("t", 1.0, objects, tuple(states)), compiled(book)).violations
    assert rule in {one.name for one in read(book).rulebook.rules}
    assert (rule in {one.rule for one in found}) is violated

"""Who in conflict with ego arrived first, together with it, or is in the junction: one at a time.

Rules combine these words with those for the sides, so each has to be true of somebody from a side
because of which the other one is true as well.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import priority_signals
from support.builders.drive_contexts import along, context_of
from support.builders.recordings import lanelet, recording, straight
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
STEP_S = 0.25
TIMES = np.arange(0, 14, STEP_S)
ARC = [(-8 + 10 * np.cos(a), 8 + 10 * np.sin(a)) for a in np.radians(np.linspace(-90, 0, 19))]
ROADS = [
    straight(1, -90, -8, -2, successors=(2,)),
    lanelet(2, ARC, predecessors=(1,), successors=(3,), **INSIDE),
    lanelet(3, [(2, 8), (2, 90)], predecessors=(2,)),
    lanelet(4, [(90, 2), (8, 2)], successors=(5,)),
    lanelet(5, [(8, 2), (-8, 2)], predecessors=(4,), successors=(6,), **INSIDE),
    lanelet(6, [(-8, 2), (-90, 2)], predecessors=(5,)),
    lanelet(7, [(-2, 90), (-2, 8)], successors=(8,)),
    lanelet(8, [(-2, 8), (-2, -8)], predecessors=(7,), successors=(9,), **INSIDE),
    lanelet(9, [(-2, -8), (-2, -90)], predecessors=(8,)),
    lanelet(10, [(2, -90), (2, -8)], successors=(11,)),
    lanelet(11, [(2, -8), (2, 8)], predecessors=(10,), successors=(3,), **INSIDE),
]
WAYS = {
    "ahead": np.array([(90.0, 2.0), (-90.0, 2.0)]),
    "left": np.array([(-2.0, 90.0), (-2.0, -90.0)]),
    "right": np.array([(2.0, -90.0), (2.0, 90.0)]),
}
"""Where the others come from; all drive straight on, into the junction after 82 m."""

EGO = 32 + 5 * TIMES
"""Ego turns left; its middle is in the junction at 4 s, on the others' ways some 2 s later."""

LATER = 82 + 10 * (TIMES - 6.0)
FIRST = np.where(TIMES < 7, np.minimum(80.2 + 1.2 * TIMES, 83), 83 + 10 * (TIMES - 7))
"""One creeps into the junction before ego does, stops for it, and drives on once ego is past."""


def told(**ways):
    """The signals of conflicts with those who come from ahead, from the left or from the right."""
    others = [along(8 + k, WAYS[came], way) for k, (came, way) in enumerate(ways.items())]
    line = np.concatenate(([(-60.0, -2.0)], ARC, [(2.0, 90.0)]))
    found = recording(ROADS, [along(7, line, EGO), *others])
    return words_of(priority_signals)(context_of(replace(found, step_s=STEP_S), ("1", "2", "3")))


def both(found, word, sides=("left", "right")):
    """T, F or ? for somebody from the sides, and a word about those in conflict, at any time."""
    states = []
    for side in sides:
        names = f"conflict_from_{side}", word
        flags = [values_of(found, name) & ~unknown_in(found, name) for name in names]
        maybe = [values_of(found, name) | unknown_in(found, name) for name in names]
        states.append((np.all(flags, axis=0).any(), np.all(maybe, axis=0).any()))
    sure, perhaps = np.any(states, axis=0)
    return "T" if sure else "?" if perhaps else "F"


def test_who_comes_towards_ego_first_did_not_come_first_from_a_side():
    found = told(ahead=FIRST, left=LATER)
    assert values_of(found, "in_way_of_oncoming").any()
    assert values_of(found, "conflict_from_left").any()
    assert both(found, "other_arrived_first") == "F"


def test_who_came_first_from_a_side_is_told_whoever_else_comes():
    assert both(told(left=FIRST), "other_arrived_first") == "T"
    assert both(told(ahead=LATER, left=FIRST), "other_arrived_first") == "T"
    assert both(told(left=FIRST, right=LATER), "other_arrived_first") == "T"
    assert both(told(left=LATER, right=LATER), "other_arrived_first") == "F"


def test_who_comes_towards_ego_is_told_of_where_nobody_comes_from_a_side():
    assert values_of(told(ahead=FIRST), "other_arrived_first").any()
    assert not values_of(told(ahead=LATER), "other_arrived_first").any()


@pytest.mark.parametrize(
    ("ways", "expected"),
    [
        ({"right": "together"}, "T"),
        ({"right": "first"}, "F"),
        ({"right": "first", "left": "together"}, "?"),
        ({"right": "together", "left": "first"}, "T"),
    ],
)
def test_who_arrived_together_may_have_to_be_the_one_from_the_right(ways, expected):
    """Those from the left need not be let go first by those who arrive with them."""
    at = {"first": FIRST, "together": 82 + 10 * (TIMES - 4.6) * np.where(TIMES < 4.6, 1, 0.3)}
    found = told(**{side: at[when] for side, when in ways.items()})
    assert both(found, "arrived_together", ("right",)) == expected

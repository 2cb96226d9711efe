"""Worse recordings of the stored worlds: nobody is accused who is not on the whole one.

Who is not recorded may be there all the same. What a camera's window, a sensor's range or a tracker
leaves out may make a verdict open, never the opposite one.
"""

import os
from functools import cache

import pytest

import rulec
from support.damages.compared import Comparison, said
from support.damages.damaged import DAMAGES, with_drops
from support.worlds.scoring import SIMULATED_WORLD
from support.worlds.stored import SMALL, StoredWorld

LONG = os.environ.get("RULEC_TEST_PROFILE") == "long"
WORLDS = list(SMALL) if LONG else ["grid", "motorway", "priority", "right_before_left"]
MOST_EGOS = None if LONG else 4
"""Of so many vehicles what they see around them is judged, apart from those named here."""

EGOS = {"motorway": ["tailgater.12"], "priority": ["priority_breaker.4"]}

OF_A_FEW = {"range_40", "range_60", "view"}
"""They leave so little to see that all worlds together have just enough."""

DAMAGED = [
    (name, damage)
    for number, damage in enumerate(DAMAGES)
    for name in (WORLDS if LONG or damage in OF_A_FEW else WORLDS[number % 2 :: 2])
]
"""Otherwise each damage is done to every other world, and each world has half of the damages."""

NEW_ID = {"pieces", "pieces_without_holes"}
"""Who gets another id while others pass is another one: that pass is nowhere recorded."""

LEFT_OUT = {"narrow_window", "range_40"}
"""Here some whom a driver did not let go first are not recorded until the driver is past."""


@cache
def whole(name):
    world = StoredWorld(name)
    recording = rulec.read_recording(world.data, world.net)
    rules = rulec.compile_rulebook(world.book)
    return recording, rules, said(recording, rules, assumed=SIMULATED_WORLD)


@cache
def compared(name, damage):
    recording, rules, then = whole(name)
    result = Comparison()
    for worse in DAMAGES[damage](recording, MOST_EGOS, EGOS.get(name, ())):
        now = said(worse.recording, rules, worse.egos or (), worse.was, SIMULATED_WORLD)
        result.add(then, now)
    return result


def lines(of_rules):
    return [line for found in of_rules.values() for line in found]


@pytest.mark.parametrize(("name", "damage"), DAMAGED)
def test_nobody_is_accused_for_what_is_not_recorded(name, damage):
    found = compared(name, damage)
    assert lines(found.false) == []
    assert lines(found.surer) == []


@pytest.mark.parametrize(
    ("name", "damage"), [pair for pair in DAMAGED if pair[1] not in NEW_ID | LEFT_OUT]
)
def test_nobody_is_acquitted_for_what_is_not_recorded(name, damage):
    assert lines(compared(name, damage).acquitted) == []


@pytest.mark.parametrize("name", WORLDS)
@pytest.mark.parametrize("share", [pytest.param(0.05, marks=pytest.mark.long), 0.2])
def test_a_state_that_is_missing_here_and_there_matters_to_no_verdict(name, share):
    """Who is away for no longer than a second was there, on the way between."""
    recording, rules, _ = whole(name)
    # Neither says that all traffic is recorded
    then, now = (
        said(with_drops(recording, part).recording, rules, assumed=SIMULATED_WORLD)
        for part in (0.0, share)
    )
    every, found = Comparison(), Comparison()
    every.add(then, then)
    found.add(then, now)
    assert lines(every.found)
    assert found.found == every.found
    assert [*lines(found.false), *lines(found.surer), *lines(found.elsewhere)] == []


@pytest.mark.parametrize("damage", DAMAGES)
def test_something_is_found(damage):
    """Where nothing is left to see, nothing can be wrong."""
    worlds = [name for name, own in DAMAGED if own == damage]
    assert sum(len(lines(compared(name, damage).agreed)) for name in worlds) >= 5

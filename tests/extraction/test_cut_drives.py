"""Where a drive begins or ends amid something, what that was or will be is unknown."""

from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec import UNKNOWN, build_lanelet, build_participant, build_recording
from rulec.extraction.drives import Drives
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.recording import ObservedLight
from support.rewriting.cut_short import cut

STEP_S = 0.5
TOWN = {"types": ["urban"], "limit_mps": 14.0}


def crossroads(*more, **of_entry):
    """East and north over a junction, straight on or to the left, from the east into the north."""
    bend = [(10 * np.sin(a), 10 - 10 * np.cos(a)) for a in np.linspace(0, np.pi / 2, 9)]
    return [
        build_lanelet("in", [(-100, 0), (0, 0)], successors=["ac", "left"], **TOWN, **of_entry),
        build_lanelet("ac", [(0, 0), (20, 0)], successors=["out"], junction="j", **TOWN),
        build_lanelet("left", bend, successors=["to"], junction="j", **TOWN),
        build_lanelet("out", [(20, 0), (120, 0)], **TOWN),
        build_lanelet("fr", [(10, -80), (10, -10)], successors=["ov"], **TOWN),
        build_lanelet("ov", [(10, -10), (10, 10)], successors=["to"], junction="j", **TOWN),
        build_lanelet("to", [(10, 10), (10, 90)], **TOWN),
        *more,
    ]


def driver(name, x, y, heading=0.0, kind="car", **more):
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    t = STEP_S * np.arange(len(x))
    heading = np.broadcast_to(heading, len(x))
    return build_participant(name, kind, t, x, y, step_s=STEP_S, heading=heading, **more)


def world(bodies, lanes=None, **more):
    lanes = lanes or crossroads()
    return build_recording(lanes, bodies, step_s=STEP_S, side="right", ego="ego", **more)


def words(recording, name, about=None):
    """A word's values by step of the recording, in all drives of ego."""
    found = {}
    for drive in Drives(mended(recording), "right").of("ego"):
        for number, state in enumerate(drive.trace.states):
            value = state[name]
            found[round(drive.start_s / STEP_S) + number] = value[about] if about else value
    return found


PLACES = ((7, 0), (7, 2), (9, 2), (11, 4))
ENTERED = [
    pytest.param(*place, book, marks=[] if (number + nth) % 2 else pytest.mark.long)
    for nth, book in enumerate(("de", "gb", "us-ca", "jp", "fr"))
    for number, place in enumerate(PLACES)
]
"""Every place and every book, of which half meet without `--long`."""


@pytest.mark.parametrize(("x_end", "y_end", "book"), ENTERED)
def test_who_enters_in_the_last_state_is_judged(x_end, y_end, book):
    back = STEP_S * np.arange(9, -1, -1)
    ego = driver("ego", x_end - 13 * back, 0)
    other = driver("other", 10, y_end - 10 * back, np.pi / 2)
    found = world([ego, other])
    assert len(list(rulec.verify_recording(found, book).answers())) == 2
    live = rulec.TrafficWorld(found, "ego", now_s=4.0)
    assert len(rulec.score([[(x_end, 0, 0, 13)]], live, book, after=live.past)) == 1


def on_the_bend(places):
    """x, y and heading of who turns left, by the way (m) from the junction's beginning."""
    turned = (places / 10).clip(0, np.pi / 2)
    beyond = (places - 5 * np.pi).clip(0)
    x = np.where(places < 0, places, 10 * np.sin(turned))
    return x, 10 - 10 * np.cos(turned) + beyond, turned


@pytest.mark.parametrize("kind", ["constructionZone", "bicycle", "car"])
@pytest.mark.parametrize("y", [1.6, 2.4, -1.6])
def test_what_stands_beside_a_turn_has_one_outline_for_all_states(kind, y):
    """Cones and barriers of nuScenes do."""
    ego = driver("ego", *on_the_bend(-40 + 4 * np.arange(22)))
    still = replace(driver("still", [-3.0], [y], kind=kind, length=1.7, width=0.5), standing=True)
    found = world([ego, still])
    assert all(words(found, "enters_junction")[k] in {True, False} for k in range(22))
    # For an hour or for a second: it is the same thing
    again = driver("still", [-3.0] * 22, [y] * 22, kind=kind, length=1.7, width=0.5)
    assert words(world([ego, again]), "enters_junction") == words(found, "enters_junction")


def turning_round():
    """From (20, -1.75) on to x = 50, and back on the other lane, in 2 m steps."""
    way = 2.0 * np.arange(45) - 30
    turned = (way / 3.5).clip(0, np.pi)
    x = 50 + np.where(way < 0, way, 3.5 * np.sin(turned)) - (way - 3.5 * np.pi).clip(0)
    return driver("ego", x, -1.75 + 3.5 * (1 - np.cos(turned)), turned)


def test_who_is_seen_on_a_part_of_its_way_round_may_be_turning_round():
    lanes = [
        build_lanelet("there", [(-100, -1.75), (200, -1.75)], **TOWN),
        build_lanelet("back", [(200, 5.25), (-100, 5.25)], **TOWN),
    ]
    whole = world([turning_round()], lanes)
    told = words(whole, "u_turn")
    turns = [step for step, value in told.items() if value is True]
    assert len(turns) >= 3
    for first, last in ((0, turns[1]), (turns[1], 44), (turns[1], turns[-1])):
        part = words(cut(whole, first, last), "u_turn")
        seen = [step for step in turns if step in part]
        assert seen
        assert {part[step] for step in seen} <= {UNKNOWN, True}
    # And before it turns nothing is in doubt
    assert {words(cut(whole, 0, turns[0] - 2), "u_turn")[k] for k in range(turns[0] - 2)} == {False}


def test_whom_ego_lets_across_is_unknown_where_its_way_is():
    ego = driver("ego", *on_the_bend(-40 + 4 * np.arange(22)))
    walker = driver("p", 14.0 - 0.27 * np.arange(22), 9.6, np.pi, kind="pedestrian")
    whole = world([ego, walker])
    (enters,) = [step for step, value in words(whole, "enters_junction").items() if value]
    assert words(whole, "crosses_side_road", "p")[enters] is True
    part = cut(whole, 0, enters)
    assert words(part, "turn")[enters] is UNKNOWN
    assert words(part, "crosses_side_road", "p")[enters] is UNKNOWN


def test_the_light_that_ego_passed_before_it_was_seen_is_unknown():
    """No line is drawn: it is between the lane's end and where ways meet."""
    shown = {k: "green" if k < 10 else "red" for k in range(40)}
    lanes = crossroads(lights=[ObservedLight(shown)])
    x = -40 + 4.0 * np.arange(24)
    whole = world([driver("ego", x, 0)], lanes, complete={"light"})
    crossed = [step for step, value in words(whole, "crosses_light_line").items() if value is True]
    (at,) = crossed
    assert words(whole, "light")[at] is UNKNOWN
    part = cut(whole, at - 1, 23)
    assert words(part, "crosses_light_line")[at] in {True, UNKNOWN}
    assert words(part, "light")[at] is UNKNOWN


def test_who_comes_is_unknown_where_the_drive_ends_as_ego_gets_to_the_junction():
    """Its front is in it, and its middle in none of its ways yet."""
    ego = driver("ego", -40 + 4.0 * np.arange(24), 0)
    other = driver("other", 10, -68 + 5.0 * np.arange(24), np.pi / 2)
    whole = world([ego, other], complete={"arrivals"})
    told, enters = words(whole, "conflict_from_right"), words(whole, "enters_junction")
    (at,) = [step for step, value in enters.items() if value is True]
    assert told[at] is True
    part = cut(whole, 0, at)
    assert words(part, "enters_junction")[at] is True
    assert words(part, "conflict_from_right")[at] is UNKNOWN

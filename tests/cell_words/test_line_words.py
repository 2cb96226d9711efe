"""Lines at which ego may have to stop, in cells: no way through them has crossed one unsaid."""

from dataclasses import replace

import numpy as np
import pytest

from rulec import compile_rulebook, find_maneuvers
from rulec.recordings.recording import Light
from rulec.scenario import Choice
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.vocabulary.partial_values import UNKNOWN, OneOf
from support.builders.recordings import lanelet, recording, straight, vehicle

RED = Light(0, (("red", 1000),))
TURNS_GREEN = Light(-100, (("red", 103), ("green", 1000)))
"""In steps of 0.5 s: green from 1.5 s on."""


@pytest.fixture(scope="module")
def german():
    return compile_rulebook("de")


def driven_to(line, rules, speed, **at_line):
    """Ego at x = 60, its front at 62.25 m, on a road with a line ahead: its maneuvers."""
    ends = np.array([(line, 2.0), (line, -2.0)])
    lanes = (
        straight(1, 0, line, successors=[2], stop_line=ends, **at_line),
        straight(2, line, 300, predecessors=[1]),
    )
    return ahead_of(lanes, rules, speed)


def ahead_of(lanes, rules, speed, others=()):
    """The maneuvers of ego at x = 60 m for 2 s, in steps of one."""
    made = replace(recording(lanes, others, ego=(60.0, 0.0)), side="right")
    (problem,) = made.problems
    start = replace(problem.start, speed=speed)
    made = replace(made, problems=(replace(problem, start=start),))
    scene = seen_from_ego(made, Choice(), "file.xml")
    return find_maneuvers(scene, rules, horizon_s=2.0, step_s=1.0, bounds="car")


def said(found, name):
    """Layer by layer what the only cell says."""
    assert [len(states) for states in found.words.states] == [1] * len(found.words.states)
    return [states[0][name] for states in found.words.states]


def outcomes(found, rule):
    (own,) = (one for one in found.rule_outcomes() if one.rule.name == rule)
    return own.kept, own.violated, own.open


@pytest.mark.parametrize(
    ("name", "at_line"),
    [
        ("crosses_light_line", {"lights": (RED,)}),
        ("crosses_stop_line", {"signs": frozenset({"STOP"})}),
    ],
)
def test_a_line_between_two_layers_may_have_been_crossed(german, name, at_line):
    """At 16 m/s ego is 10.25 m on a second later at least, beyond the line and all tolerance."""
    found = driven_to(66.0, german, 16.0, **at_line)
    assert said(found, name) == [False, UNKNOWN, False]


def test_who_can_only_drive_over_at_red_is_not_said_to_keep_the_law(german):
    assert outcomes(driven_to(66.0, german, 16.0, lights=(RED,)), "red_light") == (0, 0, 1)


def test_a_line_that_ego_cannot_reach_is_not_crossed(german):
    found = driven_to(105.0, german, 5.0, lights=(RED,))
    assert said(found, "crosses_light_line") == [False] * 3
    assert outcomes(found, "red_light") == (1, 0, 0)


def test_a_light_shows_what_it_shows_then(german):
    found = driven_to(105.0, german, 5.0, lights=(TURNS_GREEN,))
    assert said(found, "light") == ["red_light", "red_light", "green_light"]


def test_who_may_have_crossed_has_done_so_at_any_light_since(german):
    found = driven_to(66.0, german, 16.0, lights=(TURNS_GREEN,))
    _, crossing, beyond = said(found, "light")
    assert crossing == OneOf(frozenset({"red_light", "no_light"}))
    assert beyond == "no_light"


def test_who_left_too_little_room_a_moment_ago_may_have_done_so_when_ego_entered(german):
    """The junction is from x = 66 to 70 m; one drives off 2 m behind it, and ego behind that."""
    lanes = (
        straight(1, 0, 66, successors=[2]),
        straight(2, 66, 70, predecessors=[1], successors=[3], junction="j"),
        straight(3, 70, 300, predecessors=[2]),
        lanelet(4, [(68.0, -60.0), (68.0, -2.0)], successors=[5]),
        lanelet(5, [(68.0, -2.0), (68.0, 2.0)], predecessors=[4], successors=[6], junction="j"),
        lanelet(6, [(68.0, 2.0), (68.0, 60.0)], predecessors=[5]),
    )
    gone = vehicle(10, {k: (74.0 + 7.5 * k, 0.0) for k in range(13)}, speed=15.0)
    found = ahead_of(lanes, german, 16.0, [gone])
    states = [layer[0] for layer in found.words.states]
    assert [state["enters_junction"] for state in states] == [False, UNKNOWN, False]
    assert [state["exit_clear"] for state in states] == [UNKNOWN, UNKNOWN, True]

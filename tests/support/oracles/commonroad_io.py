"""A recording held against what commonroad-io has read of the same file.

What the library says comes from `tests/peers/read_with_commonroad_io.py`; here are its words for
what a recording calls otherwise.
"""

import numpy as np
import pytest

from rulec.recordings.commonroad.commonroad_surroundings import Intersection, junctions
from rulec.recordings.recording import BROAD_LEFT, BROAD_RIGHT, Light, Weather

MARKS = {
    "solid": "solid",
    "broad_solid": "solid",
    "solid_solid": "double_solid",
    "dashed": "broken",
    "broad_dashed": "broken",
    "dashed_dashed": "broken",
    "no_marking": "none",
}
LAMPS = {
    "indicator_left": "left_indicator",
    "indicator_right": "right_indicator",
    "hazard_warning_lights": "hazard_lights",
    "braking_lights": "brake_light",
    "flashing_blue_lights": "blue_light",
    "horn": "horn",
}
WEATHERS = {
    (None, None): Weather(),
    ("light_rain", "wet"): Weather(wet=True, icy=False, raining=True, night=True),
    ("clear", "clean"): Weather(wet=False, icy=False, visibility_m=1000.0, raining=False),
}


def assert_equal(recording, said):
    """Every field of a recording is what the library says."""
    assert recording.step_s == said["step_s"]
    assert recording.weather == WEATHERS[said["weather"], said["underground"]]
    assert list(recording.lanelets) == [str(one["id"]) for one in said["lanelets"]]
    inside = junctions(
        [
            Intersection(number, tuple(map(str, starts)))
            for number, starts in said["intersections"].items()
        ],
        recording.lanelets,
    )
    for one in said["lanelets"]:
        _assert_equal_lanelet(recording, one, said, inside.get(str(one["id"]), ""))
    assert len(recording.participants) == len(said["participants"])
    for ours, theirs in zip(recording.participants, said["participants"], strict=True):
        _assert_equal_participant(ours, theirs)
    problems = sorted(said["problems"], key=lambda one: one["id"])
    assert [one.id for one in recording.problems] == [str(one["id"]) for one in problems]
    for ours, theirs in zip(recording.problems, problems, strict=True):
        _assert_equal_problem(ours, theirs, recording)


def _assert_equal_lanelet(recording, theirs, said, junction):
    ours = recording.lanelets[str(theirs["id"])]
    for side in ("left", "right", "centre"):
        assert getattr(ours, side).tolist() == theirs[side]
    for ways in ("successors", "predecessors"):
        assert list(getattr(ours, ways)) == list(map(str, theirs[ways]))
    for beside in ("left_of", "right_of"):
        if theirs[beside] is not None or not recording.remarks:
            assert getattr(ours, beside) == _text(theirs[beside])
    assert ours.junction == junction
    marks = (("left_mark", BROAD_LEFT), ("right_mark", BROAD_RIGHT))
    broad = {kind for mark, kind in marks if theirs[mark] == "broad_dashed"}
    assert ours.types == {*theirs["types"], *(["intersection"] if junction else []), *broad}
    elements = [
        element for number in theirs["signs"] for element in said["signs"].get(str(number), [])
    ]
    assert ours.signs == {name for name, _ in elements}
    limits = [float(values[0]) for name, values in elements if name == "MAX_SPEED" and values]
    assert ours.limit_mps == min(limits, default=None)
    programmes = [said["lights"].get(str(number)) for number in theirs["lights"]]
    assert list(ours.lights) == [
        Light(begin, tuple((colour, steps) for colour, steps in phases))
        for begin, phases in filter(None, programmes)
    ]
    assert ours.lights_to == {}
    assert (ours.left_mark, ours.right_mark) == tuple(
        MARKS.get(theirs[mark]) for mark in ("left_mark", "right_mark")
    )
    assert (ours.stop_line is None) == (theirs["stop_line"] is None)
    assert ours.stop_line is None or ours.stop_line.tolist() == theirs["stop_line"]
    assert (ours.foes, ours.first) == (None, None)


def _assert_equal_participant(ours, theirs):
    assert (ours.id, ours.type, ours.standing) == (
        str(theirs["id"]),
        theirs["type"],
        theirs["standing"],
    )
    states = {state["step"]: state for state in theirs["states"]}
    assert list(ours.states) == list(states)
    for step, state in states.items():
        own = ours.states[step]
        assert (own.heading, own.speed, own.acceleration) == (
            state["heading"],
            state["speed"],
            state["acceleration"],
        )
        assert (own.x, own.y) == pytest.approx(tuple(state["place"]), abs=1e-9)
    outlines = dict(theirs["outlines"])
    assert list(ours.outlines) == list(outlines)
    for step, corners in outlines.items():
        _assert_equal_outline(ours.outlines[step], np.array(corners))
    if theirs["lamps"] is not None:
        assert ours.lamps == {
            step: {LAMPS[lamp] for lamp, lit in lamps.items() if lit}
            for step, lamps in theirs["lamps"]
        }
        shown = [{LAMPS[lamp] for lamp in lamps} for _, lamps in theirs["lamps"]]
        assert ours.shows == (set.intersection(*shown) if shown else set())


def _assert_equal_outline(ours, corners):
    """Corners and the middles between them, wherever either begins."""
    expected = np.concatenate((corners, (corners + np.roll(corners, 1, axis=0)) / 2))
    assert len(ours) == len(expected)
    apart = np.hypot(*(ours[:, None] - expected[None]).T)
    assert apart.min(axis=0).max() < 1e-6
    assert apart.min(axis=1).max() < 1e-6


def _assert_equal_problem(ours, theirs, recording):
    assert ours.step == theirs["step"]
    assert [ours.start.x, ours.start.y] == theirs["place"]
    assert ours.start.heading == theirs["heading"]
    assert (ours.start.speed, ours.start.acceleration) == (theirs["speed"], theirs["acceleration"])
    centres = [recording.lanelets[str(number)].centre for number in theirs["goal_lanelets"]]
    goals = theirs["goals"] + [centre[len(centre) // 2].tolist() for centre in centres]
    expected = [pytest.approx(tuple(goal), abs=1e-9) for goal in goals]
    assert list(map(tuple, ours.goals.tolist())) == expected


def _text(number):
    return None if number is None else str(number)

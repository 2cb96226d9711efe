"""Another reader of ASAM OSI's traces: betterosi, made from the standard's own definitions.

With what it brings it takes 50 MB, so it has an environment of its own; hence only in the long run.
"""

import json
import os
import subprocess
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import shapely

from rulec import read_recording
from support.builders.recorded_data import RECORDINGS
from tools.programs import environment

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("read_with_betterosi.py")
FOLDER = RECORDINGS.parent / "osi"
FILES = sorted([*FOLDER.glob("*.osi"), *FOLDER.glob("*.mcap")])
KINDS = {
    **dict.fromkeys(("CAR", "MEDIUM_CAR", "LUXURY_CAR", "DELIVERY_VAN", "VAN"), "car"),
    "MOTORBIKE": "motorcycle",
    "BUS": "bus",
}
MARKS = {"SOLID_LINE": {"solid", "double_solid"}, "DASHED_LINE": {"broken"}, "NO_LINE": {"none"}}
LAMPS = {
    "LEFT": {"left_indicator"},
    "RIGHT": {"right_indicator"},
    "WARNING": {"hazard_lights"},
    "NORMAL": {"brake_light"},
    "STRONG": {"brake_light"},
    "FLASHING_BLUE": {"blue_light"},
}
TYPES = {"SIDEWALK": "sidewalk", "BORDER": "border"}


@pytest.fixture(scope="module")
def said():
    python = environment("betterosi", "betterosi==0.9.0") / "bin" / "python"
    done = subprocess.run([python, PROGRAM, *FILES], capture_output=True, text=True, check=True)
    return dict(zip(FILES, map(json.loads, done.stdout.splitlines()), strict=True))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_every_state_is_the_same(said, file):
    told, found = said[file], read_recording(file)
    bodies = {body.id: body for body in found.participants if not body.standing}
    assert found.ego == (told["host"] if told["host"] in bodies else "")
    since = np.array(told["times"]) - told["times"][0]
    steps = np.round(since / 1e9 / found.step_s).astype(int).tolist()
    seen = 0
    for step, objects in zip(steps, told["objects"], strict=True):
        for one in objects:
            assert_state(one, bodies[one["id"]], step)
            seen += 1
    assert seen == sum(len(body.states) for body in bodies.values())


def assert_state(one, body, step):
    state = body.states[step]
    assert [state.x, state.y] == one["place"]
    assert abs(np.exp(1j * state.heading) - np.exp(1j * one["heading"])) < 1e-12
    ahead = cos(one["heading"]), sin(one["heading"])
    for vector, value in (("velocity", state.speed), ("acceleration", state.acceleration)):
        if one[vector] is not None:
            assert value == pytest.approx(np.dot(one[vector], ahead), abs=1e-9)
    track = body.states.track
    assert [track.length, track.width] == one["size"]
    if one["type"] == "PEDESTRIAN":
        assert body.type == "pedestrian"
    elif one["vehicle"][1] in ("POLICE", "FIRE", "AMBULANCE"):
        assert body.type == "priorityVehicle"
    else:
        assert body.type == KINDS[one["vehicle"][0]]
    lamps = one["lamps"] or {}
    lit = {lamp for value in lamps.values() for lamp in LAMPS.get(value, ())}
    assert body.lamps.get(step, frozenset()) == lit


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_every_lane_is_the_same(said, file):
    told, found = said[file], read_recording(file)
    for lane in told["lanes"]:
        lanelet = found.lanelets.get(lane["id"])
        if lanelet is None:
            # An area of an intersection has neither a middle nor sides
            assert not lane["centre"]
            assert not lane["left"] + lane["right"]
            continue
        turned = bool(lane["centre"]) and not lane["forward"]
        if lane["centre"]:
            assert_on(lane["centre"][:: -1 if turned else 1], lanelet.centre)
        assert ("intersection" in lanelet.types) == (lane["type"] == "INTERSECTION")
        assert TYPES.get(lane["subtype"]) in (None, *lanelet.types)
        sides = [(lane["left"], "left"), (lane["right"], "right")]
        for ids, side in sides:
            own = {"left": "right", "right": "left"}[side] if turned else side
            bounds = [told["boundaries"][x] for x in ids]
            is_driven = lane["type"] != "NONDRIVING"
            for _, points in bounds:
                ordered = points[:: -1 if turned else 1]
                assert_on(ordered, getattr(lanelet, own), is_driven=is_driven)
            kinds = {kind for kind, _ in bounds}
            mark = getattr(lanelet, f"{own}_mark")
            assert mark in (MARKS.get(kinds.pop(), {None}) if len(kinds) == 1 else {None})
    for kind, place, lanes in told["marks"]:
        for lane in lanes if kind == "STOP" else ():
            middle = found.lanelets[lane].stop_line.mean(axis=0)
            np.testing.assert_allclose(middle, place, atol=0.01)


def assert_on(points, line, *, is_driven=True):
    """Each of the points lies on a line, in the order of the line.

    Bounds begin and end straight across the ends of the middle, and so up to 5 cm beside theirs; of
    points less than 1 cm apart only one is kept. Beside the carriageway one sidewalk bends so
    sharply that its bound is up to 20 cm off.
    """
    string = shapely.LineString(line)
    places = shapely.points(points)
    away = shapely.distance(string, places)
    assert away.max() < (0.05 if is_driven else 0.2)
    assert away[1:-1].max(initial=0.0) < (0.01 if is_driven else 0.1)
    assert (np.diff(shapely.line_locate_point(string, places)) > -1e-6).all()

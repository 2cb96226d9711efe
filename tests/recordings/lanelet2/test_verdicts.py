"""Drives on Lanelet2 maps before German law: crossings, lights, and who goes first."""

import numpy as np
import pytest

from rulec import compile_rulebook, judge_recording
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import Track, TrackOutlines, TrackStates
from support.builders.lanelet2_files import MapFile

STEP_S = 0.1


@pytest.fixture(scope="module")
def law():
    return compile_rulebook("de")


def body(name, kind, start, end, speed, since=0):
    """Somebody who goes straight from a place to another at a speed (m/s), from a step on."""
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    way = end - start
    far = np.hypot(*way)
    along = np.arange(0, far, speed * STEP_S)
    rows = np.empty((len(along), 5))
    rows[:, :2] = start + along[:, None] * way / far
    rows[:, 2:] = np.arctan2(way[1], way[0]), speed, 0.0
    size = (0.5, 0.5) if kind == "pedestrian" else (4.5, 1.8)
    track = Track(np.arange(len(along)) + since, rows, *size)
    shows = frozenset()
    return Participant(name, kind, False, TrackStates(track), TrackOutlines(track), shows=shows)


def judged(file, folder, law, *bodies):
    """Ego's verdict: it is the first of them."""
    found = read_map(file.write(folder), STEP_S)
    recording = Recording(
        name="drive",
        step_s=STEP_S,
        lanelets=found.lanelets,
        participants=bodies,
        problems=(),
        side=found.side,
        country=found.country,
    )
    answers = {one.drive.ego: one.answer for one in judge_recording(recording, law).answers()}
    return answers[bodies[0].id]


def rules(findings):
    return {finding.rule for finding in findings}


def street(light=False):
    """A lane to the east and one to the west, 200 m long, with a crossing from x = 100 to 104."""
    file = MapFile()
    for start, end in ((0, 99), (99, 200)):
        middle = file.line((start, 0), (end, 0), type="line_thin", subtype="dashed")
        stop = file.line((98.5, 0), (98.5, -3.5), type="stop_line")
        lamp = file.line((99, -4), (99, -4.5), type="traffic_light")
        roles = [("refers", "way", lamp), ("ref_line", "way", stop)]
        rule = [file.rule("traffic_light", roles)] if light and not start else []
        tags = {"region": "de"}
        file.lanelet(middle, file.line((start, -3.5), (end, -3.5)), rules=rule, **tags)
        file.lanelet(middle, file.line((start, 3.5), (end, 3.5)), **tags)
    marks = [file.line((x, -5), (x, 5), type="zebra_marking") for x in (100, 104)]
    file.lanelet(*marks, subtype="crosswalk", region="de")
    return file


CAR = body("car", "car", (20, -1.75), (180, -1.75), 10.0)
# She is on the crossing while the car, whose front is there from 7.75 s on, drives over it
WALKER = body("walker", "pedestrian", (102, -7), (102, 7), 1.4, since=50)
LATE = body("walker", "pedestrian", (102, -30), (102, 7), 1.4, since=60)


@pytest.mark.parametrize(("walker", "violated"), [(WALKER, True), (LATE, False)])
def test_walkers_on_a_crossing_go_first(tmp_path, law, walker, violated):
    verdict = judged(street(), tmp_path, law, CAR, walker)
    rule = "give_way_to_pedestrians"
    assert (rule in rules(verdict.violations)) == violated
    assert rule not in rules(verdict.open) | rules(verdict.not_judged)


def test_a_light_leaves_open_whether_it_was_red(tmp_path, law):
    verdict = judged(street(light=True), tmp_path, law, CAR, WALKER)
    assert "red_light" in rules(verdict.not_judged) | rules(verdict.open)
    # It directs those who cross, too
    assert "give_way_to_pedestrians" not in rules(verdict.violations)
    without = judged(street(), tmp_path, law, CAR, WALKER)
    assert "red_light" not in rules(without.violations) | rules(without.open)

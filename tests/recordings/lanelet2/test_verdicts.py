"""Drives on Lanelet2 maps before German law: crossings, lights, and who goes first."""

import numpy as np
import pytest
import shapely

from rulec import compile_rulebook, judge_recording
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Recording
from rulec.recordings.track import Track, tracked
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
    return tracked(name, kind, track)


def along(name, corners, speed):
    """A car that goes from place to place at a speed."""
    line = shapely.LineString(corners)
    places = np.arange(0, line.length - 1, speed * STEP_S)
    here, ahead = (
        shapely.get_coordinates(shapely.line_interpolate_point(line, places + more))
        for more in (0.0, 1.0)
    )
    rows = np.empty((len(places), 5))
    rows[:, :2] = here
    rows[:, 2] = np.arctan2(*(ahead - here).T[::-1])
    rows[:, 3:] = speed, 0.0
    track = Track(np.arange(len(places)), rows, 4.5, 1.8)
    return tracked(name, "car", track)


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


def left_turn(ego_waits):
    """Ego's lane from the west, which turns to the north across one from the east.

    Either ego waits or who comes towards it, as on a road whose priority bends.
    """
    file = MapFile()
    straight = file.line((8, 0), (-8, 0), type="virtual"), file.line((8, 3.5), (-8, 3.5))
    bend = file.line((-8, 0), (-2, 2), (0, 8)), file.line((-8, -3.5), (1, -1), (3.5, 8))
    on = file.lanelet(*straight, turn_direction="straight", region="de")
    turn = file.lanelet(*bend, turn_direction="left", region="de")
    for lines in (
        [[(-60, 0), (-8, 0)], [(-60, -3.5), (-8, -3.5)]],
        [[(0, 8), (0, 60)], [(3.5, 8), (3.5, 60)]],
        [[(60, 0), (8, 0)], [(60, 3.5), (8, 3.5)]],
        [[(-8, 0), (-60, 0)], [(-8, 3.5), (-60, 3.5)]],
    ):
        file.lanelet(*(file.line(*line) for line in lines), region="de")
    waits, goes = (turn, on) if ego_waits else (on, turn)
    file.rule("right_of_way", [("yield", "relation", waits), ("right_of_way", "relation", goes)])
    return file


@pytest.mark.parametrize("ego_waits", [True, False])
def test_the_map_says_who_goes_first(tmp_path, law, ego_waits):
    corners = [(-50, -1.75), (-8, -1.75), (-0.5, 0.5), (1.75, 8), (1.75, 50)]
    # 42 m at 7 m/s to the junction, where the other one arrives at the same time, at 8 m/s
    ego = along("ego", corners, 7.0)
    other = body("other", "car", (56, 1.75), (-50, 1.75), 8.0)
    verdict = judged(left_turn(ego_waits), tmp_path, law, ego, other)
    found = rules(verdict.violations)
    assert ("oncoming_priority" in found) == ego_waits
    assert "oncoming_priority" not in rules(verdict.open) | rules(verdict.not_judged)

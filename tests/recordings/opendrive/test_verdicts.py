"""Drives on OpenDRIVE maps before German law, and the scene of a simulator's two outputs."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from rulec import compile_rulebook, judge_recording
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import NO_LANES, Light, Recording
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.track import Track, tracked
from support.builders.opendrive_files import shared_map, signals, t_junction, written

STEP_S = 0.1
STOP = {"id": "s", "s": 99, "orientation": "+", "type": "206"}
LIGHT = {"id": "l", "s": 98, "orientation": "+", "dynamic": "yes", "type": "1000001"}


@pytest.fixture(scope="module")
def law():
    return compile_rulebook("de")


def verdict(folder, law, speed_mps, *, end_m=180.0, colour=None, **parts):
    """Of a car that goes straight towards a junction and through it, from x = 20, at one speed.

    With a colour the lights of the map show it all the time.
    """
    found = read_map(written(folder, t_junction(**parts)), STEP_S)
    lanelets = found.lanelets
    if colour is not None:
        shown = (Light(0, ((colour, 1),)),)
        lanelets = {
            key: replace(one, lights=shown) if one.lights else one for key, one in lanelets.items()
        }
    x = np.arange(20.0, end_m, speed_mps * STEP_S)
    still = np.zeros(len(x))
    rows = np.column_stack((x, still - 1.75, still, still + speed_mps, still))
    track = Track(np.arange(len(x)), rows, 4.5, 1.8)
    car = tracked("car", "car", track)
    recording = Recording("drive", STEP_S, lanelets, (car,), (), side=found.side)
    (one,) = judge_recording(recording, law).answers()
    return one.answer


def rules(findings):
    return {finding.rule for finding in findings}


@pytest.mark.parametrize(("kind", "too_fast"), [("town", True), ("rural", False)])
def test_72_kmh_are_too_fast_in_town(tmp_path, law, kind, too_fast):
    """No sign says a limit there: it is 50 km/h in built-up areas, 100 outside.

    A map without any limit is one on which nobody has written them.
    """
    elsewhere = f'<type s="0" type="{kind}"><speed max="60" unit="km/h"/></type>'
    west = f'<type s="0" type="{kind}"/>'
    found = verdict(tmp_path, law, 20.0, end_m=96.0, west=west, straight=elsewhere)
    assert "speed_limit" not in rules(found.not_judged)
    assert ("speed_limit" in rules(found.violations)) == too_fast


@pytest.mark.parametrize(
    ("more", "plate", "wrong"),
    [
        ({"value": 30}, (), True),
        ({"value": 30}, ({"id": "p", "s": 40, "orientation": "+", "type": "1040-30"},), None),
        *[({}, (), None), ({"subtype": "100"}, (), False), ({"subtype": "60"}, (), None)],
    ],
)
def test_72_kmh_past_a_sign_that_may_be_another_limit(tmp_path, law, more, plate, wrong):
    """Neither an offence nor surely none, where the map does not tell what the sign says."""
    sign = {"id": "a", "s": 40, "orientation": "+", "type": "274"} | more
    elsewhere = '<type s="0" type="rural"><speed max="100" unit="km/h"/></type>'
    west = '<type s="0" type="rural"/>' + signals(sign, *plate)
    found = verdict(tmp_path, law, 20.0, end_m=96.0, west=west, straight=elsewhere)
    assert ("speed_limit" in rules(found.violations)) == (wrong is True)
    assert ("speed_limit" in rules(found.open)) == (wrong is None)
    assert "speed_limit" not in rules(found.not_judged)


@pytest.mark.parametrize("posted", [True, False])
def test_a_stop_sign(tmp_path, law, posted):
    found = verdict(tmp_path, law, 10.0, west=signals(*([STOP] if posted else [])))
    assert ("stop_sign" in rules(found.violations)) == posted


def test_a_light_leaves_open_whether_a_stop_sign_beside_it_counts(tmp_path, law):
    found = verdict(tmp_path, law, 10.0, west=signals(STOP, LIGHT))
    assert "stop_sign" in rules(found.open)


@pytest.mark.parametrize(("colour", "stops"), [("green", False), ("inactive", True)])
def test_a_light_at_work_comes_before_a_stop_sign(tmp_path, law, colour, stops):
    found = verdict(tmp_path, law, 10.0, colour=colour, west=signals(STOP, LIGHT))
    assert ("stop_sign" in rules(found.violations)) == stops
    assert "stop_sign" not in rules(found.open)


def test_a_light_leaves_open_whether_it_was_red(tmp_path, law):
    found = verdict(tmp_path, law, 10.0, west=signals(LIGHT))
    assert "red_light" in rules(found.not_judged) | rules(found.open)
    assert "red_light" not in rules(found.violations)


NEAR_M = 0.05
SCENES = {
    "pedestrian": "fabriksgatan",
    "acc-test": "straight_500m",
    "highway_merge": "soderleden",
}
"""OSI traces that esmini wrote, with its own evaluation of the map's lanes in them."""

NEEDS_MAPS = pytest.mark.skipif(
    shared_map("soderleden") is None, reason="OpenDRIVE's maps are not here: set RULEC_RECORDINGS"
)


@pytest.mark.long
@NEEDS_MAPS
@pytest.mark.parametrize(("trace", "name"), SCENES.items())
def test_lanes_of_a_simulator(trace, name):
    file = shared_map(name)
    lanes = [x for x in read_map(file, STEP_S).lanelets.values() if not x.types & NO_LANES]
    middles = shapely.union_all([shapely.LineString(x.centre) for x in lanes])
    theirs = read_recording(RecordingSource(file.with_name(f"{trace}.osi"))).lanelets.values()
    compared = 0
    for lanelet in theirs:
        if not lanelet.types & (NO_LANES | {"intersection"}):
            away = shapely.distance(middles, shapely.points(lanelet.centre))
            assert away.max() < NEAR_M, lanelet.id
            compared += 1
    assert compared >= 2


@pytest.mark.long
@NEEDS_MAPS
def test_a_trace_and_a_table_of_one_scene_have_one_verdict(law):
    """The table has the map's lanes, the trace its own, and fewer things on them."""
    file = shared_map("fabriksgatan")
    table = RecordingSource(file.with_name("pedestrian_objects.csv"), map_path=file)
    trace = RecordingSource(file.with_name("pedestrian.osi"))
    answers = []
    for source in (table, trace):
        (one,) = judge_recording(read_recording(source), law).answers()
        answers.append(one.answer)
    by_map, by_trace = answers
    assert not by_map.violations
    assert not by_trace.violations
    assert rules(by_map.not_judged) <= rules(by_trace.not_judged)
    assert rules(by_map.open) - rules(by_trace.not_judged) <= rules(by_trace.open)

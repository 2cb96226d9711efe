"""Argoverse 2's own samples, if they are at hand: what is in them, and what is judged of it."""

import numpy as np
import pytest
from pyarrow import feather, parquet

from rulec import compile_rulebook, read_recording
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.extraction.traces.recorded_drive import NoDrive
from support.builders.recorded_data import RECORDINGS

FOLDER = RECORDINGS.parent / "argoverse2"
if not FOLDER.is_dir():
    pytest.skip("Argoverse 2's samples are not here: set RULEC_RECORDINGS", allow_module_level=True)
MOTION, SENSOR = FOLDER / "motion", FOLDER / "sensor"


@pytest.fixture(scope="module")
def motion():
    return read_recording(MOTION)


@pytest.fixture(scope="module")
def sensor():
    return read_recording(SENSOR)


def test_what_the_scenario_has(motion):
    lanes = [x for x in motion.lanelets.values() if "crosswalk" not in x.types]
    steps = {step for x in motion.participants for step in x.states}
    assert len(motion.participants) == 58
    assert steps == set(range(110))
    assert sum(x.type == "pedestrian" for x in motion.participants) == 12
    assert (len(lanes), len(motion.lanelets) - len(lanes)) == (71, 6)
    assert sum("intersection" in x.types for x in lanes) == 32
    assert motion.ego == "AV"


def test_places_are_the_tables_to_the_last_bit(motion):
    (path,) = MOTION.glob("*.parquet")
    rows = parquet.read_table(path).to_pylist()
    states = {x.id: x.states for x in motion.participants}
    for row in rows:
        state = states[row["track_id"]][row["timestep"]]
        assert (state.x, state.y) == (row["position_x"], row["position_y"])
        assert state.heading == row["heading"]
    assert sum(map(len, states.values())) == len(rows)


def test_what_the_log_has(sensor):
    (path,) = SENSOR.glob("annotations*.feather")
    table = feather.read_table(path).to_pydict()
    lanes = [x for x in sensor.lanelets.values() if "crosswalk" not in x.types]
    ego = next(x for x in sensor.participants if x.id == sensor.ego)
    assert len(sensor.participants) == len(set(table["track_uuid"])) == 120
    assert len(ego.states) == len(set(table["timestamp_ns"])) == 157
    assert sum(x.type == "pedestrian" for x in sensor.participants) == 12
    assert (len(lanes), len(sensor.lanelets) - len(lanes)) == (150, 6)
    # Of 13,820 boxes 3,452 have no point; some are between others, or stand
    points = np.array(table["num_interior_pts"])
    assert (points > 0).sum() < sum(len(x.states) for x in sensor.participants) < len(points)


def test_ego_does_not_slip_sideways(sensor):
    """Its body's middle swings out as it turns left, as it would not on the rear axle."""
    ego = next(x for x in sensor.participants if x.id == sensor.ego)
    states = list(ego.states.values())
    turns = np.gradient(np.unwrap([s.heading for s in states]), sensor.step_s)
    x, y = (np.gradient([getattr(s, k) for s in states], sensor.step_s) for k in "xy")
    headings = np.array([s.heading for s in states])
    sideways = -x * np.sin(headings) + y * np.cos(headings)
    turning = turns > 0.1
    ahead = float((sideways * turns)[turning].sum() / (turns**2)[turning].sum())
    assert ahead == pytest.approx(1.34, abs=0.2)


@pytest.mark.long
@pytest.mark.parametrize("name", ["motion", "sensor"])
def test_words_are_those_that_the_format_can_tell(name, request):
    found = request.getfixturevalue(name)
    told = selected_drives(found, RequestedDrives(), name).told_words()
    # Nobody there runs on rails, or stops to let people in
    of_nobody = {"conflict_with_rail", "boarding", "leaving_stop"}
    missing = TELLABLE_WORDS[f"argoverse-{name}"] - told
    assert told - of_nobody <= TELLABLE_WORDS[f"argoverse-{name}"]
    # A light is told to be none where there is neither a junction nor a crossing
    assert missing == {"light", "crosses_light_line"}


@pytest.mark.long
@pytest.mark.parametrize("name", ["motion", "sensor"])
def test_people_and_lines_are_judged(name, request):
    book = compile_rulebook("us-ca")
    judged = RecordingVerdicts(request.getfixturevalue(name), book, RequestedDrives(), name)
    answers = [x.answer for x in judged.answers() if not isinstance(x, NoDrive)]
    for rule in ("give_way_to_pedestrians", "solid_line"):
        assert not any(rule in {x.rule for x in one.not_judged} for one in answers)
        open_in = sum(rule in {x.rule for x in one.open} for one in answers)
        assert open_in < 0.6 * len(answers)

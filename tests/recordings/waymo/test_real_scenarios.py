"""The scenarios that are at hand: their counts, known from an independent decoder, and verdicts."""

from collections import Counter

import numpy as np
import pytest

from rulec import compile_rulebook
from rulec.recordings.encodings.tfrecord import tfrecords
from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.waymo.waymo_file import WAYMO
from support.builders import scenarionet_files
from support.builders.recorded_data import RECORDINGS
from support.builders.scene_verdicts import verdicts

FOLDER = RECORDINGS.parent
WAYMO_FILE = FOLDER / "waymo/motion_data_one_scenario.tfrecord"
SCENES = sorted((FOLDER / "scenarionet").glob("*.pkl"))
if not WAYMO_FILE.exists():
    pytest.skip("Waymo's scenario is not here: set RULEC_RECORDINGS", allow_module_level=True)


@pytest.fixture(scope="module")
def scene():
    return read_recording(RecordingSource(WAYMO_FILE))


def test_counts_of_waymo_s_scenario(scene):
    """83 tracks, 4,596 valid states; 8 lanes with stop signs, lights at 12; 4 crosswalks."""
    kinds = Counter(body.object_types[-2] for body in scene.participants)
    assert kinds == {"road_user": 83}
    assert Counter(body.type for body in scene.participants)["pedestrian"] == 10
    assert scene.ego == "2406"
    assert sum("crosswalk" in x.types for x in scene.lanelets.values()) == 4
    lit = {way for x in scene.lanelets.values() for way, light in x.lights_to.items() if light.seen}
    assert len(lit) == 12
    shown = Counter(
        colour
        for x in scene.lanelets.values()
        for light in x.lights_to.values()
        for colour in light.colours.values()
    )
    # 324 STOP and 228 ARROW_STOP; 540 unknown ones have no colour
    assert shown == {"red": 552}


def test_states_are_those_of_the_file_to_the_last_bit(scene):
    """Against the fields as they are on the wire."""
    (record,) = tfrecords(WAYMO_FILE, WAYMO)
    file = WireFile(record.content, WAYMO_FILE, WAYMO)
    tracks = scenarionet_files.from_waymo(file)["tracks"]
    assert sum(int(track["state"]["valid"].sum()) for track in tracks.values()) == 4596
    for body in scene.participants:
        state = tracks[body.id]["state"]
        for step in np.flatnonzero(state["valid"]).tolist():
            own = body.states[step]
            assert (own.x, own.y) == tuple(state["position"][step, :2])
            assert own.heading == state["heading"][step]


@pytest.mark.long
def test_the_same_verdicts_in_scenarionet_s_form(scene, tmp_path):
    (record,) = tfrecords(WAYMO_FILE, WAYMO)
    file = WireFile(record.content, WAYMO_FILE, WAYMO)
    path = scenarionet_files.write(tmp_path / "sd_some.pkl", scenarionet_files.from_waymo(file))
    rulebook = compile_rulebook("us-ca")
    found = verdicts(scene, rulebook)
    assert found == verdicts(read_recording(RecordingSource(path)), rulebook)
    judged = [name for name, (_, _, not_judged) in found.items() if "red_light" not in not_judged]
    assert judged
    assert all("stop_sign" not in not_judged for _, _, not_judged in found.values())


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_scenes_of_scenarionet(file):
    found = read_recording(RecordingSource(file))
    assert found.step_s == 0.1
    assert found.ego in {body.id for body in found.participants}
    singapore = file.stem[-4:] in ("0916", "1077", "1100")
    assert found.side == ("left" if singapore else "right")
    for lanelet in found.lanelets.values():
        assert np.isfinite(lanelet.left).all()
        assert np.isfinite(lanelet.right).all()

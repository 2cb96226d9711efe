"""Another decoder of Waymo's motion data, Waymo's own: its package without TensorFlow.

In an environment of its own, hence only in the long run of the tests.
"""

import json
import os
import subprocess
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from rulec import read_recording
from support.builders.recorded_data import RECORDINGS
from tools.programs import environment

FILE = RECORDINGS.parent / "waymo" / "motion_data_one_scenario.tfrecord"
pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
    ),
    pytest.mark.skipif(not FILE.exists(), reason="Waymo's scenario is not here"),
]
PROGRAM = Path(__file__).with_name("read_with_waymo.py")
NEEDED = ("waymo-open-dataset-tf-2-12-0==1.6.7", "protobuf==3.20.3")


@pytest.fixture(scope="module")
def decoded():
    """The scenario's own row, and its tracks by id."""
    python = environment("waymo", "--no-deps", *NEEDED) / "bin" / "python"
    done = subprocess.run([python, PROGRAM, FILE], capture_output=True, text=True, check=True)
    scenario, *tracks = map(json.loads, done.stdout.splitlines())
    return scenario, {key: (kind, states) for _, key, kind, states in tracks}


def test_counts(decoded):
    (_, name, ego, lights, kinds, drawn), tracks = decoded
    found = read_recording(FILE)
    assert (found.name, found.ego) == (name, str(ego))
    assert len(tracks) == len(found.participants) == 83
    on_foot = sum(kind == "TYPE_PEDESTRIAN" for kind, _ in tracks.values())
    assert on_foot == sum(body.type == "pedestrian" for body in found.participants)
    assert lights == {
        "LANE_STATE_STOP": 324,
        "LANE_STATE_ARROW_STOP": 228,
        "LANE_STATE_UNKNOWN": 540,
    }
    shown = Counter(
        colour
        for lanelet in found.lanelets.values()
        for light in lanelet.lights_to.values()
        for colour in light.colours.values()
    )
    assert shown == {"red": 324 + 228}
    assert (kinds["lane"], kinds["stop_sign"], kinds["crosswalk"]) == (199, 8, 4)
    # One of the lanes is a point
    lanes = {name.partition(".")[0] for name in found.lanelets if "crosswalk" not in name}
    assert lanes == set(map(str, drawn))
    assert len(lanes) == 198
    crosswalks = [x for x in found.lanelets.values() if "crosswalk" in x.types]
    assert len(crosswalks) == kinds["crosswalk"]


def test_states_to_the_last_bit(decoded):
    _, tracks = decoded
    found = {body.id: body.states for body in read_recording(FILE).participants}
    compared = 0
    for key, (_, states) in tracks.items():
        for step, x, y, heading in states:
            own = found[key][step]
            assert (own.x, own.y) == (x, y)
            assert np.cos(own.heading - heading) == pytest.approx(1.0, abs=1e-12)
            compared += 1
    assert compared == 4_596

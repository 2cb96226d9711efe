"""Another reader of Argoverse 2's sensor logs, the data set's own: where boxes are in the city.

The package takes some gigabytes with all that it asks for, so that only what its geometry needs is
installed, in an environment of its own; hence only in the long run of the tests.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

from rulec import read_recording
from support.builders.recorded_data import RECORDINGS
from tools.programs import environment

SENSOR = RECORDINGS.parent / "argoverse2" / "sensor"
pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
    ),
    pytest.mark.skipif(not SENSOR.is_dir(), reason="Argoverse 2's samples are not here"),
]
PROGRAM = Path(__file__).with_name("read_with_av2.py")
NEEDED = ("av2==0.3.6", "numpy", "scipy", "pyarrow", "universal-pathlib", "fsspec", "pathlib-abc")
LAST_BITS = 1e-12
"""In units of the value: a product of matrices may be summed in another order."""


def test_boxes_are_where_the_library_has_them():
    (annotations,) = SENSOR.glob("annotations*.feather")
    python = environment("av2", "--no-deps", *NEEDED) / "bin" / "python"
    command = [python, PROGRAM, annotations, SENSOR / "city_SE3_egovehicle.feather"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = read_recording(SENSOR)
    states = {x.id: x.states for x in found.participants}
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    moments = {moment: step for step, moment in enumerate(sorted({row[1] for row in rows}))}
    compared = 0
    for track, moment, x, y, _, heading in rows:
        # Ego's own box lies on its rear axle, and is moved to its middle
        if track != found.ego:
            state = states[track][moments[moment]]
            assert (state.x, state.y) == pytest.approx((x, y), rel=LAST_BITS, abs=0)
            assert state.heading == pytest.approx(heading, rel=0, abs=LAST_BITS)
            compared += 1
    assert compared == 13_663

"""A log that py123d itself has made of one of Argoverse 2's, and what it says of it.

It takes 1.5 GB with all that it asks for, in an environment of its own; hence only in the long run
of the tests.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pyarrow.compute
import pytest
from pyarrow import feather

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
SLOPES_RAD = 1e-3
"""Its yaw has w z - x y of the quaternion, where the direction of the body's x axis has w z + x y:
on level ground they are the same, on this log's slopes 3e-4 apart."""

PROGRAM = Path(__file__).with_name("write_with_py123d.py")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The folder that py123d has written, and its rows by their kind."""
    folder = tmp_path_factory.mktemp("py123d")
    source = folder / "av2" / "val" / "some"
    shutil.copytree(SENSOR / "map", source / "map")
    shutil.copy(SENSOR / "city_SE3_egovehicle.feather", source)
    (annotations,) = SENSOR.glob("annotations*.feather")
    table = feather.read_table(annotations)
    # Its parser has no label for ego's own box
    others = table.filter(pyarrow.compute.not_equal(table["category"], "EGO_VEHICLE"))
    feather.write_feather(others, source / "annotations.feather")
    python = environment("py123d", "py123d==0.7.0") / "bin" / "python"
    done = subprocess.run(
        [python, PROGRAM, source, folder], capture_output=True, text=True, check=True
    )
    rows = {}
    for kind, *row in map(json.loads, done.stdout.splitlines()):
        rows.setdefault(kind, []).append(row)
    return folder / "logs" / "av2-sensor_val" / "some", rows


def test_boxes_are_where_py123d_has_them(log):
    path, rows = log
    found = read_recording(path)
    bodies = {one.id: one.states for one in found.participants}
    moments = {moment: k for k, moment in enumerate(sorted({row[1] for row in rows["box"]}))}
    boards = {row[0] for row in rows["box"]} - bodies.keys()
    compared = 0
    for name, moment, x, y, heading, *_ in rows["box"]:
        # Who rides is one body with the cycle, and boards are left out
        if name not in boards and moments[moment] in bodies[name]:
            state = bodies[name][moments[moment]]
            assert (state.x, state.y) == (x, y)
            assert state.heading == pytest.approx(heading, abs=SLOPES_RAD)
            compared += 1
    assert len(moments) == 157
    assert compared == sum(map(len, bodies.values())) - len(bodies["ego"])


def test_ego_is_where_py123d_has_it(log):
    path, rows = log
    states = read_recording(path).participants[0].states
    moments = sorted({row[1] for row in rows["box"]})
    assert len(states) == len(moments)
    known = np.array([row[0] for row in rows["ego"]])
    for step, moment in enumerate(moments):
        # It has rounded the moments of poses, so that they are a microsecond off those of boxes
        near = np.flatnonzero(np.abs(known - moment) <= 1)
        assert any(
            (states[step].x, states[step].y) == pytest.approx(rows["ego"][row][1:3], abs=1e-4)
            and states[step].heading == pytest.approx(rows["ego"][row][3], abs=SLOPES_RAD)
            for row in near
        )


def test_lanes_are_where_py123d_has_them(log):
    path, rows = log
    lanelets = read_recording(path).lanelets
    lanes = {name: one for name, one in lanelets.items() if "crosswalk" not in one.types}
    assert lanes.keys() == {row[0] for row in rows["lane"]}
    for name, after, left, right in rows["lane"]:
        assert list(lanes[name].successors) == [x for x in after if x in lanes]
        for own, its in ((lanes[name].left, left), (lanes[name].right, right)):
            assert np.array_equal(own[[0, -1]], np.array(its)[[0, -1]])

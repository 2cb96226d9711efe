"""Another implementation of what ego can reach: commonroad-reach.

It needs libraries of its own, and an older commonroad-io than the newest, so it lives in an
environment made from the package index; hence only in the long run of the tests.
"""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from rulec import load_scenario, navigation_graph
from support.builders.recorded_data import RECORDINGS

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("reach_with_commonroad_reach.py")
NEEDED = ["commonroad-reach==2025.2.1", "commonroad-io==2024.3"]

# It has some centimetres of uncertainty at the start. Who stands drifts back there, by a third of a
# metre each second.
AT_START_M, DRIFT_M, WITHIN_M, WITHIN_MPS = 0.1, 1.0, 0.5, 0.1


@pytest.fixture(scope="module")
def reach(tmp_path_factory):
    """The bounds of each file, by the peer."""
    folder = tmp_path_factory.mktemp("reach")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / "bin" / "python"
    subprocess.run([python, "-m", "pip", "install", "--quiet", *NEEDED], check=True)

    def run(files):
        # It writes what it was configured by into the folder that it runs in
        call = [python, PROGRAM, *map(str, files)]
        done = subprocess.run(call, capture_output=True, text=True, check=True, cwd=folder)
        return [json.loads(line) for line in done.stdout.splitlines()]

    return run


def bounds_of(cells):
    """The least and the greatest way, speed, and place across of all cells of a layer."""
    own = [reach for reach in cells if reach is not None]
    return [
        pick(end[side] for end in ends)
        for ends in ([one.s for one in own], [one.speed for one in own], [one.d for one in own])
        for side, pick in enumerate((min, max))
    ]


def test_on_recorded_roads_with_nobody_else(reach):
    files = sorted(RECORDINGS.glob("*.xml"))
    if not files:
        pytest.skip("CommonRoad's scenarios are not here: set RULEC_RECORDINGS")
    compared = 0
    for file, theirs in zip(files, reach(files), strict=True):
        if theirs is None or theirs[0][2] < 0:
            # Of who stands at the start it lets some speed up by less than they may
            continue
        scene = load_scenario(file)
        # It brakes and accelerates alike
        bounds = replace(scene.ego.bounds, acceleration=scene.ego.bounds.braking)
        # In so short a step nobody gets past a crossing
        graph = navigation_graph(
            replace(scene, obstacles=()), step_s=0.1, horizon_s=3.0, bounds=bounds
        )
        for number, (cells, their) in enumerate(zip(graph.reach[::5], theirs, strict=True)):
            own = bounds_of(cells)
            assert -AT_START_M <= own[0] - their[0] <= DRIFT_M, (file.stem, number)
            ends = their[1] > scene.road.s[1] - WITHIN_M
            assert ends or -WITHIN_M <= own[1] - their[1] <= AT_START_M, (file.stem, number)
            assert own[2] == pytest.approx(their[2], abs=WITHIN_MPS), (file.stem, number)
            assert ends or own[3] == pytest.approx(their[3], abs=WITHIN_MPS), (file.stem, number)
            if number < 2:
                # Nor is a road's edge in the way yet
                width, their_width = own[5] - own[4], their[5] - their[4]
                assert width == pytest.approx(their_width, abs=AT_START_M), (file.stem, number)
        compared += 1
    assert compared >= 20

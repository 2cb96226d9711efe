"""Another implementation of coordinates along a road: commonroad-clcs.

It needs libraries of its own, so it lives in an environment made from the package index; hence only
in the long run of the tests.
"""

import json
import os
import random
import subprocess
import sys
from itertools import accumulate
from pathlib import Path

import numpy as np
import pytest

from rulec import read_recording
from rulec.recordings.polylines import densified
from rulec.scenario.recorded.ego_start import ego_start, reference_lanelet
from rulec.scenario.recorded.reference_line import reference_line
from rulec.scenario.recorded.route import lanelets_at, route
from rulec.scenario.scenario_model import Choice
from support.builders.recorded_data import RECORDINGS

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("project_with_clcs.py")
WITHIN_M = 0.2
ACROSS_M = 8.0


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Coordinates along each line, by the peer."""
    folder = tmp_path_factory.mktemp("clcs")
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / "bin" / "python"
    install = [python, "-m", "pip", "install", "--quiet", "commonroad-clcs==2025.2.0"]
    subprocess.run(install, check=True)

    def run(jobs):
        text = "\n".join(
            json.dumps({"line": line.tolist(), "places": places.tolist()}) for line, places in jobs
        )
        done = subprocess.run(
            [python, PROGRAM], input=text, capture_output=True, text=True, check=True
        )
        return [json.loads(line) for line in done.stdout.splitlines()]

    return run


def winding(seed):
    """A road of 200 to 400 m that bends either way, with radii from 40 m and corners 2 m apart."""
    pick = random.Random(seed)
    bends = [pick.uniform(-1, 1) / 40 for _ in range(pick.randint(4, 8))]
    headings = list(accumulate(2.0 * bend for bend in bends for _ in range(25)))
    steps = 2.0 * np.stack((np.cos(headings), np.sin(headings)), axis=1)
    return np.concatenate(([(0.0, 0.0)], np.cumsum(steps, axis=0)))


def beside(line, seed):
    """Places up to 8 m to either side of the line, away from its ends."""
    pick = random.Random(seed)
    found = []
    for _ in range(100):
        k = pick.randrange(5, len(line) - 6)
        ahead = (line[k + 1] - line[k - 1]) / np.hypot(*(line[k + 1] - line[k - 1]))
        far = pick.uniform(-ACROSS_M, ACROSS_M)
        found.append(line[k] + pick.random() * ahead + far * np.array([-ahead[1], ahead[0]]))
    return np.array(found)


def compare(jobs, found):
    """Where the peer lets a line begin is its own affair; everything else is the same."""
    compared = 0
    for (corners, places), theirs in zip(jobs, found, strict=True):
        ours = reference_line(corners).coordinates(places)
        both = [(a, b) for a, b in zip(ours, theirs, strict=True) if b is not None]
        assert len(both) > 0.3 * len(places)
        gaps = np.array([np.subtract(b, a) for a, b in both])
        begin = np.median(gaps[:, 0])
        assert abs(begin) < WITHIN_M
        assert np.abs(gaps[:, 0] - begin).max() < WITHIN_M
        assert np.abs(gaps[:, 1]).max() < WITHIN_M
        compared += len(both)
    return compared


def test_on_winding_roads(project):
    jobs = [(line, beside(line, seed)) for seed in range(30) for line in [winding(seed)]]
    assert compare(jobs, project(jobs)) > 2500


def test_on_recorded_roads(project):
    """The vehicles of every recording that is at hand, along ego's road."""
    files = sorted(RECORDINGS.glob("*.xml"))
    if not files:
        pytest.skip("CommonRoad's scenarios are not here: set RULEC_RECORDINGS")
    jobs = []
    for file in files:
        recording = read_recording(file)
        start = ego_start(recording, Choice(), file.name)
        own = reference_lanelet(recording, Choice(), start.state, file.name)
        way = route(recording, own, lanelets_at(recording, start.targets))
        centre = np.concatenate([recording.lanelets[number].centre for number in way])
        kept = np.append(True, np.hypot(*np.diff(centre, axis=0).T) > 0.05)
        line = reference_line(centre[kept])
        states = [state for one in recording.participants for state in one.states.values()]
        places = np.array([(state.x, state.y) for state in states])[::10]
        s, d = line.coordinates(places).T
        near = (np.abs(d) < ACROSS_M) & (s > 5) & (s < line.length - 5)
        jobs.append((densified(centre[kept], 1.0), places[near]))
    assert compare(jobs, project(jobs)) > 1000

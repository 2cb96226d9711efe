"""Ray, with which planners are trained, and rulec in one environment, as their users have them.

It takes some 250 MB, hence only in the long run of the tests.
"""

import os
import subprocess
from pathlib import Path

import pytest

import rulec
from tools.programs import environment

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("judge_with_ray.py")
TOP = PROGRAM.parents[2]
FILES = [str(TOP / "docs/samples" / name) for name in ("passing.fcd.xml", "passing.net.xml")]


def test_workers_of_ray_judge_as_one_program_does():
    python = environment("ray", "ray>=2.40", str(TOP)) / "bin" / "python"
    done = subprocess.run([python, PROGRAM, *FILES], capture_output=True, text=True, check=True)
    recording, net = FILES
    judged = rulec.verify_recording(recording, "de", map_path=net).rows()
    expected = [f"{row['ego']} {row['satisfied']} {row['violated']}" for row in judged]
    assert expected
    assert sorted(done.stdout.splitlines()) == sorted(expected)

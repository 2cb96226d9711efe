"""Another reader of CommonRoad's files, the format's own: commonroad-io.

It pins an old protobuf and takes 370 MB, so it has an environment of its own; hence only in the
long run of the tests. What it says of the samples is stored beside them, for every run.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

from rulec import read_recording
from support.builders.recorded_data import RECORDINGS
from support.builders.recordings import SAMPLES
from support.oracles.commonroad_io import assert_equal
from tools.programs import environment

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("read_with_commonroad_io.py")
MORE = RECORDINGS.parent / "commonroad_more"
_, *SMALL = SAMPLES
PARTS = [
    file.with_name(file.name.replace("-SC", ""))
    for folder in (SMALL[0].parent, MORE)
    for file in folder.glob("*-SC.pb")
]
FILES = sorted([*RECORDINGS.glob("*.xml"), *MORE.glob("*.xml"), *PARTS])


def read_by_library(files):
    """What the library reads of files, by file."""
    python = environment("commonroad-io", "commonroad-io==2026.1") / "bin" / "python"
    command = [python, PROGRAM, *files]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return dict(zip(files, map(json.loads, done.stdout.splitlines()), strict=True))


@pytest.fixture(scope="module")
def said():
    return read_by_library(FILES)


def test_the_stored_answers_are_the_librarys():
    stored = {file: json.loads(answer.read_text()) for file, answer in SAMPLES.items()}
    assert read_by_library(list(SAMPLES)) == stored


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_field_is_the_same(said, file):
    assert_equal(read_recording(file), said[file])

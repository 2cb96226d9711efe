"""Small files, every field as commonroad-io has read it (`tests/peers/test_commonroad_io.py`)."""

import json

import pytest

from rulec import read_recording
from support.builders.recordings import SAMPLES
from support.oracles.commonroad_io import assert_equal


@pytest.mark.parametrize("file", SAMPLES, ids=lambda file: file.stem)
def test_every_field_is_the_librarys(file):
    assert_equal(read_recording(file), json.loads(SAMPLES[file].read_text()))

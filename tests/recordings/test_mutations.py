"""Whatever mistakes are in files of any format: they are read, or refused in one sentence."""

import os

import pytest

from rulec.recordings.format_table import FORMATS
from rulec.recordings.map_files import MAP_FORMATS
from support.mutations.format_samples import MAPS, RECORDINGS
from support.mutations.trial import read_as_map, read_as_recording, summary, tried

INPUTS = 20_000 if os.environ.get("RULEC_TEST_PROFILE") == "long" else 60
MOST_GROWN_MB = 300
"""Files have a few kilobytes; what else a process keeps is libraries that are loaded late."""


def test_every_format_has_samples():
    assert [*RECORDINGS] == [form.name for form in FORMATS]
    assert [*MAPS] == [form.name for form in MAP_FORMATS]


def assert_none_failed(trial):
    assert trial.inputs == INPUTS
    assert 0 < trial.refused < INPUTS
    assert trial.failures == {}, summary(trial)
    assert trial.grown_mb < MOST_GROWN_MB


@pytest.mark.parametrize("name", RECORDINGS)
def test_recordings_with_mistakes(tmp_path, name):
    samples = list(RECORDINGS[name]())
    assert_none_failed(tried(name, samples, read_as_recording, tmp_path, range(INPUTS)))


@pytest.mark.parametrize("name", MAPS)
def test_maps_with_mistakes(tmp_path, name):
    samples = list(MAPS[name]())
    assert_none_failed(tried(name, samples, read_as_map, tmp_path, range(INPUTS)))

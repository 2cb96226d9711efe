"""Whatever mistakes are in a scenario's bytes: it is read, or refused at a byte of its own."""

import random

from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from support.builders import waymo_files as w

CROSSING = w.crossing(times=[0.1 * k for k in range(81)])


def mutated(content, pick):
    data = bytearray(content)
    for _ in range(pick.randint(1, 5)):
        at = pick.randrange(len(data))
        match pick.randrange(3):
            case 0:
                data[at] ^= 1 << pick.randrange(8)
            case 1:
                del data[at : at + pick.randint(1, 30)]
            case 2:
                data[at:at] = data[at : at + pick.randint(1, 30)]
    return bytes(data)


def read(path, content):
    path.write_bytes(content)
    try:
        for recording in read_recordings(RecordingSource(path)):
            assert recording.step_s > 0
    except RulecError as refused:
        return refused.diagnostics
    return ()


@given(seed=st.integers(0, 2**32))
def test_a_mistake_within_a_record(tmp_path_factory, seed):
    """With a checksum that fits, so that the scenario is looked at."""
    pick = random.Random(seed)
    path = tmp_path_factory.mktemp("mutated") / "some.tfrecord"
    found = read(path, w.record(mutated(CROSSING, pick)))
    assert {x.code for x in found} <= {"R0610"}
    assert all(len(x.message) < 300 and "\n" not in x.message for x in found)


@given(seed=st.integers(0, 2**32))
def test_a_mistake_anywhere(tmp_path_factory, seed):
    pick = random.Random(seed)
    path = tmp_path_factory.mktemp("mutated") / "some.tfrecord"
    found = read(path, mutated(w.record(CROSSING), pick))
    assert {x.code for x in found} == {"R0610"}

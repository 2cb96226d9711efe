"""Whatever mistakes are in a CommonRoad file: it is read, or refused at a line of its own."""

import random

from hypothesis import given
from hypothesis import strategies as st

from rulec import read_recording
from rulec.diagnostics import RulecError
from rulec.scenario import load_scenario
from support.builders.recordings import SAMPLES
from support.generators.mutated_files import mutated

TEXTS = [file.read_text(encoding="utf-8") for file in SAMPLES]
CODES = {"R0610", "R0612"}


@given(seed=st.integers(0, 2**32))
def test_a_mistake_is_read_or_refused(tmp_path_factory, seed):
    pick = random.Random(seed)
    file = tmp_path_factory.mktemp("mutated") / "DEU_Mutated-1_1_T-1.xml"
    data = mutated(pick.choice(TEXTS), pick)
    file.write_bytes(data)
    try:
        recording = read_recording(file)
        assert recording.step_s > 0
        load_scenario(file)
    except RulecError as refused:
        (found,) = refused.diagnostics
        assert found.code in CODES
        assert found.place.file == str(file)
        assert (found.place.line or 1) <= data.count(b"\n") + data.count(b"\r") + 2
        assert "\n" not in found.message
        assert len(found.message) < 300

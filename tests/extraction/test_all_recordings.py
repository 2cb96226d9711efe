"""Every recording that is at hand: each of its vehicles is judged, or it is said why not."""

import pytest

from rulec import read_recording
from rulec.api.rulebook_compilation import machines
from rulec.diagnostics import RulecError
from rulec.extraction.recording_parts import egos_of
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.verdict import Verdict
from rulec.report.verdicts.violation_tally import ViolationTally
from support.builders.recorded_data import RECORDINGS

FILES = sorted(RECORDINGS.glob("*.xml"))
if not FILES:
    pytest.skip(
        "CommonRoad's scenarios are not here: set RULEC_RECORDINGS", allow_module_level=True
    )
PAPER = machines("esterle2019")
ALMOST_ALL = 0.95


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_its_drives(file):
    recording = read_recording(file)
    if not egos_of(recording):
        with pytest.raises(RulecError, match="no vehicle drives in it"):
            RecordingVerdicts(recording, PAPER, RequestedDrives(), file.name)
        return
    judged = RecordingVerdicts(recording, PAPER, RequestedDrives(), file.name)
    tally = ViolationTally()
    seen = []
    for one in judged.answers():
        tally.add(one, [rule.name for rule in judged.rules.rules])
        seen.append(one.ego if isinstance(one, NoDrive) else one.drive.ego)
        if not isinstance(one, NoDrive):
            # Many together are judged as each alone
            assert isinstance(one.answer, Verdict)
            assert one.answer == verify(one.drive.trace, judged.rules)
    assert list(dict.fromkeys(seen)) == list(judged.egos)
    assert tally.judged >= ALMOST_ALL * len(judged.egos)

"""Recordings before a rulebook, as mappings that tests can look into."""

from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.verdict import Verdict


def violated(found, book, **wanted):
    """Ego -> the rules that it violated, with when first (s of the recording)."""
    judged = RecordingVerdicts(
        found, book, RequestedDrives(**{"defaults": True, **wanted}), "by hand"
    )
    answers = {}
    for one in judged.answers():
        assert not isinstance(one, NoDrive)
        assert isinstance(one.answer, Verdict), one.answer
        times = answers.setdefault(one.drive.ego, {})
        for violation in one.answer.violations:
            at = one.drive.time_s(violation.step)
            times[violation.rule] = min(at, times.get(violation.rule, at))
    return answers

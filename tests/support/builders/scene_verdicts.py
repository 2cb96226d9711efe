"""Verdicts on all drives of a recording, in a form that is compared."""

from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.monitoring.verdict import NotJudged


def verdicts(recording, rulebook):
    """Ego and start -> the violations, and which rules are open or cannot be judged."""
    found = {}
    for answer in RecordingVerdicts(recording, rulebook, RequestedDrives(), "some").answers():
        if isinstance(answer, DriveVerdict) and not isinstance(answer.answer, NotJudged):
            verdict, drive = answer.answer, answer.drive
            violated = {(x.rule, x.step, tuple(x.binding.items())) for x in verdict.violations}
            others = {x.rule for x in verdict.open}, {x.rule for x in verdict.not_judged}
            found[drive.ego, drive.start_s] = violated, *others
    return found

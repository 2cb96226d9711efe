"""Verdicts on recorded drives as JSON, a line each; docs/recordings.md describes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import NotJudged
from rulec.report.json_document import JsonDocument, as_line
from rulec.report.verdicts.recording_table import defaulted_names
from rulec.report.verdicts.verdict_json import (
    TraceNotJudged,
    TraceVerdict,
    error_data,
    violations_data,
)


class RecordedVerdict(TraceVerdict, frozen=True, kw_only=True):
    """The verdict on the drive of vehicle ``trace``, in the recording's times."""

    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    start_s: float
    step_s: float
    by_default: Sequence[str]


class RecordedNotJudged(TraceNotJudged, frozen=True, kw_only=True):
    """A drive that could not be judged."""

    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    start_s: float
    step_s: float
    by_default: Sequence[str]


class NotDriven(JsonDocument, frozen=True, kw_only=True):
    """A vehicle without a drive to judge, and ``why_not``."""

    trace: str
    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    why_not: str


def as_json(
    result: DriveVerdict | NoDrive, verdicts: RecordingVerdicts, explained: Sequence[Explanation]
) -> str:
    """Write a vehicle's verdict with explanations of its first violations."""
    recorded: dict[str, Any] = {
        "recording": verdicts.recording.name,
        "mirrored": verdicts.mirrored,
        "remarks": verdicts.recording.remarks or UNSET,
    }
    if isinstance(result, NoDrive):
        return as_line(NotDriven(trace=result.ego, why_not=result.why, **recorded))
    drive, answer = result.drive, result.answer
    recorded |= {
        "start_s": drive.start_s,
        "step_s": drive.trace.step_s,
        "by_default": defaulted_names(verdicts, drive.words),
    }
    if isinstance(answer, NotJudged):
        error = error_data(answer.error)
        return as_line(RecordedNotJudged(trace=answer.trace, error=error, **recorded))
    by_rule = verdicts.by_default(drive.words)
    violations = [
        replace(data, time_s=drive.time_s(violation.step), by_default=by_rule[violation.rule])
        for violation, data in zip(
            answer.violations, violations_data(answer, verdicts.rules, explained), strict=True
        )
    ]
    return as_line(
        RecordedVerdict(
            trace=answer.trace, satisfied=answer.satisfied, violations=violations, **recorded
        )
    )

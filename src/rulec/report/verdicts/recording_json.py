"""Verdicts on recorded vehicles as JSON, a line for each."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest
from typing import Any

from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.violation_evidence import ViolationEvidence, evidence_of
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.verdict import NotJudged
from rulec.report.json_document import JsonDocument, as_line, filled
from rulec.report.verdicts import verdict_json


class RecordedVerdict(verdict_json.TraceVerdict, frozen=True, kw_only=True):
    """The verdict on the drive of vehicle ``trace``, in the recording's times."""

    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    start_s: float
    step_s: float
    by_default: Sequence[str]


class RecordedNotJudged(verdict_json.TraceNotJudged, frozen=True, kw_only=True):
    """A drive that could not be judged."""

    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    start_s: float
    step_s: float
    by_default: Sequence[str]


class NotDriven(JsonDocument, frozen=True, kw_only=True):
    """A vehicle without a drive to judge; ``why_not`` is the reason."""

    trace: str
    rulebook: str
    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    why_not: str


def _margin_data(margin: Margin) -> verdict_json.MarginData:
    value, limit = margin.value_bounds, margin.limit_bounds
    return filled(
        verdict_json.MarginData,
        margin,
        value=margin.value if value is None else _bounds_data(*value),
        limit=margin.limit if limit is None else _bounds_data(*limit),
        value_error=margin.value_error if value is None else 0.0,
        limit_error=margin.limit_error if limit is None else 0.0,
    )


def _bounds_data(low: float, high: float) -> verdict_json.BoundsData:
    return verdict_json.BoundsData(low=low, high=high)


def _evidence_data(evidence: ViolationEvidence) -> verdict_json.EvidenceData:
    place = evidence.place
    return filled(
        verdict_json.EvidenceData,
        evidence,
        margins=[_margin_data(margin.rounded()) for margin in evidence.margins],
        place=None if place is None else filled(verdict_json.DrivePlaceData, place),
        whom=evidence.whom or UNSET,
    )


def as_json(
    result: DriveVerdict | NoDrive, verdicts: RecordingVerdicts, explained: Sequence[Explanation]
) -> str:
    """Write a vehicle's verdict with explanations of its first violations."""
    recorded: dict[str, Any] = {
        "rulebook": verdicts.rules.name,
        "recording": verdicts.recording.name,
        "mirrored": verdicts.mirrored,
        "remarks": verdicts.recording.remarks or UNSET,
    }
    if isinstance(result, NoDrive):
        return as_line(NotDriven(trace=result.ego, why_not=result.why, **recorded))
    drive, answer = result.drive, result.answer
    recorded |= {
        "start_s": drive.start_s,
        "step_s": drive.arrays.step_s,
        "by_default": verdicts.defaulted(drive.words),
    }
    if isinstance(answer, NotJudged):
        error = verdict_json.error_data(answer.error)
        return as_line(RecordedNotJudged(trace=answer.trace, error=error, **recorded))
    by_rule = verdicts.by_default(drive.words)
    data = verdict_json.violations_data(answer, verdicts.rules, explained)
    violations = [
        replace(
            written,
            time_s=drive.time_s(violation.step),
            by_default=by_rule[violation.rule],
            evidence=_evidence_data(
                evidence_of(violation, drive, verdicts.rules, verdicts.request.assumed, explanation)
            ),
        )
        for violation, written, explanation in zip_longest(answer.violations, data, explained)
    ]
    return as_line(
        filled(
            RecordedVerdict,
            answer,
            law=filled(verdict_json.LawData, edition_of(verdicts.rules)),
            violations=violations,
            **verdict_json.doubts(answer, verdicts.rules),
            **recorded,
        )
    )

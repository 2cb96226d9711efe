"""Verdicts on recorded vehicles as JSON, a line for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import Any

from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.violation_evidence import evidence_of
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.moments.opportunity_outcomes import Opportunity, Outcome
from rulec.monitoring.verdict import NotJudged
from rulec.report.json_document import JsonDocument, JsonPart, as_line, filled
from rulec.report.verdicts.verdict_json import (
    BoundsData,
    EvidenceData,
    MarginData,
    TraceNotJudged,
    TraceVerdict,
    error_data,
    verdict_fields,
    violations_data,
)


class OpportunityData(JsonPart, frozen=True, kw_only=True):
    """An opportunity to violate a rule, and what became of it: open if it may be violated.

    There is perhaps none if it is not ``certain``.
    """

    rule: str
    binding: Mapping[str, str]
    from_s: float
    to_s: float
    outcome: Outcome
    certain: bool


class RecordedVerdict(TraceVerdict, frozen=True, kw_only=True):
    """The verdict on the drive of vehicle ``trace``, in the recording's times.

    With ``--why``, ``opportunities`` are all to violate the ``judged`` rules, and ``idle`` those of
    these rules that it gave none for.
    """

    recording: str
    mirrored: bool
    remarks: Sequence[str] | UnsetType = UNSET
    start_s: float
    step_s: float
    by_default: Sequence[str]
    idle: Sequence[str] | UnsetType = UNSET
    opportunities: Sequence[OpportunityData] | UnsetType = UNSET


class RecordedNotJudged(TraceNotJudged, frozen=True, kw_only=True):
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


def _margin_data(margin: Margin) -> MarginData:
    own: dict[str, Any] = {}
    for side, bounds in (("value", margin.value_bounds), ("limit", margin.limit_bounds)):
        if bounds is not None:
            own |= {side: BoundsData(low=bounds[0], high=bounds[1]), f"{side}_error": 0.0}
    return filled(MarginData, margin, **own)


def as_json(
    result: DriveVerdict | NoDrive,
    verdicts: RecordingVerdicts,
    explained: Sequence[Explanation],
    opportunities: Sequence[Opportunity] | None = None,
) -> str:
    """Write a vehicle's verdict with explanations of its first violations."""
    rules = verdicts.rules
    recorded: dict[str, Any] = {
        "rulebook": rules.name,
        "recording": verdicts.recording.name,
        "mirrored": verdicts.mirrored,
        "remarks": verdicts.recording.remarks or None,
    }
    if isinstance(result, NoDrive):
        return as_line(filled(NotDriven, trace=result.ego, why_not=result.why, **recorded))
    drive, answer = result.drive, result.answer
    recorded |= {
        "start_s": drive.start_s,
        "step_s": drive.arrays.step_s,
        "by_default": verdicts.defaulted(drive.words),
    }
    if isinstance(answer, NotJudged):
        error = error_data(answer.error)
        return as_line(filled(RecordedNotJudged, answer, error=error, **recorded))
    by_rule = verdicts.by_default(drive.words)
    violations = []
    written = violations_data(answer, rules, explained)
    for violation, data, explanation in zip_longest(answer.violations, written, explained):
        evidence = evidence_of(violation, drive, rules, verdicts.request.assumed, explanation)
        margins = [_margin_data(margin.rounded()) for margin in evidence.margins]
        further = {
            "time_s": drive.time_s(violation.step),
            "by_default": by_rule[violation.rule],
            "evidence": filled(EvidenceData, evidence, margins=margins),
        }
        violations.append(replace(data, **further))
    about = verdict_fields(answer, rules) | recorded
    if opportunities is not None:
        met = {*answer.kept_regardless}.union(x.rule for x in opportunities)
        about["idle"] = [name for name in about["judged"] if name not in met]
        about["opportunities"] = [
            filled(OpportunityData, x, from_s=drive.time_s(x.first), to_s=drive.time_s(x.last))
            for x in opportunities
        ]
    return as_line(filled(RecordedVerdict, answer, violations=violations, **about))

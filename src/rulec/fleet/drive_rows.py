"""The rows of a drive: one for the drive, one per rule and one per finding.

Findings of a fleet may be added up only if the identity of their judgement is the same: rulebook,
version, thresholds and assumptions, as texts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from math import hypot

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.lost_drives import lost_drive
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traffic_thresholds import USUAL
from rulec.fleet.finding_columns import COLUMNS, Cell, Row
from rulec.monitoring.moments.drive_facts import DriveFacts, facts_of
from rulec.monitoring.moments.exposure import Exposure
from rulec.monitoring.rulebook_edition import rulebook_hash
from rulec.monitoring.verdict import NotJudged, OutcomeName, Verdict
from rulec.report.findings.findings_of_drives import DriveFindings
from rulec.report.findings.verdict_finding import COLUMNS as OF_FINDINGS
from rulec.report.findings.verdict_finding import VerdictFinding, named_rule
from rulec.trace import Value
from rulec.value_display import short_repr
from rulec.version import __version__

MOVED_M = 0.5
"""Recorded positions fluctuate by less than this (m), even of standing vehicles."""

OUTCOMES: Mapping[bool | None, OutcomeName] = {True: "kept", False: "violated", None: "open"}
"""Verdict on a drive's hard rules -> its name in the table."""


def reason_of(error: RulecError, own: Mapping[str, object]) -> str:
    """Why something cannot be judged, and the way out; with the file, if that is another one."""
    first = error.diagnostics[0]
    file = first.place.file if first.place is not None else ""
    is_other = file and file not in (own.get("file"), own.get("recording"))
    where = f" ({file})" if is_other and file not in first.message else ""
    return f"{first.message}{where}{f'; {first.help}' if first.help else ''}"


@dataclass(frozen=True, slots=True)
class DriveRows:
    """Makes rows from verdicts by ``rules``; the rows state what the drives were judged ``by``."""

    rules: CompiledRulebook
    by: JudgedBy
    shared: Row = field(init=False)
    _of_rules: Mapping[str, Row] = field(init=False)

    def __post_init__(self) -> None:
        of_rules = {rule.name: named_rule(rule) for rule in self.rules.rules}
        object.__setattr__(self, "_of_rules", of_rules)
        object.__setattr__(self, "shared", self.by.columns())

    def of_recording(self, verdicts: RecordingVerdicts, file: str) -> Iterator[Row]:
        """The rows of all drives of a recording, and of vehicles that have none."""
        for answer in verdicts.answers():
            try:
                rows = list(self.of_answer(answer, verdicts, file))
            except Exception as problem:
                drive = answer.drive.arrays.id if isinstance(answer, DriveVerdict) else answer.ego
                rows = list(self.of_answer(lost_drive(drive, problem), verdicts, file))
            yield from rows

    def of_answer(
        self,
        answer: DriveVerdict | NoDrive,
        verdicts: RecordingVerdicts,
        file: str,
        findings: Sequence[VerdictFinding] | None = None,
    ) -> Iterator[Row]:
        """The rows of a drive of a recording, or of a vehicle that has no drive.

        If ``findings`` is None, the drive's findings are computed here.
        """
        recording = verdicts.recording
        own = {
            "file": file,
            "recording": recording.name,
            "source": recording.form,
            "country": recording.country,
        }
        remarks = tuple(recording.remarks)
        if isinstance(answer, NoDrive):
            named = {"vehicle": answer.ego, "ego": answer.ego}
            yield {**self.of_nothing({**own, **named}, answer.why), "remarks": remarks}
        else:
            if findings is None:
                findings = DriveFindings(verdicts, file).add(answer)
            for row in self._of_drive(answer, own, findings):
                yield {**row, "remarks": remarks} if row["kind"] == "drive" else row

    def of_trace(
        self,
        facts: DriveFacts,
        verdict: Verdict,
        own: Row,
        findings: Sequence[VerdictFinding],
    ) -> Iterator[Row]:
        """The rows of a trace and its ``findings``; ``own`` are the columns that identify it."""
        times = (0.0, round((facts.n_states - 1) * facts.step_s, 9))
        yield self._judged(own, verdict, facts, times)
        yield from self._rules(own, verdict, facts)
        yield from self._findings(own, verdict, findings)

    def of_nothing(self, own: Row, why: str) -> Row:
        """The row for something not judged: a file, a recording, a vehicle or a trace."""
        return {**self.shared, **own, "kind": "drive", "outcome": "not_judged", "because": why}

    def _of_drive(
        self, result: DriveVerdict, own: Row, findings: Sequence[VerdictFinding]
    ) -> Iterator[Row]:
        drive, verdict = result.drive, result.answer
        own = {**own, "vehicle": drive.arrays.id, "ego": drive.ego}
        if isinstance(verdict, NotJudged):
            yield self.of_nothing(own, reason_of(verdict.error, own))
            return
        times = (drive.time_s(0), drive.time_s(None))
        facts = facts_of(drive.arrays, self.rules, verdict)
        yield {**self._judged(own, verdict, facts, times), "distance_m": driven_m(drive)}
        yield from self._rules(own, verdict, facts)
        yield from self._findings(own, verdict, findings)

    def _judged(
        self, own: Row, verdict: Verdict, facts: DriveFacts, times: tuple[float, float]
    ) -> dict[str, Cell]:
        faults = [fault.diagnostics[0].message for fault in verdict.faults]
        return {
            **self.shared,
            **own,
            **({"because": "; ".join(dict.fromkeys(faults))} if faults else {}),
            "kind": "drive",
            "outcome": OUTCOMES[verdict.satisfied],
            "from_s": times[0],
            "to_s": times[1],
            "road": facts.road,
            "states": facts.n_states,
            # Each state stands for the time until the next one, the last state for one step.
            "duration_s": round(facts.n_states * facts.step_s, 9),
        }

    def _rules(self, own: Row, verdict: Verdict, facts: DriveFacts) -> Iterator[Row]:
        """A row for each rule: its worst outcome, and how often the rule was put to the test."""
        outcomes: dict[str, str] = dict.fromkeys(self._of_rules, "kept")
        outcomes |= {result.rule: "open" for result in verdict.open}
        outcomes |= {violation.rule: "violated" for violation in verdict.violations}
        not_judged = {rule.rule: rule for rule in verdict.not_judged}
        outcomes |= dict.fromkeys(not_judged, "not_judged")
        shared = {**self.shared, **own, "kind": "rule"}
        for name, about in self._of_rules.items():
            row: dict[str, Cell] = {**shared, **about, "outcome": outcomes[name]}
            if name in not_judged:
                untold = not_judged[name]
                row |= {"open_on": tuple(untold.untold), "because": untold.why}
            if name in facts.exposure:
                exposure = facts.exposure[name]
                row |= {field.name: getattr(exposure, field.name) for field in _EXPOSURE}
            yield row

    def _findings(
        self, own: Row, verdict: Verdict, findings: Sequence[VerdictFinding]
    ) -> Iterator[Row]:
        """A row for each violation, with the state that decided it, and for each open rule."""
        violations = iter(verdict.violations)
        for finding in findings:
            if finding.outcome == "not_judged":
                continue  # its rule's row says so
            row: dict[str, Cell] = {**finding.row(), **self.shared, **own, "kind": "finding"}
            if finding.outcome == "violated":
                row |= {"state": next(violations).step}
            yield row


def driven_m(drive: Drive) -> float | None:
    """The distance that ego drove (m) along its positions; None if these are unknown.

    Recorded positions fluctuate: one counts only if it is at least ``MOVED_M`` from the last one
    counted.
    """
    places = drive.places
    if not places:
        return None
    driven = 0.0
    x, y = places[0].x, places[0].y
    for place in places:
        moved = hypot(place.x - x, place.y - y)
        if moved >= MOVED_M:
            driven += moved
            x, y = place.x, place.y
    return round(driven + hypot(places[-1].x - x, places[-1].y - y), 2)


_EXPOSURE = fields(Exposure)

assert {field.name for field in _EXPOSURE} <= set(COLUMNS), "exposure has columns of its own"
assert set(OF_FINDINGS) <= set(COLUMNS), "findings have no columns of their own"


@dataclass(frozen=True, slots=True)
class JudgedBy:
    """The rulebook's name and hash, the version of rulec, and the options chosen.

    ``thresholds`` are those that differ from this version's defaults, such as ``near_m=200``;
    ``assumptions`` are values, ``defaults``, ``as recorded`` and ``ends=cut``: both sorted,
    separated by ``; `` and written as options are.
    """

    __repr__ = short_repr

    rulebook: str
    rulebook_hash: str
    rulec: str = __version__
    thresholds: str = ""
    assumptions: str = ""

    def columns(self) -> dict[str, str]:
        """The fields as columns of a table of findings."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def judged_by(rules: CompiledRulebook, request: RequestedDrives, ends: str = "") -> JudgedBy:
    """What drives are judged by; ``ends`` is how traces are assumed to end, if that is chosen."""
    given = request.thresholds
    chosen = {
        field.name: getattr(given, field.name)
        for field in fields(given)
        if getattr(given, field.name) != getattr(USUAL, field.name)
    }
    flags = {"defaults": request.defaults, "as recorded": request.as_recorded}
    assumed = [*_pairs(request.assumed), *(name for name, holds in flags.items() if holds)]
    return JudgedBy(
        rules.name,
        rulebook_hash(rules),
        thresholds="; ".join(_pairs(chosen)),
        assumptions="; ".join([*assumed, *([f"ends={ends}"] if ends else [])]),
    )


def _pairs(values: Mapping[str, Value]) -> list[str]:
    return [f"{name}={_written(value)}" for name, value in sorted(values.items())]


def _written(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)

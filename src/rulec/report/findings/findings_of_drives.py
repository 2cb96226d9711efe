"""The findings of recorded drives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from rulec.diagnostics import RulecError
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.violation_evidence import evidence_of
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import NotJudged, RuleNotJudged, Violation
from rulec.report.findings.verdict_finding import FindingSource, RecordingFindings, VerdictFinding


@dataclass
class GatheredFindings:
    """The results of some drives: findings, rules not judged, and the names of judged drives."""

    findings: list[VerdictFinding] = field(default_factory=list)
    not_judged: dict[str, dict[str, RuleNotJudged]] = field(default_factory=dict)
    judged: list[str] = field(default_factory=list)

    def include(self, later: GatheredFindings) -> None:
        """Add the findings of later drives."""
        self.findings += later.findings
        self.judged += later.judged
        for rule, by_drive in later.not_judged.items():
            self.not_judged.setdefault(rule, {}).update(by_drive)


class DriveFindings:
    """The findings of a recording, gathered drive by drive."""

    def __init__(self, verdicts: RecordingVerdicts, file: str) -> None:
        self.gathered = GatheredFindings()
        self._verdicts, self._file = verdicts, file
        self._source = FindingSource(verdicts.rules, file, verdicts.recording.name)

    def add(
        self, result: DriveVerdict | NoDrive, explained: Sequence[Explanation] = ()
    ) -> Sequence[VerdictFinding]:
        """Add the findings of a drive; ``explained`` are explanations of its first violations.

        Returns the drive's findings: first violations, then open verdicts, in the verdict's order.
        """
        found = list(self._found(result, explained))
        self.gathered.findings += found
        return found

    def violated(
        self, violation: Violation, drive: Drive, explanation: Explanation | None
    ) -> VerdictFinding:
        """The finding of a violation; ``explanation`` explains it, if already made."""
        rules, assumed = self._verdicts.rules, self._verdicts.request.assumed
        evidence = evidence_of(violation, drive, rules, assumed, explanation)
        return self._source.violated(
            violation,
            drive.arrays.id,
            evidence.margins,
            other=(*violation.binding.values(), *evidence.whom),
            from_s=evidence.from_s,
            to_s=evidence.to_s,
            at_s=evidence.at_s,
            rests_on=evidence.rests_on,
            **({} if evidence.place is None else evidence.place._asdict()),
        )

    def _found(
        self, result: DriveVerdict | NoDrive, explained: Sequence[Explanation]
    ) -> Iterator[VerdictFinding]:
        if isinstance(result, NoDrive):
            yield self._source.nothing_judged(result.ego, result.why)
            return
        drive, answer, vehicle = result.drive, result.answer, result.drive.arrays.id
        if isinstance(answer, NotJudged):
            yield self._source.nothing_judged(vehicle, answer.error.diagnostics[0].message)
            return
        self.gathered.judged.append(vehicle)
        for number, violation in enumerate(answer.violations):
            explanation = explained[number] if number < len(explained) else None
            yield self.violated(violation, drive, explanation)
        for doubtful in answer.open:
            yield self._source.left_open(doubtful, vehicle, drive.time_s(0), drive.time_s(None))
        for rule in answer.not_judged:
            self.gathered.not_judged.setdefault(rule.rule, {})[vehicle] = rule

    def whole(self) -> RecordingFindings:
        """All findings; a rule that is judged in no drive gives one finding."""
        drives = tuple(self.gathered.judged)
        findings = [*self.gathered.findings]
        for by_drive in self.gathered.not_judged.values():
            everywhere = len(by_drive) == len(drives)
            for vehicle, rule in [*by_drive.items()][: 1 if everywhere else None]:
                findings.append(self._source.not_judged(rule, "" if everywhere else vehicle))
        return RecordingFindings(self._file, self._verdicts.recording.name, drives, tuple(findings))


def not_judged_file(file: str, error: RulecError, rulebook: str) -> RecordingFindings:
    """The finding that a file could not be judged."""
    why = error.diagnostics[0].message
    finding = VerdictFinding(file=file, rulebook=rulebook, outcome="not_judged", because=why)
    return RecordingFindings(file, "", (), (finding,))

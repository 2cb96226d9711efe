"""The findings of recorded drives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.diagnostics import RulecError
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.violation_evidence import evidence_of
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import NotJudged, RuleNotJudged, Violation
from rulec.report.findings.verdict_finding import (
    RecordingFindings,
    VerdictFinding,
    left_open,
    measured,
    named_law,
    named_rule,
    not_judged,
)


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


@dataclass
class DriveFindings:
    """The findings of a recording, gathered drive by drive."""

    verdicts: RecordingVerdicts
    file: str
    gathered: GatheredFindings = field(default_factory=GatheredFindings)

    def add(
        self, result: DriveVerdict | NoDrive, explained: Sequence[Explanation] = ()
    ) -> Sequence[VerdictFinding]:
        """Add the findings of a drive; ``explained`` are explanations of its first violations.

        Returns the drive's findings: first violations, then open verdicts, in the verdict's order.
        """
        before = len(self.gathered.findings)
        self._take(result, explained)
        return self.gathered.findings[before:]

    def _take(self, result: DriveVerdict | NoDrive, explained: Sequence[Explanation]) -> None:
        if isinstance(result, NoDrive):
            own = self._own(vehicle=result.ego, because=result.why)
            self.gathered.findings.append(VerdictFinding(outcome="not_judged", **own))
            return
        drive, answer = result.drive, result.answer
        if isinstance(answer, NotJudged):
            why = answer.error.diagnostics[0].message
            own = self._own(vehicle=drive.arrays.id, because=why)
            self.gathered.findings.append(VerdictFinding(outcome="not_judged", **own))
            return
        self.gathered.judged.append(drive.arrays.id)
        for number, violation in enumerate(answer.violations):
            explanation = explained[number] if number < len(explained) else None
            found = violated(violation, drive, self.verdicts, explanation, self.file)
            self.gathered.findings.append(found)
        rules = {rule.name: rule for rule in self.verdicts.rules.rules}
        for result_ in answer.open:
            finding = VerdictFinding(
                vehicle=drive.arrays.id,
                from_s=drive.time_s(0),
                to_s=drive.time_s(None),
                **left_open(result_),
                **self._about(rules[result_.rule]),
            )
            self.gathered.findings.append(finding)
        for rule in answer.not_judged:
            self.gathered.not_judged.setdefault(rule.rule, {})[drive.arrays.id] = rule

    def whole(self) -> RecordingFindings:
        """All findings; a rule that is judged in no drive gives one finding."""
        drives = tuple(self.gathered.judged)
        return RecordingFindings(
            self.file,
            self.verdicts.recording.name,
            drives,
            (*self.gathered.findings, *self._rules_not_judged(len(drives))),
        )

    def _rules_not_judged(self, drives: int) -> Iterator[VerdictFinding]:
        rules = {rule.name: rule for rule in self.verdicts.rules.rules}
        for name, by_drive in self.gathered.not_judged.items():
            everywhere = len(by_drive) == drives
            for vehicle, rule in [*by_drive.items()][: 1 if everywhere else None]:
                # A rule that is too large at the recording's step is not among the compiled rules.
                too_large = self._own(rule=name, strength=rule.strength)
                yield VerdictFinding(
                    vehicle="" if everywhere else vehicle,
                    **not_judged(rule),
                    **(self._about(rules[name]) if name in rules else too_large),
                )

    def _own(self, **fields: Any) -> dict[str, Any]:
        where = {"file": self.file, "recording": self.verdicts.recording.name}
        return {**where, **named_law(self.verdicts.rules), **fields}

    def _about(self, rule: CompiledRule) -> dict[str, Any]:
        return self._own(**named_rule(rule))


def violated(
    violation: Violation,
    drive: Drive,
    verdicts: RecordingVerdicts,
    explanation: Explanation | None,
    file: str = "",
) -> VerdictFinding:
    """The finding of a violation in a drive; ``explanation`` explains it, if already made."""
    evidence = evidence_of(violation, drive, verdicts.rules, verdicts.request.assumed, explanation)
    place = {} if evidence.place is None else evidence.place._asdict()
    rules = {rule.name: rule for rule in verdicts.rules.rules}
    return VerdictFinding(
        file=file,
        recording=verdicts.recording.name,
        outcome="violated",
        vehicle=drive.arrays.id,
        other=(*violation.binding.values(), *evidence.whom),
        from_s=evidence.from_s,
        to_s=evidence.to_s,
        at_s=evidence.at_s,
        rests_on=evidence.rests_on,
        **measured(evidence.margins),
        **place,
        **named_law(verdicts.rules),
        **named_rule(rules[violation.rule]),
    )


def not_judged_file(file: str, error: RulecError, rulebook: str) -> RecordingFindings:
    """The finding that a file could not be judged."""
    why = error.diagnostics[0].message
    finding = VerdictFinding(file=file, rulebook=rulebook, outcome="not_judged", because=why)
    return RecordingFindings(file, "", (), (finding,))

"""What is told of a recorded drive beyond its verdict: explanations, and findings with evidence."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.traces.recorded_drive import Drive
from rulec.extraction.violation_evidence import trace_for, whom_of
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.verdict import NotJudged, Violation
from rulec.report.findings.findings_of_drives import DriveFindings
from rulec.report.findings.verdict_finding import VerdictFinding
from rulec.report.verdicts import verdict_report
from rulec.report.verdicts.state_times import StateTimes
from rulec.report.verdicts.violation_table import tables


class DriveAccounts:
    """Accounts of a recording's drives, and its findings as far as they are wanted."""

    def __init__(self, verdicts: RecordingVerdicts, file: str) -> None:
        self._verdicts = verdicts
        self.findings = DriveFindings(verdicts, file)

    def finding(
        self, violation: Violation, drive: Drive, explanation: Explanation | None
    ) -> VerdictFinding:
        """A violation as a finding."""
        return self.findings.violated(violation, drive, explanation)

    def explained(self, violations: Sequence[Violation], drive: Drive) -> list[Explanation]:
        """Explanations of violations of a drive."""
        rules = self._verdicts.rules
        return [
            explain(violation, trace_for(violation, drive, rules), rules, drive.decided_by)
            for violation in violations
        ]

    def details(
        self,
        result: DriveVerdict,
        explained: Sequence[Explanation],
        *,
        width: int,
        every_part: bool,
    ) -> str:
        """A drive's violations as text, with explanations of the first ones."""
        verdict, drive, rules = result.answer, result.drive, self._verdicts.rules
        assert not isinstance(verdict, NotJudged), "it has been judged"
        most = verdict_report.MOST_VIOLATIONS
        times = StateTimes(drive.start_s, drive.arrays.step_s)
        return verdict_report.as_text(
            verdict,
            rules,
            tables(explained[:most], rules, every_part=every_part, width=width, times=times),
            width=width,
            doubts=False,
            whom=[whom_of(explanation, drive) for explanation in explained],
            times=times,
        )

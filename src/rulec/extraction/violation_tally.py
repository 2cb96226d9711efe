"""A tally of violations over the drives of a recording."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.monitoring.verdict import Verdict


@dataclass(slots=True)
class ViolationTally:
    """Verdicts, counted drive by drive.

    ``first_s``: rule -> drive -> time of its first violation (s of the recording). ``words`` are
    the names of the signals that every drive supplies.
    """

    satisfied: list[str] = field(default_factory=list)
    violated: list[str] = field(default_factory=list)
    not_judged: list[NoDrive] = field(default_factory=list)
    first_s: dict[str, dict[str, float]] = field(default_factory=dict)
    words: frozenset[str] | None = None

    @property
    def judged(self) -> int:
        """The number of drives that have a verdict."""
        return len(self.satisfied) + len(self.violated)

    def add(self, verdict: DriveVerdict | NoDrive) -> None:
        """Count a drive."""
        if isinstance(verdict, NoDrive):
            self.not_judged.append(verdict)
            return
        drive, answer = verdict.drive, verdict.answer
        if not isinstance(answer, Verdict):
            self.not_judged.append(NoDrive(drive.ego, answer.error.diagnostics[0].message))
            return
        self.words = drive.words if self.words is None else self.words & drive.words
        (self.satisfied if answer.satisfied else self.violated).append(drive.trace.id)
        for violation in answer.violations:
            times = self.first_s.setdefault(violation.rule, {})
            at = drive.time_s(violation.step)
            times[drive.trace.id] = min(at, times.get(drive.trace.id, at))

"""Which rules were violated by whom, and when first."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.extraction.drives import NoDrive
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.monitoring.verdict import Verdict


@dataclass(slots=True)
class ViolationTally:
    """Filled drive by drive.

    ``first_s``: rule -> vehicle -> when it first violated it (s of the recording). ``words`` are
    those that every drive supplies.
    """

    satisfied: list[str] = field(default_factory=list)
    violated: list[str] = field(default_factory=list)
    not_judged: list[NoDrive] = field(default_factory=list)
    first_s: dict[str, dict[str, float]] = field(default_factory=dict)
    words: frozenset[str] | None = None

    @property
    def judged(self) -> int:
        """How many drives have a verdict."""
        return len(self.satisfied) + len(self.violated)

    def add(self, one: DriveVerdict | NoDrive) -> None:
        """Count a drive."""
        if isinstance(one, NoDrive):
            self.not_judged.append(one)
            return
        drive = one.drive
        if not isinstance(one.answer, Verdict):
            self.not_judged.append(NoDrive(drive.ego, one.answer.error.diagnostics[0].message))
            return
        self.words = drive.words if self.words is None else self.words & drive.words
        (self.satisfied if one.answer.satisfied else self.violated).append(drive.trace.id)
        for violation in one.answer.violations:
            times = self.first_s.setdefault(violation.rule, {})
            at = drive.time_s(violation.step)
            times[drive.trace.id] = min(at, times.get(drive.trace.id, at))

"""The verdicts on recorded drives, each vehicle being ego in turn, and their sums."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.drives import NoDrive
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.to_trace import Drive
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.scenario.recorded.recording import Recording
from rulec.value_display import Rows, short_repr

MOST_STATES = 1 << 13
"""Drives are verified together once they have this many states; more take more memory."""


@dataclass(frozen=True, slots=True)
class DriveVerdict:
    """A drive and the rulebook's verdict on it."""

    __repr__ = short_repr

    drive: Drive
    answer: Verdict | NotJudged


class RecordingVerdicts(Rows):
    """The verdicts of a rulebook on a recording's drives, computed on demand.

    Raises RulecError R0407 if the rulebook has bounds that are no multiples of the recording's
    step, R0507 if it was compiled for another step, R0612 for a vehicle that is not there.
    """

    def __init__(
        self, recording: Recording, rulebook: CompiledRulebook, request: RequestedDrives, file: str
    ) -> None:
        self.request = request
        self.rules = rulebook.fitted_to(recording.step_s)
        formulas = [rule.formula for rule in self.rules.rules]
        formulas += [axiom.formula for axiom in self.rules.axioms]
        self.drives = selected_drives(
            recording,
            request,
            file,
            traffic=self.rules.traffic,
            vocabulary=self.rules.vocabulary,
            names=frozenset(name for formula in formulas for name in names_in(formula)),
        )
        self.recording = self.drives.recording
        self.mirrored = self.drives.mirrored
        self.egos = self.drives.egos

    def answers(self) -> Iterator[DriveVerdict | NoDrive]:
        """The verdict on each drive, in the order of the file."""
        waiting: list[Drive | NoDrive] = []
        states = 0
        for drive in (drive for ego in self.egos for drive in self.drives.of(ego)):
            waiting.append(drive)
            states += len(drive.trace.states) if isinstance(drive, Drive) else 0
            if states >= MOST_STATES:
                yield from self._verified(waiting)
                waiting, states = [], 0
        yield from self._verified(waiting)

    def _verified(self, drives: list[Drive | NoDrive]) -> Iterator[DriveVerdict | NoDrive]:
        traces = [drive.trace for drive in drives if isinstance(drive, Drive)]
        answers = iter(verify_chunk(traces, self.rules))
        for drive in drives:
            yield DriveVerdict(drive, next(answers)) if isinstance(drive, Drive) else drive

    def by_default(self, words: frozenset[str]) -> dict[str, tuple[str, ...]]:
        """Rule -> names beyond ``words`` that it reads, which have their defaults in all states."""
        declared = self.rules.vocabulary.declarations
        by_rule = {}
        for rule in self.rules.rules:
            missing = set(names_in(rule.formula)) - words
            by_rule[rule.name] = tuple(name for name in declared if name in missing)
        return by_rule

    def rows(self) -> list[dict[str, Any]]:
        """One row a drive; ``why`` says what there is no verdict for."""
        return [_row(answer) for answer in self.answers()]

    def __repr__(self) -> str:
        return f"RecordingVerdicts({self.rules.name}, {len(self.egos):,} vehicles)"


def _row(answer: DriveVerdict | NoDrive) -> dict[str, Any]:
    row: dict[str, Any] = {"ego": "", "trace": None, "start_s": None, "satisfied": None}
    row |= {"violated": [], "why": ""}
    if isinstance(answer, NoDrive):
        return row | {"ego": answer.ego, "why": answer.why}
    drive, verdict = answer.drive, answer.answer
    row |= {"ego": drive.ego, "trace": drive.trace.id, "start_s": drive.start_s}
    if isinstance(verdict, NotJudged):
        return row | {"why": str(verdict.error)}
    violated = [violation.rule for violation in verdict.violations]
    return row | {"satisfied": verdict.satisfied, "violated": violated}


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

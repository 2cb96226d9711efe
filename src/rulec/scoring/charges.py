"""What candidates are charged with: as columns for all, and for each one on demand."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, TypeAlias, overload

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import is_fault
from rulec.extraction.recording_verdicts import DriveVerdict, JudgedDrive
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.batch.findings import Findings, JudgedTrace
from rulec.monitoring.verdict import NotJudged, OpenVerdict, RuleFor, Verdict, Violation, rule_for
from rulec.scoring.candidate_score import CandidateScore, lost_candidate, without_drives
from rulec.trace.trace_arrays import TraceArrays

_NOBODY = -1


_Judged: TypeAlias = JudgedTrace | Verdict | NotJudged


@dataclass(frozen=True, slots=True, eq=False)
class CandidateCharges:
    """A candidate whose violations are known, and whose score is made on demand.

    ``begins`` are the states of the candidate in which its ``drives`` begin. If there are many
    candidates only the drives' verdicts are kept; everything else is recomputed by ``again`` from
    the candidate's number. ``open_before`` is what is not charged though it is open.
    """

    number: int
    drives: Sequence[JudgedDrive | _Judged | NoDrive]
    begins: Sequence[int]
    off_road: int
    why: str
    is_judged: bool
    again: Callable[[int], CandidateScore] | None = None
    open_before: frozenset[RuleFor] = frozenset()

    def later(self, again: Callable[[int], CandidateScore]) -> CandidateCharges:
        """The same without the drives, which ``again`` recomputes."""
        judged = list(map(_judged, self.drives))
        return replace(self, drives=judged, again=again)

    def score(self) -> CandidateScore:
        """The candidate's score."""
        drives = [x.with_verdict() if isinstance(x, JudgedDrive) else x for x in self.drives]
        violations: list[Violation] = []
        doubtful: list[OpenVerdict] = []
        not_judged = {}
        faults: dict[RulecError, None] = {}
        for begins, drive in zip(self.begins, drives, strict=True):
            answer = drive.answer if isinstance(drive, DriveVerdict) else drive
            if isinstance(answer, JudgedTrace):
                answer = answer.nameless()
            if isinstance(answer, Verdict):
                violations += [at(violation, begins) for violation in answer.violations]
                doubtful += answer.open
                not_judged.update({rule.rule: rule for rule in answer.not_judged})
                faults.update(dict.fromkeys(answer.faults))
            elif isinstance(answer, NoDrive) and answer.fault is not None:
                faults[answer.fault] = None
            elif isinstance(answer, NotJudged) and is_fault(answer.error):
                faults[answer.error] = None
        found = CandidateScore(
            self.number,
            violations=tuple(violations),
            open=tuple(doubtful),
            not_judged=tuple(not_judged.values()),
            off_road=self.off_road,
            why=self.why,
            is_judged=self.is_judged,
            drives=tuple([x for x in drives if isinstance(x, DriveVerdict | NoDrive)]),
            faults=tuple(faults),
        ).apart(self.open_before)
        if self.again is None:
            return found
        return without_drives(found, len(drives), partial(self.again, self.number))


def traces_of(candidate: CandidateCharges | CandidateScore) -> list[TraceArrays]:
    """The judged drives of a candidate that has them, without making their verdicts."""
    return [
        own.drive.arrays
        for own in candidate.drives
        if isinstance(own, JudgedDrive | DriveVerdict)
        and not isinstance(own.judged if isinstance(own, JudgedDrive) else own.answer, NotJudged)
    ]


def _judged(drive: JudgedDrive | _Judged | NoDrive) -> _Judged | NoDrive:
    return drive.judged if isinstance(drive, JudgedDrive) else drive


def at(violation: Violation, begins: int) -> Violation:
    """A violation with its step counted from the candidate's first state, not the drive's."""
    step = violation.step
    return replace(violation, step=step + begins) if begins and step is not None else violation


class CandidateScores(Sequence[CandidateScore]):
    """The scores of candidates in their order, each made on first access."""

    def __init__(self, charges: Sequence[CandidateCharges | CandidateScore]) -> None:
        self.charges = list(charges)

    def __len__(self) -> int:
        return len(self.charges)

    @overload
    def __getitem__(self, number: int) -> CandidateScore: ...

    @overload
    def __getitem__(self, number: slice) -> tuple[CandidateScore, ...]: ...

    def __getitem__(self, number: int | slice) -> CandidateScore | tuple[CandidateScore, ...]:
        if isinstance(number, slice):
            return tuple([self[k] for k in range(*number.indices(len(self)))])
        candidate = self.charges[number]
        if isinstance(candidate, CandidateCharges):
            try:
                candidate = candidate.score()
            except Exception as problem:
                candidate = lost_candidate(candidate.number, candidate.off_road or 1, problem)
            self.charges[number] = candidate
        return candidate

    def __eq__(self, other: object) -> bool:
        """Whether the scores are equal."""
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"CandidateScores({len(self):,} candidates)"

    def __reduce__(self) -> tuple[type[CandidateScores], tuple[list[CandidateScore]]]:
        return CandidateScores, (list(self),)


def open_of(
    candidates: Iterable[Sequence[JudgedDrive | NoDrive]], rules: Set[str]
) -> list[set[RuleFor]]:
    """For which objects some of these rules are open for each candidate, given by its drives."""
    known: dict[Findings, Mapping[int, Set[RuleFor]]] = {}
    found: list[set[RuleFor]] = []
    for drives in candidates:
        found.append(set())
        for own in map(_judged, drives):
            if isinstance(own, JudgedTrace):
                if own.findings not in known:
                    known[own.findings] = own.findings.open_of(rules)
                found[-1] |= known[own.findings].get(own.number, set())
            elif isinstance(own, Verdict):
                found[-1] |= {rule_for(result) for result in own.open if result.rule in rules}
    return found


def forget_reasons(charges: Sequence[CandidateCharges]) -> None:
    """Free the reasons of open verdicts, from which nothing is recomputed."""
    judged = [
        own for candidate_charges in charges for own in map(_judged, candidate_charges.drives)
    ]
    for findings in {own.findings for own in judged if isinstance(own, JudgedTrace)}:
        findings.forget_reasons()


class Charged(NamedTuple):
    """Pairs of candidates and rules charged to them, one for each choice of objects.

    Both are numbers from 0; candidates ascend.
    """

    candidates: NDArray[intp]
    rules: NDArray[intp]


@dataclass(frozen=True, slots=True, eq=False)
class ScoreColumns:
    """Of all candidates: violated and open rules, states off the road, and late states.

    ``late`` is the number of states until everything that the past violated is kept for good.
    """

    violated: Charged
    open: Charged
    off_road: NDArray[intp]
    late: NDArray[intp]


def columns_of(candidates: Sequence[CandidateScore], rules: CompiledRulebook) -> ScoreColumns:
    """The columns of all candidates, without making their scores."""
    charges = candidates.charges if isinstance(candidates, CandidateScores) else candidates
    places = {rule.name: place for place, rule in enumerate(rules.rules)}
    whose, which, are_violated = map(np.concatenate, zip(*_rows(charges, places), strict=True))
    order = whose.argsort(kind="stable")
    violated, doubtful = order[are_violated[order]], order[~are_violated[order]]
    late = [candidate.late if isinstance(candidate, CandidateScore) else 0 for candidate in charges]
    return ScoreColumns(
        Charged(whose[violated], which[violated]),
        Charged(whose[doubtful], which[doubtful]),
        off_road=np.array([candidate.off_road for candidate in charges], dtype=intp),
        late=np.array(late, dtype=intp),
    )


_Rows: TypeAlias = tuple[NDArray[intp], NDArray[intp], NDArray[bool_]]
"""Candidates, a rule for each, and whether it is violated."""


def _rows(
    charges: Sequence[CandidateCharges | CandidateScore], places: Mapping[str, int]
) -> Iterator[_Rows]:
    """Everything charged to candidates; ``places`` are the numbers of rules."""
    told: list[tuple[int, int, bool]] = []
    judged: dict[Findings, dict[int, int]] = defaultdict(dict)
    apart: dict[Findings, dict[int, frozenset[RuleFor]]] = defaultdict(dict)
    for number, candidate in enumerate(charges):
        for own in (
            map(_judged, candidate.drives)
            if isinstance(candidate, CandidateCharges)
            else (candidate,)
        ):
            if isinstance(own, JudgedTrace):
                judged[own.findings][own.number] = number
                if isinstance(candidate, CandidateCharges) and candidate.open_before:
                    apart[own.findings][own.number] = candidate.open_before
            elif isinstance(own, Verdict | CandidateScore):
                told += [(number, places[violation.rule], True) for violation in own.violations]
                told += [
                    (number, places[open_verdict.rule], False)
                    for open_verdict in own.open
                    if isinstance(candidate, CandidateScore)
                    or rule_for(open_verdict) not in candidate.open_before
                ]
                told += [(number, places[x.rule], False) for x in own.not_judged if x.by_fault]
    whose, which, are_violated = np.array(told, dtype=intp).reshape(-1, 3).T
    yield whose, which, are_violated.astype(bool)
    for findings, numbers in judged.items():
        candidate_of = np.full(findings.n_traces, _NOBODY)
        candidate_of[list(numbers)] = list(numbers.values())
        for rule, traces, own_violated in findings.charged(apart[findings]):
            own_ones = candidate_of[traces]
            there = own_ones != _NOBODY
            own_ones = own_ones[there]
            yield own_ones, np.full(len(own_ones), places[rule]), own_violated[there]

"""The verdicts on recorded drives, each vehicle being ego in turn."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Any, NamedTuple

from rulec.automata.bundle.bundle_messages import OTHER_STEP
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.findings import JudgedTrace
from rulec.monitoring.batch.verify_arrays import answer_to, judge_contained
from rulec.monitoring.fault_containment import without
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.told_names import names_behind, words_meant
from rulec.monitoring.uncertainty.state_letters.related_facts import related_facts
from rulec.monitoring.verdict import (
    NotJudged,
    Verdict,
    agreed_by_type,
    with_law,
)
from rulec.recordings.recording import Recording
from rulec.trace.trace_arrays import TraceArrays
from rulec.value_display import Rows, short_repr

_MOST_KEPT = 1 << 6
"""Most selections of rules that are kept; beyond this all are dropped."""

MOST_STATES, MOST_CELLS_TOGETHER = 1 << 13, 1 << 18
"""Drives are verified together once they have this many states, or cells of participants in states;
more would take more memory."""


def rulebook_at(rulebook: CompiledRulebook, step_s: float) -> CompiledRulebook:
    """A rulebook at a recording's step.

    Rules whose automata are too large at so short a step are left out; others can be judged.
    """
    try:
        return rulebook.judgeable_at(step_s)
    except RulecError as error:
        if any(problem.code != OTHER_STEP.code for problem in error.diagnostics):
            raise
        # Each drive will report that it cannot be judged.
        return rulebook


@dataclass(frozen=True, slots=True)
class DriveVerdict:
    """A drive and the rulebook's verdict on it."""

    __repr__ = short_repr

    drive: Drive
    answer: Verdict | NotJudged


@dataclass(frozen=True, slots=True)
class JudgedDrive:
    """A drive with what is known of its verdict, which is built on demand."""

    drive: Drive
    judged: JudgedTrace | Verdict | NotJudged

    def with_verdict(self) -> DriveVerdict:
        """The drive and its verdict."""
        name = self.drive.arrays.id
        try:
            answer = answer_to(self.judged, self.drive.arrays)
        except Exception as problem:
            answer = NotJudged(name, fault_of(problem, f"verdict on `{name}`"))
        return DriveVerdict(self.drive, answer)


class RecordingVerdicts(Rows):
    """The verdicts of a rulebook on a recording's drives, computed on demand.

    Raises RulecError R0507 if the rulebook was compiled for another step, R0612 for a vehicle that
    is not there. With ``says_law`` each verdict has the text that it is by, which takes the
    rulebook's hash.
    """

    def __init__(
        self,
        recording: Recording,
        rulebook: CompiledRulebook,
        request: RequestedDrives,
        file: str,
        *,
        says_law: bool = False,
    ) -> None:
        self._says_law = says_law
        self.request = request
        self.rules = rulebook_at(rulebook, recording.step_s)
        self.drives = selected_drives(
            recording,
            request,
            file,
            traffic=self.rules.traffic,
            vocabulary=self.rules.vocabulary,
            names=names_read(self.rules),
            possible_types=True,
        )
        self.recording = self.drives.recording
        self.mirrored = self.drives.mirrored
        self.defaults = request.defaults
        self.egos = self.drives.egos

    def __iter__(self) -> Iterator[DriveVerdict | NoDrive]:
        return self.answers()

    def answers(self) -> Iterator[DriveVerdict | NoDrive]:
        """The verdict on each drive, in the order of the file."""
        # No name for a drive here: it would keep the arrays of its part until the next one's are
        # made.
        judged = map(partial(judged_drives, rulebook=self.rules), self._together())
        return map(self._answer, chain.from_iterable(judged))

    def _answer(self, found: JudgedDrive | NoDrive) -> DriveVerdict | NoDrive:
        if isinstance(found, NoDrive):
            return found
        drive = found.with_verdict()
        if not self._says_law:
            return drive
        return replace(drive, answer=with_law(drive.answer, edition_of(self.rules)))

    def _together(self) -> Iterator[list[Drive | NoDrive]]:
        """The drives, as many at a time as are verified together."""
        waiting: list[Drive | NoDrive] = []
        states = cells = 0
        for drive in self.drives:
            waiting.append(drive)
            if isinstance(drive, Drive):
                states += drive.arrays.n_states
                cells += int(drive.arrays.starts[-1])
            if states >= MOST_STATES or cells >= MOST_CELLS_TOGETHER:
                yield waiting
                waiting, states, cells = [], 0, 0
        yield waiting

    def by_default(self, words: frozenset[str]) -> dict[str, tuple[str, ...]]:
        """Rule -> names that it reads, that are not in ``words`` and take defaults in all states.

        Only presumed names do, unless defaults have been requested.
        """
        declared = self.rules.vocabulary.declarations.items()
        have = [name for name, item in declared if self.defaults or item.presumed]
        words |= {*words_meant(self.rules.vocabulary, words)}
        missing = {rule.name: names_of(rule.formula) - words for rule in self.rules.rules}
        return {
            rule: tuple([name for name in have if name in names]) for rule, names in missing.items()
        }

    def defaulted(self, words: frozenset[str]) -> list[str]:
        """The names of ``by_default``, of all rules together."""
        missing = {name for names in self.by_default(words).values() for name in names}
        return [name for name in self.rules.vocabulary.declarations if name in missing]

    def rows(self) -> list[dict[str, Any]]:
        """One row per drive; ``why`` says why a drive has no verdict."""
        return [_row(answer) for answer in self.answers()]

    def __repr__(self) -> str:
        return f"RecordingVerdicts({self.rules.name}, {len(self.egos):,} vehicles)"


def names_read(rulebook: CompiledRulebook) -> frozenset[str]:
    """The names that the rules and facts of a rulebook read."""
    known: frozenset[str] | None = rulebook.prepared.get(names_read)
    if known is None:
        formulas = [rule.formula for rule in rulebook.rules]
        formulas += [axiom.formula for axiom in rulebook.axioms]
        known = names_behind(frozenset().union(*map(names_of, formulas)), rulebook.vocabulary)
        rulebook.prepared[names_read] = known
    return known


class SomeRules(NamedTuple):
    """A rulebook with some of its rules, and the names that these and facts about them read.

    Traces with these names are enough to judge the rules, unless they contradict other facts.
    """

    rulebook: CompiledRulebook
    names: frozenset[str]


def some_rules(names: frozenset[str], rulebook: CompiledRulebook) -> SomeRules:
    """The rules with these names from a rulebook; cached, as names mostly repeat."""
    known: dict[frozenset[str], SomeRules] = rulebook.prepared.setdefault(SomeRules, {})
    if names not in known:
        if len(known) >= _MOST_KEPT:
            known.clear()
        some = replace(rulebook, rules=tuple([x for x in rulebook.rules if x.name in names]))
        read = frozenset().union(*[names_of(rule.formula) for rule in some.rules])
        read = names_behind(read, some.vocabulary)
        facts = related_facts(read, some.axioms)
        known[names] = SomeRules(some, read.union(*[names_of(fact.formula) for fact in facts]))
    return known[names]


def judged_drives(
    drives: Sequence[Drive | NoDrive], rulebook: CompiledRulebook
) -> Iterator[JudgedDrive | NoDrive]:
    """The judged drives, whose verdicts are built on demand, in the same order."""
    known = [drive for drive in drives if isinstance(drive, Drive)]
    traces = [trace for drive in known for trace in (drive.arrays, *drive.otherwise)]
    judged = iter(judge_contained(traces, rulebook))
    for drive in drives:
        if isinstance(drive, Drive):
            own = next(judged)
            others = [(trace, next(judged)) for trace in drive.otherwise]
            yield JudgedDrive(drive, _of_any_type(drive, own, others) if others else own)
        else:
            yield drive


def _of_any_type(
    drive: Drive,
    own: JudgedTrace | Verdict | NotJudged,
    others: Sequence[tuple[TraceArrays, JudgedTrace | Verdict | NotJudged]],
) -> Verdict | NotJudged:
    """The common verdict on a drive, whatever the participants of unknown type are.

    Where it differs it depends on the types that they may have.
    """
    known, objects = answer_to(own, drive.arrays), drive.arrays.objects.items()
    if not isinstance(known, Verdict):
        return known
    verdicts: list[tuple[Sequence[str], Verdict]] = []
    for trace, judged in others:
        answer = answer_to(judged, trace)
        if isinstance(answer, Verdict):
            types = dict.fromkeys(kind for _, kind in trace.objects.items() - objects)
            verdicts.append((sorted(types), answer))
    agreed_on = agreed_by_type(known, verdicts)
    faults = [fault for _, verdict in verdicts for fault in verdict.faults]
    lost = [x for _, verdict in verdicts for x in verdict.not_judged if x.by_fault]
    return without(agreed_on, lost, faults) if faults else agreed_on


def _row(answer: DriveVerdict | NoDrive) -> dict[str, Any]:
    row: dict[str, Any] = {"ego": "", "trace": None, "start_s": None, "satisfied": None}
    row |= {"violated": [], "why": ""}
    if isinstance(answer, NoDrive):
        return row | {"ego": answer.ego, "why": answer.why}
    drive, verdict = answer.drive, answer.answer
    row |= {"ego": drive.ego, "trace": drive.arrays.id, "start_s": drive.start_s}
    if isinstance(verdict, NotJudged):
        return row | {"why": str(verdict.error)}
    violated = [violation.rule for violation in verdict.violations]
    return row | {"satisfied": verdict.satisfied, "violated": violated}

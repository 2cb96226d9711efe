"""The findings on many traces, in columns from which verdicts are built on demand.

Most callers only need to know how many violations there are, which is cheaper to count than to
list.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import repeat
from operator import itemgetter
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.outcome_machine import VIOLATED
from rulec.diagnostics import RulecError
from rulec.monitoring.fault_containment import rule_lost, without
from rulec.monitoring.uncertainty.judged_rules import JudgedRules
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.monitoring.verdict import (
    OpenReasons,
    OpenVerdict,
    RuleFor,
    Verdict,
    Violation,
    rule_for,
)

ViolationOrOpen: TypeAlias = Violation | OpenVerdict

Place: TypeAlias = tuple[int, ...]
"""The place of a finding: of its rule and of its objects."""

_PLACE = itemgetter(0)

RuleFault: TypeAlias = tuple[CompiledRule, RulecError]
"""A rule, and the fault of rulec that it has met."""

NOTHING_APART: Mapping[int, Set[RuleFor]] = {}
"""All that is open counts."""


class JudgedTrace(NamedTuple):
    """A trace whose findings are known, with its number among the ``findings``."""

    findings: Findings
    number: int

    def nameless(self) -> Verdict:
        """The verdict on it, without its name and the values presumed of it."""
        return replace(self.findings.verdict(self.number, "", lambda _: False), presumed=())


class Reasons(NamedTuple):
    """Why a rule is open for each of some choices of objects, as arguments of ``OpenVerdict``."""

    of: Callable[[int], OpenReasons]
    beyond: Callable[[int, Set[str]], frozenset[str]]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RuleFindings:
    """The choices of objects for which a rule is violated or open, and its outcome for each.

    ``number`` is the rule's; ``begins`` are the states of the ``traces`` from which it is judged,
    ``objects`` has an array for each of its variables, and ``places`` index the ``reasons``.
    """

    number: int
    rule: CompiledRule
    answers: Sequence[Answer]
    places: Sequence[int]
    traces: NDArray[intp]
    begins: NDArray[intp]
    objects: Sequence[NDArray[intp]]
    reasons: Reasons | None


class ChargedTraces(NamedTuple):
    """Traces that do not keep a rule, one per choice of objects, and which of them violate it."""

    rule: str
    traces: NDArray[intp]
    are_violated: NDArray[bool_]


_Row: TypeAlias = tuple[RuleFindings, int, int, Place]
"""One of a rule's findings, the state from which it is judged, and its objects."""


class Findings:
    """The findings on numbered traces for ``rules``; ``names`` are those of the objects.

    Everything is known about the traces that are ``whole``. ``find_doubtful`` is asked once, for a
    verdict: by trace the rules that lack names and are not surely kept, and faults met on the way.
    """

    def __init__(
        self,
        rules: JudgedRules,
        n_traces: int,
        names: Sequence[str],
        whole: Set[int],
        find_doubtful: Callable[[], tuple[Mapping[int, Set[str]], Sequence[RuleFault]]],
    ) -> None:
        self.n_traces = n_traces
        self._rules = rules
        self._names = names
        self._whole = whole
        self._of_rules: list[RuleFindings] = []
        self._find_doubtful = [find_doubtful]
        self._single: dict[int, list[tuple[Place, ViolationOrOpen]]] = defaultdict(list)

    def add(self, rule_findings: RuleFindings) -> None:
        """Add the findings about a rule."""
        self._of_rules.append(rule_findings)

    def add_single(self, trace: int, place: Place, finding: ViolationOrOpen) -> None:
        """Add the finding about one choice of objects of a trace."""
        self._single[trace].append((place, finding))

    def forget_reasons(self) -> None:
        """Discard the reasons for open verdicts, which keep all values of the traces alive."""
        _ = self._doubtful
        self._of_rules = [replace(own, reasons=None) for own in self._of_rules]
        self.__dict__.pop("_by_trace", None)

    def binding(self, rule: CompiledRule, chosen: Place) -> dict[str, str]:
        """The names of the objects for a rule's variables."""
        pairs = zip(rule.variables, chosen, strict=True)
        return {variable.name: self._names[item] for variable, item in pairs}

    def charged(self, apart: Mapping[int, Set[RuleFor]] = NOTHING_APART) -> Iterator[ChargedTraces]:
        """The traces with findings, rule by rule, but for what is open ``apart``, by trace."""
        rules = {rule for own in apart.values() for rule, _ in own}
        for own in self._of_rules:
            are_violated = np.array([answer.best == VIOLATED for answer in own.answers], dtype=bool)
            known = self._known(own.rule.name, own.traces, are_violated)
            if own.rule.name in rules:
                about = zip(own.traces.tolist(), self._about(own), strict=True)
                counts = np.array([x not in apart.get(n, ()) for n, x in about], dtype=bool)
                kept = counts | are_violated
                known = self._known(own.rule.name, own.traces[kept], are_violated[kept])
            yield known
        for trace, several in self._single.items():
            for _, finding in several:
                if isinstance(finding, Violation) or rule_for(finding) not in apart.get(trace, ()):
                    is_violated = np.array([isinstance(finding, Violation)])
                    yield self._known(finding.rule, np.array([trace]), is_violated)

    def open_of(self, rules: Set[str]) -> Mapping[int, Set[RuleFor]]:
        """By trace, for which objects some of these rules are open."""
        found: dict[int, set[RuleFor]] = defaultdict(set)
        for own in self._of_rules:
            if own.rule.name in rules:
                rows = zip(own.traces.tolist(), own.answers, self._about(own), strict=True)
                for trace, answer, about in rows:
                    if answer.best != VIOLATED:
                        found[trace].add(about)
        for trace, several in self._single.items():
            for _, finding in several:
                if isinstance(finding, OpenVerdict) and finding.rule in rules:
                    found[trace].add(rule_for(finding))
        return {trace: about for trace, about in found.items() if trace not in self._whole}

    def _about(self, own: RuleFindings) -> list[RuleFor]:
        """The rule and the objects of each of its findings."""
        objects = [[self._names[item] for item in items.tolist()] for items in own.objects]
        choices = zip(*objects, strict=True) if objects else repeat((), len(own.answers))
        return [(own.rule.name, chosen) for chosen in choices]

    def _known(
        self, rule: str, traces: NDArray[intp], are_violated: NDArray[bool_]
    ) -> ChargedTraces:
        """The traces with findings for a rule.

        Open ones are left out where everything is known.
        """
        if not self._whole:
            return ChargedTraces(rule, traces, are_violated)
        kept = are_violated | ~np.isin(traces, list(self._whole))
        return ChargedTraces(rule, traces[kept], are_violated[kept])

    def verdict(self, number: int, name: str, says: Callable[[str], bool]) -> Verdict:
        """The verdict on a trace with this number and name, which ``says`` some names."""
        violations, doubtful = self.of(number)
        if number in self._whole:
            return Verdict(name, violations)
        presumed = tuple([own for own in self._rules.presumed if not says(own)])
        unknown, faults = self._doubtful
        not_judged, regardless = self._rules.unanswered(unknown.get(number, set()))
        own = Verdict(name, violations, doubtful, not_judged, presumed, kept_regardless=regardless)
        lost = [rule_lost(*fault) for fault in faults]
        return without(own, lost, [fault for _, fault in faults]) if faults else own

    def of(self, number: int) -> tuple[tuple[Violation, ...], tuple[OpenVerdict, ...]]:
        """The violations of a trace, and its open verdicts."""
        rows, single = self._by_trace.get(number), self._single.get(number, ())
        if rows is None and not single:
            return (), ()
        made = [self._made(row) for row in rows or ()]
        findings = [result for _, result in sorted([*made, *single], key=_PLACE)]
        violations = tuple([result for result in findings if isinstance(result, Violation)])
        if number in self._whole:
            return violations, ()
        return violations, tuple([result for result in findings if isinstance(result, OpenVerdict)])

    @cached_property
    def _doubtful(self) -> tuple[Mapping[int, Set[str]], Sequence[RuleFault]]:
        # Let go with its answer: what finds them keeps all values of the traces alive
        return self._find_doubtful.pop()() if self._rules.lacking else ({}, ())

    @cached_property
    def _by_trace(self) -> dict[int, list[_Row]]:
        by_trace: dict[int, list[_Row]] = defaultdict(list)
        for own in self._of_rules:
            objects = [items.tolist() for items in own.objects]
            choices = zip(*objects, strict=True) if objects else repeat(())
            rows = zip(own.traces.tolist(), own.begins.tolist(), choices, strict=False)
            for at, (trace, begin, chosen) in enumerate(rows):
                by_trace[trace].append((own, at, begin, chosen))
        return by_trace

    def _made(self, row: _Row) -> tuple[Place, ViolationOrOpen]:
        own, at, begin, chosen = row
        rule, answer = own.rule, own.answers[at]
        name, strength, binding = rule.name, rule.strength, self.binding(rule, chosen)
        place = own.number, *chosen
        if answer.best == VIOLATED:
            step = None if answer.step is None else answer.step + begin
            return place, Violation(name, strength, binding, step)
        if own.reasons is None:
            return place, OpenVerdict.explained_later(name, strength, binding, _forgotten)
        why, beyond = partial(own.reasons.of, own.places[at]), None
        if answer.best != answer.worst:
            beyond = partial(own.reasons.beyond, own.places[at])
        return place, OpenVerdict.explained_later(name, strength, binding, why, beyond=beyond)


def _forgotten() -> OpenReasons:
    raise LookupError("why it is open has been forgotten")

"""What many traces do not keep: columns, of which verdicts are made when somebody asks for them.

Of most traces nobody asks for more than how much they violate, which is sooner counted than told.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence, Set
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
from rulec.monitoring.uncertainty.judged_rules import JudgedRules
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.monitoring.verdict import OpenReasons, OpenVerdict, RuleNotJudged, Verdict, Violation
from rulec.trace.trace_arrays import TraceArrays

ViolationOrOpen: TypeAlias = Violation | OpenVerdict

Place: TypeAlias = tuple[int, ...]
"""The place of what is not kept: of its rule, and of its objects."""

_PLACE = itemgetter(0)


class JudgedTrace(NamedTuple):
    """A trace of which it is known what it does not keep: its number among the ``findings``."""

    findings: Findings
    number: int

    def nameless(self) -> Verdict:
        """The verdict on it, without what it is called and what is presumed of it."""
        violations, doubtful = self.findings.of(self.number)
        return Verdict("", violations, doubtful, self.findings.not_judged(self.number))


class Reasons(NamedTuple):
    """Why a rule is open for one of some choices of objects, as ``OpenVerdict`` is told it."""

    of: Callable[[int], OpenReasons]
    beyond: Callable[[int, Set[str]], frozenset[str]]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RuleFindings:
    """The choices of objects for which a rule is not kept, and what it comes to for each.

    ``number`` is the rule's; ``begins`` are the states of the ``traces`` that it is judged from,
    ``objects`` has an array for each of its variables, ``places`` are those that ``reasons`` go by.
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
    """The traces that do not keep a rule, one for each choice of objects, and which violate it."""

    rule: str
    traces: NDArray[intp]
    are_violated: NDArray[bool_]


_Row: TypeAlias = tuple[RuleFindings, int, int, Place]
"""One of a rule's findings, the state that it is judged from, and its objects."""


class Findings:
    """What so many traces, by number, do not keep of ``rules``; objects have these ``names``.

    Of traces that are ``whole`` all is known.
    """

    def __init__(
        self, rules: JudgedRules, n_traces: int, names: Sequence[str], whole: Set[int]
    ) -> None:
        self.n_traces = n_traces
        self._rules = rules
        self._names = names
        self._whole = whole
        self._of_rules: list[RuleFindings] = []
        self._single: dict[int, list[tuple[Place, ViolationOrOpen]]] = defaultdict(list)

    def add(self, rule_findings: RuleFindings) -> None:
        """Add the findings about a rule."""
        self._of_rules.append(rule_findings)

    def add_single(self, trace: int, place: Place, finding: ViolationOrOpen) -> None:
        """Add the finding about one choice of objects of a trace."""
        self._single[trace].append((place, finding))

    def forget_reasons(self) -> None:
        """Forget why what is open is so, for which all that traces say is kept."""
        self._of_rules = [replace(own, reasons=None) for own in self._of_rules]
        self.__dict__.pop("_by_trace", None)

    def binding(self, rule: CompiledRule, chosen: Place) -> dict[str, str]:
        """The names of objects for a rule's variables."""
        names = [self._names[item] for item in chosen]
        return dict(zip([variable.name for variable in rule.variables], names, strict=True))

    def charged(self) -> Iterator[ChargedTraces]:
        """What is not kept, rule by rule."""
        for own in self._of_rules:
            are_violated = np.array([answer.best == VIOLATED for answer in own.answers], dtype=bool)
            yield self._known(own.rule.name, own.traces, are_violated)
        for trace, several in self._single.items():
            for _, finding in several:
                is_violated = np.array([isinstance(finding, Violation)])
                yield self._known(finding.rule, np.array([trace]), is_violated)

    def _known(
        self, rule: str, traces: NDArray[intp], are_violated: NDArray[bool_]
    ) -> ChargedTraces:
        """What is not kept of a rule, without what is open where all is known."""
        if not self._whole:
            return ChargedTraces(rule, traces, are_violated)
        kept = are_violated | ~np.isin(traces, list(self._whole))
        return ChargedTraces(rule, traces[kept], are_violated[kept])

    def verdict(self, number: int, trace: TraceArrays) -> Verdict:
        """The verdict on a trace, which has this number."""
        violations, doubtful = self.of(number)
        if number in self._whole:
            return Verdict(trace.id, violations)
        presumed = tuple([name for name in self._rules.presumed if not trace.says(name)])
        return Verdict(trace.id, violations, doubtful, self._rules.not_judged, presumed)

    def not_judged(self, number: int) -> tuple[RuleNotJudged, ...]:
        """The rules that a trace tells too little for."""
        return () if number in self._whole else self._rules.not_judged

    def of(self, number: int) -> tuple[tuple[Violation, ...], tuple[OpenVerdict, ...]]:
        """What a trace violates, and what is open."""
        made = [self._made(row) for row in self._by_trace.get(number, ())]
        made += self._single.get(number, ())
        findings = [result for _, result in sorted(made, key=_PLACE)]
        violations = tuple([result for result in findings if isinstance(result, Violation)])
        if number in self._whole:
            return violations, ()
        return violations, tuple([result for result in findings if isinstance(result, OpenVerdict)])

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

"""One run of all rules over traces laid end to end: the engine that judges one trace and many."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import fault_of
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.findings import (
    Findings,
    JudgedTrace,
    Place,
    Reasons,
    RuleFault,
    RuleFindings,
    ViolationOrOpen,
)
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind
from rulec.monitoring.batch.stacked.contradictions import (
    LinkedFacts,
    contradicted,
    linked,
)
from rulec.monitoring.batch.stacked.open_reasons import StackedReasons
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_outcomes import StackedOutcomes, outcomes
from rulec.monitoring.batch.stacked.stacked_read import ReadKeys, StackedRead
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.implied_values import with_defined_words
from rulec.monitoring.state_validation import check_objects, check_told
from rulec.monitoring.uncertainty.judged_rules import JudgedRules, judged_rules
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun


_MOST_KEPT = 1 << 10
"""How many combinations of all reads' digits are kept before all are discarded."""

_MOST_EXAMINED = 1 << 20
"""Of traces that contradict facts at most so many pairs of objects times states are examined."""


def check_judgeable(kind: TraceKind, rulebook: CompiledRulebook) -> None:
    """Raise RulecError or UnencodableError if no traces of this kind can be judged together."""
    _ready_for(kind, rulebook.fitted_to(kind.step_s))


class StackedRun:
    """The judgement of traces of one kind, each rule on all of them together.

    Raises RulecError or UnencodableError if all of them must be judged by their states.
    """

    def __init__(self, traces: JoinedTraces, rulebook: CompiledRulebook) -> None:
        self._rulebook = rules = rulebook.fitted_to(traces.kind.step_s)
        self._traces, self._n_traces = traces, len(traces.lengths)
        self._ready = _ready_for(traces.kind, rules)
        _check_objects(traces, rules.vocabulary)
        self._stack = Stack(traces, self._ready.judged.vocabulary, self._ready.defaults)
        self._reader = StackReader(self._stack)
        self._reasons = StackedReasons(self._reader)
        self._close = _CloseLooks(traces.trace, rules)
        self._simple = self._ready.simple_rules(frozenset(self._stack.untold(self._ready.names)))
        self._odd: set[int] = set()

    def judged(self) -> list[JudgedTrace | None]:
        """The traces with their findings; None for those that must be judged by their states."""
        judged, every = self._ready.judged, range(self._n_traces)
        whole: set[int] = set()
        if self._traces.kind.is_whole:
            whole = {*every} - self._stack.partial_traces()
        # Nothing here refers to the findings, which last as long as what they ask
        findings = Findings(
            judged, self._n_traces, self._traces.names, frozenset(whole), self._doubtful
        )
        busy = self._simple.busy(self._reader)
        suspects = self._suspects(contradicted(self._simple.facts, self._reader))
        for number, rule in enumerate(self._ready.rules):
            if rule.rule.name in judged.lacking:
                continue
            if number not in self._simple.rules:
                for trace in every:
                    self._add_closely(findings, trace, number, rule.rule)
            elif number in busy or (rule.facts and suspects.any()):
                rule.forget_many()
                for found in outcomes(rule, self._reader, self._rulebook, suspects):
                    self._add(findings, number, found)
        self._odd |= self._stack.odd_traces()
        return [None if trace in self._odd else JudgedTrace(findings, trace) for trace in every]

    def _suspects(self, contradicted: Set[int]) -> Flags:
        """The traces among these that are examined closely, unless there is too much in them.

        Without the values that follow by facts, which a state may leave out, none is.
        """
        suspects: Flags = np.zeros(self._n_traces, dtype=bool)
        if not contradicted:
            return suspects
        suspects[list(contradicted)] = True
        stack = self._stack
        n_objects = np.bincount(stack.trace_of, minlength=self._n_traces)
        n_pairs = n_objects**2 * (stack.begins[1:] - stack.begins[:-1])
        odd: Flags = (n_pairs * suspects).cumsum() > _MOST_EXAMINED
        odd |= not self._traces.derived
        self._odd.update((suspects & odd).nonzero()[0].tolist())
        return suspects & ~odd

    def _add(self, findings: Findings, number: int, found: StackedOutcomes) -> None:
        """Add what has been found about a rule."""
        rule, instances = found.rule.rule, found.words.instances
        answers = {place: own for place, own in found.answers.items() if own is not None}
        chosen = np.array([*answers], dtype=np.intp)
        traces = instances.traces[chosen]
        findings.add(
            RuleFindings(
                number=number,
                rule=rule,
                answers=[*answers.values()],
                places=[*answers],
                traces=traces,
                begins=instances.firsts[chosen] - self._stack.begins[traces],
                objects=[own[chosen] for own in instances.objects],
                reasons=Reasons(
                    partial(self._reasons.of, found), partial(self._reasons.beyond, found)
                ),
            )
        )
        for place in sorted(found.answers.keys() - answers):
            objects = tuple([int(own[place]) for own in instances.objects])
            self._add_closely(findings, int(instances.traces[place]), number, rule, objects)

    def _add_closely(
        self,
        findings: Findings,
        trace: int,
        number: int,
        rule: CompiledRule,
        chosen: Place | None = None,
    ) -> None:
        """Add what states say of a rule that arrays cannot decide, or of one choice of objects."""
        if trace in self._odd:
            return
        found: list[tuple[Place, ViolationOrOpen]] = []
        try:
            if chosen is None:
                answers = enumerate(self._close[trace].answers(rule.name))
                found = [((number, place), answer) for place, answer in answers]
            else:
                answer = self._close[trace].answer(rule.name, findings.binding(rule, chosen))
                found = [((number, *chosen), answer)] if answer is not None else []
        except RulecError:
            self._odd.add(trace)
            return
        for place, finding in found:
            findings.add_single(trace, place, finding)

    def _doubtful(self) -> tuple[Mapping[int, Set[str]], Sequence[RuleFault]]:
        """By trace the rules that lack names and that it may not keep; and faults on the way."""
        doubtful: dict[int, set[str]] = defaultdict(set)
        faults: list[RuleFault] = []
        busy = self._simple.busy(self._reader)
        for number, rule in enumerate(self._ready.rules):
            name = rule.rule.name
            if name not in self._ready.judged.lacking:
                continue
            try:
                traces = self._not_surely_kept(number, rule, busy)
            except Exception as problem:
                faults.append((rule.rule, fault_of(problem, f"rule {name}")))
                continue
            for trace in traces:
                doubtful[trace].add(name)
        return doubtful, faults

    def _not_surely_kept(self, number: int, rule: StackedRule, busy: Set[int]) -> set[int]:
        """The traces in which a rule is not surely kept."""
        sure: set[int] = set()
        closely: set[int] = set()
        every = range(self._n_traces)
        if number not in self._simple.rules:
            closely = {*every}
        elif number in busy:
            rule.forget_many()
            nobody = np.zeros(self._n_traces, dtype=bool)
            try:
                for found in outcomes(rule, self._reader, self._rulebook, nobody):
                    traces = found.words.instances.traces
                    for place, answer in found.answers.items():
                        (closely if answer is None else sure).add(int(traces[place]))
            except UnencodableError:
                closely = {*every}
        return sure | {x for x in closely - sure if self._close[x].is_doubtful(rule.rule.name)}


@dataclass(frozen=True, slots=True, eq=False)
class _SimpleRules:
    """The ``rules`` that can be judged on arrays, by number, and the linked ``facts`` about them.

    ``reads`` are the distinct reads, and ``places`` those of each rule's reads among them. The
    rules that may have an effect are cached by the digits that all reads have anywhere.
    """

    rules: Mapping[int, StackedRule]
    facts: Sequence[LinkedFacts]
    reads: Sequence[StackedRead]
    places: Mapping[int, Sequence[int]]
    _busy: dict[tuple[int, ...], frozenset[int]] = field(default_factory=dict, init=False)

    @staticmethod
    def of(rules: Mapping[int, StackedRule], lacking: Set[str]) -> _SimpleRules:
        """These rules with their reads; facts about the ``lacking`` ones are not looked into."""
        judged = [rule for rule in rules.values() if rule.rule.name not in lacking]
        facts = dict.fromkeys(fact for rule in judged for fact in rule.facts)
        reads = {read.digits_key: read for rule in rules.values() for read in rule.reads}
        place_of = {key: place for place, key in enumerate(reads)}
        places = {
            number: tuple([place_of[read.digits_key] for read in rule.reads])
            for number, rule in rules.items()
        }
        return _SimpleRules(rules, tuple(linked(tuple(facts))), tuple(reads.values()), places)

    def busy(self, reader: StackReader) -> frozenset[int]:
        """The numbers of the rules that may be violated or open. Raises UnencodableError."""
        digits = reader.digits_of(self.reads)
        busy = self._busy.get(digits)
        if busy is None:
            if len(self._busy) >= _MOST_KEPT:
                self._busy.clear()
            busy = self._busy[digits] = frozenset(
                number
                for number, rule in self.rules.items()
                if not rule.machine.idle.of_cube([digits[k] for k in self.places[number]])
            )
        return busy


@dataclass(frozen=True, slots=True, eq=False)
class _ReadyRules:
    """What is the same for all traces of one kind.

    ``names`` are those of the ``rules`` that are simple, ``defaults`` the default values looked up
    so far.
    """

    judged: JudgedRules
    rules: Sequence[StackedRule]
    names: frozenset[str]
    defaults: dict[str, Any] = field(default_factory=dict, init=False)
    _simple: dict[frozenset[str], _SimpleRules] = field(default_factory=dict, init=False)

    def simple_rules(self, untold: frozenset[str]) -> _SimpleRules:
        """The rules that can be evaluated on arrays if some names are missing, usually all."""
        known = self._simple.get(untold)
        if known is None:
            known = self._simple[untold] = _SimpleRules.of(
                {
                    number: rule
                    for number, rule in enumerate(self.rules)
                    if rule.is_simple and untold.isdisjoint(rule.names)
                },
                self.judged.lacking,
            )
        return known


def _ready_for(kind: TraceKind, rules: CompiledRulebook) -> _ReadyRules:
    """The rules for traces of this kind. Raises RulecError, UnencodableError."""
    known: dict[TraceKind, _ReadyRules] = rules.prepared.setdefault(_ReadyRules, {})
    if kind not in known:
        known[kind] = _ready_rules(kind, rules)
    return known[kind]


def _ready_rules(kind: TraceKind, rules: CompiledRulebook) -> _ReadyRules:
    for rule in rules.rules:
        check_step(rule, exact_step(kind.step_s))
    check_told(kind.told, rules.vocabulary)
    constants = rules.vocabulary.constants
    for fact in rules.axioms:
        if counts(fact.formula) or not set(constants).isdisjoint(names_of(fact.formula)):
            raise UnencodableError  # what it says of values is looked up state by state
    judged = judged_rules(rules, kind.told, cut=kind.ends == "cut")
    keys: ReadKeys = {}
    ready = [
        StackedRule(rule, machine, rules, judged.vocabulary, keys)
        for rule, machine in judged.machines
    ]
    names = frozenset().union(*(rule.names for rule in ready if rule.is_simple))
    return _ReadyRules(judged, ready, names)


class _CloseLooks(dict[int, "UncertainRun"]):
    """The verdicts on single rules of each trace by its states, begun once they are needed."""

    def __init__(self, trace: Callable[[int], Trace], rulebook: CompiledRulebook) -> None:
        self._trace, self._rulebook = trace, rulebook

    def __missing__(self, number: int) -> UncertainRun:
        # Judging by states, 5 ms: only where arrays do not tell.
        from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

        trace = with_defined_words(self._trace(number), self._rulebook.vocabulary)
        return self.setdefault(number, UncertainRun(trace, self._rulebook))


def _check_objects(traces: JoinedTraces, vocabulary: Vocabulary) -> None:
    """Check the objects of all traces, each type once. Raises RulecError."""
    kinds = frozenset(traces.types)
    check_objects({kind: kind for kind in kinds}, vocabulary)
    most = map(str, range(max(traces.n_objects)))
    check_objects(dict.fromkeys(most, min(kinds, default="")), vocabulary)

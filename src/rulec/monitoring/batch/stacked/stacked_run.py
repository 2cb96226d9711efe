"""One run of all rules over traces laid end to end: the engine that judges one trace and many."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property, partial
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
from rulec.monitoring.batch.stacked.stacked_rule import (
    ReadKeys,
    StackedRead,
    StackedRule,
)
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
        self._n_traces = n_traces = len(traces.lengths)
        self._is_derived = traces.derived
        self._ready = _ready_for(traces.kind, rules)
        _check_objects(traces, rules.vocabulary)
        judged = self._ready.judged
        self._stack = Stack(traces, judged.vocabulary, self._ready.defaults)
        self._reader = StackReader(self._stack)
        self._close = _CloseLooks(traces.trace, rules)
        self._simple = self._ready.simple_rules(frozenset(self._stack.untold(self._ready.names)))
        whole: set[int] = set()
        if traces.kind.is_whole:
            whole = {*range(n_traces)} - self._stack.partial_traces()
        lacking = _LackingRules(self._ready, self._simple, self._reader, rules, self._close)
        self._findings = Findings(
            judged, n_traces, traces.names, frozenset(whole), lacking.doubtful
        )
        self._reasons = StackedReasons(self._reader)
        self._odd: set[int] = set()

    def judged(self) -> list[JudgedTrace | None]:
        """The traces with their findings; None for those that must be judged by their states."""
        simple, busy = self._simple, self._simple.busy(self._reader)
        suspects = self._suspects(contradicted(simple.facts, self._reader))
        for number, rule in enumerate(self._ready.rules):
            if rule.rule.name in self._ready.judged.lacking:
                continue
            if number not in simple.rules:
                self._add_closely(number, rule)
            elif number in busy or (rule.facts and suspects.any()):
                rule.forget_many()
                for stacked_outcomes in outcomes(rule, self._reader, self._rulebook, suspects):
                    self._add(number, stacked_outcomes)
        self._odd |= self._stack.odd_traces()
        return [
            None if number in self._odd else JudgedTrace(self._findings, number)
            for number in range(self._n_traces)
        ]

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
        odd |= not self._is_derived
        self._odd.update((suspects & odd).nonzero()[0].tolist())
        return suspects & ~odd

    def _add(self, rule_number: int, outcomes: StackedOutcomes) -> None:
        words, findings = outcomes.words, self._findings
        rule, instances = words.rule.rule, words.instances
        answered = zip(outcomes.places, outcomes.answers, strict=True)
        places = [place for place, answer in answered if answer is not None]
        chosen = np.array(places, dtype=np.intp)
        traces = instances.traces[chosen]
        findings.add(
            RuleFindings(
                number=rule_number,
                rule=rule,
                answers=[answer for answer in outcomes.answers if answer is not None],
                places=places,
                traces=traces,
                begins=instances.firsts[chosen] - self._stack.begins[traces],
                objects=[own[chosen] for own in instances.objects],
                reasons=Reasons(
                    partial(self._reasons.of, words), partial(self._reasons.beyond, words)
                ),
            )
        )
        for place in sorted({*outcomes.places}.difference(places)):
            about = [int(own[place]) for own in instances.objects]
            self._add_odd(int(instances.traces[place]), rule, (rule_number, *about))

    def _add_odd(self, number: int, rule: CompiledRule, place: Place) -> None:
        """Add the outcome for a choice of objects that arrays cannot decide."""
        if number in self._odd:
            return
        binding = self._findings.binding(rule, place[1:])
        try:
            finding = self._close[number].answer(rule.name, binding)
        except RulecError:
            self._odd.add(number)
            return
        if finding is not None:
            self._findings.add_single(number, place, finding)

    def _add_closely(self, rule_number: int, rule: StackedRule) -> None:
        for number in range(self._n_traces):
            try:
                answers = self._close[number].answers(rule.rule.name)
            except RulecError:
                self._odd.add(number)
                continue
            for place, answer in enumerate(answers):
                self._findings.add_single(number, (rule_number, place), answer)


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


@dataclass(frozen=True, slots=True, eq=False)
class _LackingRules:
    """The rules that lack names, on traces whose other rules have been judged.

    They are looked at once a verdict is asked for; nothing here refers to the findings, which last
    as long as that.
    """

    ready: _ReadyRules
    simple: _SimpleRules
    reader: StackReader
    rulebook: CompiledRulebook
    close: _CloseLooks

    def doubtful(self) -> tuple[Mapping[int, Set[str]], Sequence[RuleFault]]:
        """By trace the rules that it does not keep whatever these names are; and faults."""
        doubtful: dict[int, set[str]] = defaultdict(set)
        faults: list[RuleFault] = []
        every = range(len(self.reader.stack.begins) - 1)
        busy = self.simple.busy(self.reader)
        for number, rule in enumerate(self.ready.rules):
            name = rule.rule.name
            if name not in self.ready.judged.lacking:
                continue
            try:
                sure = self._not_surely_kept(number, rule, every, busy)
            except Exception as problem:
                faults.append((rule.rule, fault_of(problem, f"rule {name}")))
                continue
            for trace in sure:
                doubtful[trace].add(name)
        return doubtful, faults

    def _not_surely_kept(
        self, number: int, rule: StackedRule, every: range, busy: Set[int]
    ) -> set[int]:
        if number not in self.simple.rules:
            sure, closely = set[int](), {*every}
        elif number in busy:
            sure, closely = self._doubtful_in(rule, every)
        else:
            return set()
        return sure | {x for x in closely - sure if self.close[x].is_doubtful(rule.rule.name)}

    def _doubtful_in(self, rule: StackedRule, every: range) -> tuple[set[int], set[int]]:
        """The traces in which a rule is not surely kept, and those of which states decide it."""
        sure: set[int] = set()
        closely: set[int] = set()
        rule.forget_many()
        try:
            nobody = np.zeros(len(every), dtype=bool)
            for found in outcomes(rule, self.reader, self.rulebook, nobody):
                traces = found.words.instances.traces
                for place, answer in zip(found.places, found.answers, strict=True):
                    (closely if answer is None else sure).add(int(traces[place]))
        except UnencodableError:
            closely = {*every}
        return sure, closely


class _CloseLooks(dict[int, "_CloseLook"]):
    """A close look at each trace, by its number, taken once it is needed."""

    def __init__(self, trace: Callable[[int], Trace], rulebook: CompiledRulebook) -> None:
        self._of = partial(_CloseLook, rulebook=rulebook)
        self._trace = trace

    def __missing__(self, number: int) -> _CloseLook:
        return self.setdefault(number, self._of(partial(self._trace, number)))


class _CloseLook:
    """Verdicts on single rules of one trace, by its states."""

    def __init__(self, trace: Callable[[], Trace], rulebook: CompiledRulebook) -> None:
        self._trace = trace
        self._rulebook = rulebook

    @cached_property
    def _run(self) -> UncertainRun:
        # Judging by states, 5 ms: only where arrays do not tell.
        from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

        trace = with_defined_words(self._trace(), self._rulebook.vocabulary)
        return UncertainRun(trace, self._rulebook)

    def answer(self, rule: str, binding: Mapping[str, str]) -> ViolationOrOpen | None:
        return self._run.answer(rule, binding)

    def answers(self, rule: str) -> list[ViolationOrOpen]:
        return list(self._run.answers(rule))

    def is_doubtful(self, rule: str) -> bool:
        return self._run.is_doubtful(rule)


def _check_objects(traces: JoinedTraces, vocabulary: Vocabulary) -> None:
    """Check the objects of all traces, each type once. Raises RulecError."""
    kinds = frozenset(traces.types)
    check_objects({kind: kind for kind in kinds}, vocabulary)
    most = map(str, range(max(traces.n_objects)))
    check_objects(dict.fromkeys(most, min(kinds, default="")), vocabulary)

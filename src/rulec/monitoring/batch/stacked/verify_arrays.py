"""Verification of traces in arrays, with the same verdicts as ``verify`` on their states.

Any irregular trace, or rule for some objects, is left to ``verify``, as are rules that cannot be
evaluated on arrays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.columns.columnize import UnencodableError
from rulec.monitoring.batch.findings import (
    Findings,
    JudgedTrace,
    Place,
    Reasons,
    RuleFindings,
    ViolationOrOpen,
)
from rulec.monitoring.batch.stacked.contradictions import contradicted
from rulec.monitoring.batch.stacked.joined_traces import side_by_side
from rulec.monitoring.batch.stacked.open_reasons import StackedReasons
from rulec.monitoring.batch.stacked.simple_rules import SimpleRules
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_outcomes import StackedOutcomes, outcomes
from rulec.monitoring.batch.stacked.stacked_rule import ReadKeys, StackedRule
from rulec.monitoring.state_validation import check_objects, check_told
from rulec.monitoring.uncertainty.judged_rules import JudgedRules, judged_rules
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

Answer: TypeAlias = Verdict | NotJudged


def verify_arrays(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Answer]:
    """Answers for traces in arrays, in their order: a verdict, or a ``NotJudged``."""
    judged = judge_arrays(traces, rulebook)
    return [answer_to(own, trace) for own, trace in zip(judged, traces, strict=True)]


def answer_to(judged: JudgedTrace | Answer, trace: TraceArrays) -> Answer:
    """The answer for a trace that has been judged."""
    if isinstance(judged, JudgedTrace):
        return judged.findings.verdict(judged.number, trace)
    return judged


def judge_arrays(
    traces: Sequence[TraceArrays], rulebook: CompiledRulebook
) -> list[JudgedTrace | Answer]:
    """The same as ``verify_arrays``, but verdicts are built on demand by ``answer_to``."""
    answers: list[JudgedTrace | Answer | None] = [None] * len(traces)
    groups: dict[object, list[int]] = {}
    known: dict[int, frozenset[str]] = {}
    for place in side_by_side(traces):
        trace = traces[place]
        names = _names(trace.world, known), _names(trace.about, known)
        key = trace.step_s, trace.ends, trace.told, names
        groups.setdefault(key, []).append(place)
    for places in groups.values():
        together = [traces[place] for place in places]
        judged: Sequence[JudgedTrace | Answer]
        try:
            judged = _StackedRun(together, rulebook).judged()
        except (UnencodableError, RulecError):
            judged = _by_states(together, rulebook)
        for place, own in zip(places, judged, strict=True):
            answers[place] = own
    return [answer for answer in answers if answer is not None]


def _names(columns: Mapping[str, Array], known: dict[int, frozenset[str]]) -> frozenset[str]:
    """The names of columns; ``known`` caches those of columns that several traces share."""
    if not isinstance(columns, SharedColumns):
        return frozenset(columns)
    key = id(columns.columns)
    if key not in known:
        known[key] = frozenset(columns)
    return known[key]


def _check_objects(traces: Sequence[TraceArrays], vocabulary: Vocabulary) -> None:
    """Check the objects of all traces, each type once. Raises RulecError."""
    kinds = frozenset().union(*[trace.objects.values() for trace in traces])
    check_objects({kind: kind for kind in kinds}, vocabulary)
    check_objects(max([trace.objects for trace in traces], key=len), vocabulary)


def _by_states(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Answer]:
    # The engines for states load slowly, and few recordings need them.
    from rulec.monitoring.batch.batch_verify import verify_chunk

    return list(verify_chunk([trace.trace() for trace in traces], rulebook))


def _by_its_states(trace: TraceArrays, rulebook: CompiledRulebook) -> Answer:
    # As above: only for irregular traces.
    from rulec.monitoring.verify import verify_or_reason

    return verify_or_reason(trace.trace(), rulebook)


class _StackedRun:
    """The judgement of traces with the same names. Raises RulecError, UnencodableError."""

    def __init__(self, traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> None:
        example = traces[0]
        self._traces = traces
        self._whole_rulebook = rulebook
        self._rulebook = rules = rulebook.fitted_to(example.step_s)
        key = example.told, example.ends, example.step_s
        known: dict[object, _ReadyRules] = rules.prepared.setdefault(_ReadyRules, {})
        if key not in known:
            known[key] = _ready_rules(example, rules)
        self._ready = known[key]
        _check_objects(traces, rules.vocabulary)
        self._judged = self._ready.judged
        self._stack = Stack(traces, self._judged.vocabulary, self._ready.defaults)
        self._reader = StackReader(self._stack)
        self._closely = [_CloseLook(trace, rules) for trace in traces]
        whole: list[int] = []
        if example.ends == "complete" and example.told is None:
            whole = [number for number, trace in enumerate(traces) if not trace.is_partial]
        names = self._stack.names
        self._findings = Findings(self._judged, len(traces), names, frozenset(whole))
        self._reasons = StackedReasons(self._reader)
        self._odd: set[int] = set()

    def judged(self) -> list[JudgedTrace | Answer]:
        """The judged traces with their findings, and the answers for irregular ones."""
        simple = self._ready.simple_rules(frozenset(self._stack.untold(self._ready.names)))
        self._odd |= contradicted(simple.facts, self._reader)
        busy = simple.busy(self._reader)
        for number, rule in enumerate(self._ready.rules):
            if number not in simple.rules:
                self._add_closely(number, rule)
            elif number in busy:
                rule.forget_many()
                for stacked_outcomes in outcomes(rule, self._reader, self._rulebook):
                    self._add(number, stacked_outcomes)
        self._odd |= self._stack.odd_traces()
        return [
            _by_its_states(trace, self._whole_rulebook)
            if number in self._odd
            else JudgedTrace(self._findings, number)
            for number, trace in enumerate(self._traces)
        ]

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
            finding = self._closely[number].answer(rule.name, binding)
        except RulecError:
            self._odd.add(number)
            return
        if finding is not None:
            self._findings.add_single(number, place, finding)

    def _add_closely(self, rule_number: int, rule: StackedRule) -> None:
        for number, close in enumerate(self._closely):
            try:
                answers = close.answers(rule.rule.name)
            except RulecError:
                self._odd.add(number)
                continue
            for place, answer in enumerate(answers):
                self._findings.add_single(number, (rule_number, place), answer)


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
    _simple: dict[frozenset[str], SimpleRules] = field(default_factory=dict, init=False)

    def simple_rules(self, untold: frozenset[str]) -> SimpleRules:
        """The rules that can be evaluated on arrays if some names are missing, usually all."""
        known = self._simple.get(untold)
        if known is None:
            known = self._simple[untold] = SimpleRules.of(
                {
                    number: rule
                    for number, rule in enumerate(self.rules)
                    if rule.is_simple and untold.isdisjoint(rule.names)
                }
            )
        return known


def _ready_rules(example: TraceArrays, rules: CompiledRulebook) -> _ReadyRules:
    """The rules for traces like this one. Raises RulecError, UnencodableError."""
    for rule in rules.rules:
        check_step(rule, exact_step(example.step_s))
    check_told(example.told, rules.vocabulary)
    constants = rules.vocabulary.constants
    for fact in rules.axioms:
        if counts(fact.formula) or not set(constants).isdisjoint(names_of(fact.formula)):
            raise UnencodableError  # what it says of values is looked up state by state
    judged = judged_rules(rules, example.told, cut=example.ends == "cut")
    keys: ReadKeys = {}
    ready = [
        StackedRule(rule, machine, rules, judged.vocabulary, keys)
        for rule, machine in judged.machines
    ]
    names = frozenset().union(*(rule.names for rule in ready if rule.is_simple))
    return _ReadyRules(judged, ready, names)


class _CloseLook:
    """Verdicts on single rules of one trace, by its states."""

    def __init__(self, trace: TraceArrays, rulebook: CompiledRulebook) -> None:
        self._trace = trace
        self._rulebook = rulebook

    @cached_property
    def _run(self) -> UncertainRun:
        # Judging by states, 5 ms: only where arrays do not tell.
        from rulec.monitoring.implied_values import with_derived_values
        from rulec.monitoring.uncertainty.suppositions import spelled_out
        from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

        vocabulary = self._rulebook.vocabulary
        trace = with_derived_values(spelled_out(self._trace.trace(), vocabulary), vocabulary)
        return UncertainRun(trace, self._rulebook)

    def answer(self, rule: str, binding: Mapping[str, str]) -> ViolationOrOpen | None:
        return self._run.answer(rule, binding)

    def answers(self, rule: str) -> list[ViolationOrOpen]:
        return list(self._run.answers(rule))

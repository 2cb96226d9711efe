"""Verification of traces in arrays, with verdicts equal to ``verify``'s on their states.

Whatever is odd about a trace, or about a rule for some objects, is left to ``verify``, and so are
the rules that arrays cannot be read for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import repeat
from operator import itemgetter
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.outcome_machine import VIOLATED
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.columns.columnize import UnencodableError
from rulec.monitoring.batch.stacked.contradictions import contradicted
from rulec.monitoring.batch.stacked.joined_traces import side_by_side
from rulec.monitoring.batch.stacked.open_reasons import StackedReasons
from rulec.monitoring.batch.stacked.simple_rules import SimpleRules
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_outcomes import (
    StackedOutcomes,
    StackedWords,
    outcomes,
)
from rulec.monitoring.batch.stacked.stacked_rule import ReadKeys, StackedRule
from rulec.monitoring.state_validation import check_objects, check_told
from rulec.monitoring.uncertainty.judged_rules import JudgedRules, judged_rules
from rulec.monitoring.uncertainty.uncertain_machine import Answer as RuleAnswer
from rulec.monitoring.verdict import NotJudged, OpenVerdict, Verdict, Violation
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

Answer: TypeAlias = Verdict | NotJudged

Found: TypeAlias = Violation | OpenVerdict

_Placed: TypeAlias = tuple[tuple[int, ...], Found]
"""What is not kept, after the places of its rule and of its objects."""


_PLACE = itemgetter(0)


def verify_arrays(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Answer]:
    """Answers for traces in arrays, in their order: a verdict, or a ``NotJudged``."""
    answers: list[Answer | None] = [None] * len(traces)
    groups: dict[object, list[int]] = {}
    known: dict[int, frozenset[str]] = {}
    for place in side_by_side(traces):
        trace = traces[place]
        names = _names(trace.world, known), _names(trace.about, known)
        key = trace.step_s, trace.ends, trace.told, names
        groups.setdefault(key, []).append(place)
    for places in groups.values():
        together = [traces[place] for place in places]
        try:
            verdicts = _StackedRun(together, rulebook).verdicts()
        except (UnencodableError, RulecError):
            verdicts = _by_states(together, rulebook)
        for place, verdict in zip(places, verdicts, strict=True):
            answers[place] = verdict
    return [answer for answer in answers if answer is not None]


def _names(said: Mapping[str, Array], known: dict[int, frozenset[str]]) -> frozenset[str]:
    """The names of columns, which are ``known`` of those that several traces share."""
    if not isinstance(said, SharedColumns):
        return frozenset(said)
    key = id(said.columns)
    if key not in known:
        known[key] = frozenset(said)
    return known[key]


def _check_objects(traces: Sequence[TraceArrays], vocabulary: Vocabulary) -> None:
    """Check the objects of all traces, each type once. Raises RulecError."""
    kinds = frozenset().union(*[trace.objects.values() for trace in traces])
    check_objects({kind: kind for kind in kinds}, vocabulary)
    check_objects(max([trace.objects for trace in traces], key=len), vocabulary)


def _by_states(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Answer]:
    # The engines for states, which few recordings need, take long to load.
    from rulec.monitoring.batch.batch_verify import verify_chunk

    return list(verify_chunk([trace.trace() for trace in traces], rulebook))


def _by_its_states(trace: TraceArrays, rulebook: CompiledRulebook) -> Answer:
    # As above: only where something is odd.
    from rulec.monitoring.verify import verify_or_reason

    return verify_or_reason(trace.trace(), rulebook)


class _StackedRun:
    """The judgement of traces that say the same names. Raises RulecError, UnencodableError."""

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
        self._reasons = StackedReasons(self._reader)
        self._closely = [_CloseLook(trace, rules) for trace in traces]
        self._found: list[list[_Placed]] = [[] for _ in traces]
        self._odd: set[int] = set()

    def verdicts(self) -> list[Answer]:
        """The answers."""
        simple = self._ready.simple_rules(frozenset(self._stack.untold(self._ready.names)))
        self._odd |= contradicted(simple.facts, self._reader)
        busy = simple.busy(self._reader)
        for number, rule in enumerate(self._ready.rules):
            if number not in simple.rules:
                self._add_closely(number, rule)
            elif number in busy:
                rule.forget_many()
                for found in outcomes(rule, self._reader, self._rulebook):
                    self._add(number, found)
        self._odd |= self._stack.odd_traces()
        return [
            _by_its_states(trace, self._whole_rulebook)
            if number in self._odd
            else self._verdict(number)
            for number, trace in enumerate(self._traces)
        ]

    def _add(self, rule_number: int, outcomes: StackedOutcomes) -> None:
        words, stack = outcomes.words, self._stack
        instances, variables = words.instances, words.rule.variables
        at = np.array(outcomes.places, dtype=np.intp)
        traces = instances.traces[at]
        begins = (instances.firsts[at] - stack.begins[traces]).tolist()
        objects = [own[at].tolist() for own in instances.objects]
        choices = zip(*objects, strict=True) if objects else repeat(())
        for place, answer, number, begin, chosen in zip(
            outcomes.places, outcomes.answers, traces.tolist(), begins, choices, strict=False
        ):
            if number in self._odd:
                continue
            names = [stack.names[item] for item in chosen]
            binding = dict(zip(variables, names, strict=True))
            found = self._found_in(words, place, answer, (number, begin), binding)
            if found is not None:
                self._found[number].append(((rule_number, *chosen), found))

    def _found_in(
        self,
        words: StackedWords,
        place: int,
        answer: RuleAnswer | None,
        at: tuple[int, int],
        binding: dict[str, str],
    ) -> Found | None:
        """What one of some words comes to, ``at`` its trace and the state that it begins in."""
        rule, (number, begin) = words.rule.rule, at
        if answer is None:
            try:
                return self._closely[number].answer(rule.name, binding)
            except RulecError:
                self._odd.add(number)
                return None
        if answer.best == VIOLATED:
            step = None if answer.step is None else answer.step + begin
            return Violation(rule.name, rule.strength, binding, step)
        why = partial(self._reasons.of, words, place)
        are_two = answer.best != answer.worst
        beyond = partial(self._reasons.beyond, words, place) if are_two else None
        return OpenVerdict.explained_later(rule.name, rule.strength, binding, why, beyond=beyond)

    def _add_closely(self, rule_number: int, rule: StackedRule) -> None:
        for number, close in enumerate(self._closely):
            try:
                answers = close.answers(rule.rule.name)
            except RulecError:
                self._odd.add(number)
                continue
            self._found[number] += [
                ((rule_number, place), found) for place, found in enumerate(answers)
            ]

    def _verdict(self, number: int) -> Verdict:
        found = [result for _, result in sorted(self._found[number], key=_PLACE)]
        trace, judged = self._traces[number], self._judged
        violations = tuple([result for result in found if isinstance(result, Violation)])
        if trace.ends == "complete" and trace.told is None and not trace.is_partial:
            return Verdict(trace.id, violations)
        doubtful = tuple([result for result in found if isinstance(result, OpenVerdict)])
        presumed = tuple([name for name in judged.presumed if not trace.says(name)])
        return Verdict(trace.id, violations, doubtful, judged.not_judged, presumed)


@dataclass(frozen=True, slots=True, eq=False)
class _ReadyRules:
    """What is the same for all traces of one kind.

    ``names`` are those of the ``rules`` that are simple, ``defaults`` what they take where nothing
    is said, as far as it has been asked for.
    """

    judged: JudgedRules
    rules: Sequence[StackedRule]
    names: frozenset[str]
    defaults: dict[str, Any] = field(default_factory=dict, init=False)
    _simple: dict[frozenset[str], SimpleRules] = field(default_factory=dict, init=False)

    def simple_rules(self, untold: frozenset[str]) -> SimpleRules:
        """The rules that arrays can be read for, where some names cannot; mostly the same again."""
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
        from rulec.monitoring.implied_values import with_all_said
        from rulec.monitoring.uncertainty.suppositions import spelled_out
        from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

        vocabulary = self._rulebook.vocabulary
        trace = with_all_said(spelled_out(self._trace.trace(), vocabulary), vocabulary)
        return UncertainRun(trace, self._rulebook)

    def answer(self, rule: str, binding: Mapping[str, str]) -> Found | None:
        return self._run.answer(rule, binding)

    def answers(self, rule: str) -> list[Found]:
        return list(self._run.answers(rule))

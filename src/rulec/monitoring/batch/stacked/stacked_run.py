"""One run of all rules over traces laid end to end: the engine that judges one trace and many."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import KEPT
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import fault_of
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
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces
from rulec.monitoring.batch.stacked.chosen_words import (
    ChosenWords,
    StackedOutcomes,
    WordLetters,
    by_unknown_constants,
    hides_constants,
)
from rulec.monitoring.batch.stacked.contradictions import (
    contradicted,
)
from rulec.monitoring.batch.stacked.crowded_states import CrowdedStates
from rulec.monitoring.batch.stacked.entangled_letters import entangled_letters
from rulec.monitoring.batch.stacked.instances import doubtful_instances, with_all_of
from rulec.monitoring.batch.stacked.open_reasons import StackedReasons
from rulec.monitoring.batch.stacked.ready_rules import ready_rules
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.implied_values import with_defined_words
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.uncertainty.uncertain_machine import Answer
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun


_MOST_EXAMINED = 1 << 20
"""Of traces that contradict facts at most so many pairs of objects times states are examined."""


class StackedRun:
    """The judgement of traces of one kind, each rule on all of them together.

    Raises RulecError or UnencodableError if all of them must be judged by their states.
    """

    def __init__(self, traces: JoinedTraces, rulebook: CompiledRulebook) -> None:
        self._rulebook = rules = rulebook.fitted_to(traces.kind.step_s)
        self._traces, self._n_traces = traces, len(traces.lengths)
        self._ready = ready_rules(traces.kind, rules)
        _check_objects(traces, rules.vocabulary)
        vocabulary, defaults = self._ready.judged.vocabulary, self._ready.defaults
        self._stack = Stack(traces, vocabulary, self._ready.meant, defaults)
        self._reader = StackReader(self._stack)
        self._reasons = StackedReasons(self._reader)
        self._close = _CloseLooks(traces.trace, rules)
        self._simple = self._ready.simple(frozenset(self._stack.untold(self._ready.names)))
        self._odd: set[int] = set()

    def verdicts(self) -> list[Verdict | None]:
        """The verdicts on the traces; None for those that must be judged by their states."""
        id_of, says = self._traces.id_of, self._traces.says
        return [
            own and own.findings.verdict(number, id_of(number), partial(says, number))
            for number, own in enumerate(self.judged())
        ]

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


def outcomes(
    rule: StackedRule, reader: StackReader, rulebook: CompiledRulebook, suspects: Flags
) -> Iterator[StackedOutcomes]:
    """All choices for which a rule is not kept.

    They are sifted three times, ever more exactly: letters in any order (``doubtful_instances``),
    the machine on what each read allows by itself, the machine on what they allow together: fewer
    letters, so that this need not be found out for choices that are kept before. A known letter is
    a set of one, of which best and worst outcome are the same. In traces that are ``suspects`` all
    choices are examined for letters that axioms exclude. Raises UnencodableError.
    """
    instances = doubtful_instances(rule, reader)
    if rule.facts and suspects.any():
        instances = with_all_of(suspects, instances, rule, reader.stack)
    if not len(instances.traces):
        return
    for chosen in by_unknown_constants(rule, reader, instances, rulebook):
        apart = _letters_apart(rule, reader, chosen)
        known = [rule.answers.of(own.letters, chosen.bounds) for own in apart]
        doubtful = suspects[chosen.instances.traces]
        for answers in known:
            doubtful |= [answer is None or answer.worst != KEPT for answer in answers]
        if not doubtful.any():
            continue
        if not doubtful.all():
            members = doubtful.nonzero()[0]
            chosen = chosen.part(rule, reader, members)
            apart = _letters_apart(rule, reader, chosen)
            known = [[answers[member] for member in members.tolist()] for answers in known]
        together, odd = _letters_together(rule, reader, chosen, apart)
        for place, (own, before) in enumerate(zip(together, apart, strict=True)):
            if own.letters is not before.letters:
                known[place] = rule.answers.of(own.letters, chosen.bounds)
        # Letters that axioms exclude make a word odd
        are_odd = np.logical_or.reduceat(odd, chosen.bounds[:-1]).tolist()
        joint = known[0] if len(known) == 1 else map(_combined, zip(*known, strict=True))
        found = [None if is_odd else own for is_odd, own in zip(are_odd, joint, strict=True)]
        kept_not = {n: own for n, own in enumerate(found) if own is None or own.worst != KEPT}
        yield StackedOutcomes(rule, chosen, together, kept_not)


def _letters_apart(
    rule: StackedRule, reader: StackReader, chosen: ChosenWords
) -> Sequence[WordLetters]:
    """The letters for all supposed values, from what each read allows by itself."""
    declarations = reader.stack.vocabulary.declarations
    found = []
    for values in chosen.supposed:
        instead = {}
        for place in chosen.unknown:
            value = values.get(rule.subject(place))
            if value is not None:
                instead[place] = rule.reads[place].number_of(value, declarations)
        numbers = chosen.numbers.with_others(instead) if instead else chosen.numbers
        letters = chosen.instances.letters
        if instead or letters is None:
            letters = rule.letters.letters_of(numbers)
        elif isinstance(letters, np.ndarray):
            letters = letters.take(chosen.spots.states)
        if not isinstance(letters, np.ndarray):
            letters = np.full(len(chosen.spots.states), letters, dtype=np.intp)
        found.append(WordLetters(values, numbers, letters))
    return found


def _letters_together(
    rule: StackedRule, reader: StackReader, chosen: ChosenWords, apart: Sequence[WordLetters]
) -> tuple[Sequence[WordLetters], Flags]:
    """The letters that reads allow together, and where they are odd."""
    odd = hides_constants(rule, reader, chosen.spots)
    if len(chosen.unknown) > 1 and not any(chosen.supposed):
        odd[:] = True
    found: list[WordLetters] = []
    crowd: CrowdedStates | None = None
    for own in apart:
        entangled, letters = None, own.letters
        if rule.related and not odd.all():
            partial = np.zeros(len(letters), dtype=bool)
            partial |= rule.letters.are_partial(own.numbers, rule.related)
            if partial.any():
                about = chosen.spots, partial
                crowd = crowd or CrowdedStates(rule, reader)
                entangled = entangled_letters(
                    rule, reader, about, own.numbers, own.supposed, crowd=crowd
                )
                if entangled is None:
                    odd |= partial
                else:
                    sets = [rule.letters.number_of(classes) for classes in entangled.classes]
                    letters = letters.copy()
                    letters[entangled.places] = np.array(sets, dtype=np.intp)[entangled.numbers]
        if rule.facts:
            for nothing in rule.letters.numbers_of_none:
                odd |= letters == nothing
        found.append(own._replace(letters=letters, entangled=entangled))
    return found, odd


def _combined(of_alternatives: Sequence[Answer | None]) -> Answer | None:
    """The combined answer of several words; None if there is none."""
    answers = [answer for answer in of_alternatives if answer is not None]
    if not answers:
        return None
    steps = [answer.step for answer in answers if answer.step is not None]
    return Answer(
        min(answer.best for answer in answers),
        max(answer.worst for answer in answers),
        max(steps) if len(steps) == len(answers) else None,
    )


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

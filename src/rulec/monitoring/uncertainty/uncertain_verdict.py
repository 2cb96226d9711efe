"""Verdicts on traces in which values are unknown, or that are cut out of something longer.

Per rule and binding: violated if every completion violates the rule, kept if every one keeps it,
else open (cf. Leucker et al., "Runtime verification for timed event streams with partial
information", 2019). A completion is a choice of values for all that is unknown that keeps the
facts. Of a cut trace see ``rulec.automata.prefix_machines``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any, cast

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import KEPT, VIOLATED, OutcomeMachine
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.monitoring.bindings import Binding, bindings
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.completions import Subject, subjects_of_read
from rulec.monitoring.uncertainty.linear_arrangement import LinearPlane, sample_points
from rulec.monitoring.uncertainty.possible_letters import (
    PossibleLetters,
    PossibleWord,
    untold_names,
    with_untold,
)
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine, uncertain_machine
from rulec.monitoring.verdict import OpenVerdict, RuleNotJudged, Verdict, Violation
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, PartialValue
from rulec.vocabulary.vocabulary_model import choices

MOST_ALTERNATIVES = 1 << 6
"""Values of what does not change are gone through as long as there are no more combinations."""


def uncertain_verdict(trace: Trace, rulebook: CompiledRulebook) -> Verdict:
    """The verdict on a checked trace, by a rulebook for its step.

    Raises RulecError R0504 if a value without default is missing, R0508 if a state contradicts a
    fact, R0403 if the trace is cut and Spot, which its machines take, is not installed.
    """
    return _UncertainRun(trace, rulebook).verdict()


class _UncertainRun:
    """The judgement of one trace, with what its rules share."""

    def __init__(self, trace: Trace, rulebook: CompiledRulebook) -> None:
        self.trace = spelled_out(trace, rulebook.vocabulary)
        self.rulebook = rulebook
        self._untold = untold_names(rulebook.vocabulary, trace.told)
        self.vocabulary = with_untold(rulebook.vocabulary, self._untold)
        self._letters: dict[tuple[object, ...], PossibleLetters] = {}

    def verdict(self) -> Verdict:
        trace, rules = self.trace, self.rulebook.rules
        violations: list[Violation] = []
        doubtful: list[OpenVerdict] = []
        not_judged: list[RuleNotJudged] = []
        prefixes: Mapping[str, OutcomeMachine | None] | None = None
        if trace.ends == "cut":
            compiler = self.rulebook.prefixes
            prefixes = {} if compiler is None else compiler(self.rulebook)
        for rule in rules:
            outcomes = None if prefixes is None else prefixes.get(rule.name)
            if prefixes is not None and outcomes is None:
                why = "there is no machine for what it says of a trace that is cut"
                not_judged.append(RuleNotJudged(rule.name, rule.strength, (), why))
                continue
            machine = uncertain_machine(rule, outcomes)
            untold = machine.untold(self._untold)
            if untold:
                not_judged.append(RuleNotJudged(rule.name, rule.strength, untold))
                continue
            for answer in self._answers(rule, machine):
                if isinstance(answer, Violation):
                    violations.append(answer)
                else:
                    doubtful.append(answer)
        said = {name for state in trace.states for name in state}
        read = {name for rule in rules for name in names_in(rule.formula)}
        presumed = tuple(
            name
            for name, item in self.vocabulary.declarations.items()
            if item.presumed and name in read and name not in said
        )
        return Verdict(trace.id, tuple(violations), tuple(doubtful), tuple(not_judged), presumed)

    def _answers(
        self, rule: CompiledRule, machine: UncertainMachine
    ) -> Iterator[Violation | OpenVerdict]:
        trace = self.trace
        declared = self.vocabulary
        for binding in bindings(rule, declared, trace.objects, trace.present, len(trace.states)):
            words, constants, is_exact = self._words(rule, machine, binding)
            answer = machine.answer(words, constants, tuple(declared.declarations))
            if answer.worst == KEPT:
                continue
            objects = binding.objects
            if answer.best == VIOLATED:
                step = None if answer.step is None else binding.first + answer.step
                yield Violation(rule.name, rule.strength, objects, step)
            else:
                yield OpenVerdict(
                    rule.name,
                    rule.strength,
                    objects,
                    answer.because,
                    depends_on=answer.depends_on,
                    outcomes=answer.outcomes,
                    exact=is_exact and answer.exact,
                )

    def _words(
        self, rule: CompiledRule, machine: UncertainMachine, binding: Binding
    ) -> tuple[list[PossibleWord], list[Mapping[str, object]], bool]:
        """The possible words, one for each way to choose what does not change."""
        supposed, is_exact = self._suppositions(rule, binding)
        words, constants = [], []
        for values in supposed:
            letters = self._letters_where(values)
            word = letters.word(rule, binding.objects, binding.first, binding.last)
            words.append(word)
            by_name: dict[str, object] = {}
            for (name, items), value in values.items():
                by_name[name] = (by_name.get(name), items, value) if items else value
            constants.append(by_name)
        broken = [machine.impossible_at(word) for word in words]
        if None not in broken:
            number = binding.first + (broken[0] or 0)
            raise self._letters_where({}).impossible(rule, binding.objects, number)
        possible = [n for n, place in enumerate(broken) if place is None]
        is_exact = is_exact and all(words[n].exact for n in possible)
        return [words[n] for n in possible], [constants[n] for n in possible], is_exact

    def _letters_where(self, values: Mapping[Subject, Value]) -> PossibleLetters:
        key = tuple(values.items())
        if key not in self._letters:
            trace = self.trace
            if values:
                trace = replace(trace, states=tuple(_supposed(trace.states, values)))
            self._letters[key] = PossibleLetters(trace, self.rulebook, self.vocabulary)
        return self._letters[key]

    def _suppositions(
        self, rule: CompiledRule, binding: Binding
    ) -> tuple[list[dict[Subject, Value]], bool]:
        """The values that unknown constants which a rule or a fact reads may have, together."""
        declarations = self.vocabulary.declarations
        facts = [axiom.formula for axiom in self.rulebook.axioms]
        formulas = [rule.formula, *facts]
        in_facts = {name for formula in facts for name in names_in(formula)}
        options: dict[Subject, Sequence[Value]] = {}
        is_exact = True
        for subject in sorted(self._constants_read(rule, binding)):
            bounds = self._constant(subject)
            if type(bounds) not in UNKNOWN_TYPES:
                continue
            values = _constant_values(declarations[subject[0]], bounds, formulas)
            if values:
                options[subject] = values
            # Facts of which nothing is unknown once this is supposed are not held against it.
            is_exact = is_exact and bool(values) and subject[0] not in in_facts
        if prod(map(len, options.values())) > MOST_ALTERNATIVES:
            return [{}], False
        return [
            dict(zip(options, chosen, strict=True)) for chosen in product(*options.values())
        ], is_exact

    def _constants_read(self, rule: CompiledRule, binding: Binding) -> set[Subject]:
        """The constants that a rule reads of these objects, and the facts of anybody."""
        trace, vocabulary = self.trace, self.vocabulary
        if not vocabulary.constants:
            return set()
        everybody = StateView(trace.states[0], trace.objects, vocabulary)
        found = {
            subject
            for read in rule.machine.reads
            for subject in subjects_of_read(read, binding.objects, everybody)
            if vocabulary.declarations[subject[0]].constant
        }
        in_facts = {name for axiom in self.rulebook.axioms for name in names_in(axiom.formula)}
        for name in in_facts.intersection(vocabulary.constants):
            types = vocabulary.declarations[name].parameters
            found |= {(name, items) for items in choices(types, trace.objects, vocabulary)}
        return found

    def _constant(self, subject: Subject) -> PartialValue | None:
        """What the states in which its objects are there, all alike, say of a constant."""
        first = max((self.trace.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
        return self._letters_where({}).values(*subject)[first]


def spelled_out(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace in which a name that is unknown itself is unknown of each object."""
    wanted = {
        name: item.parameters for name, item in vocabulary.declarations.items() if item.parameters
    }

    def each(value: Any, kinds: Sequence[str]) -> Any:
        if not kinds or (value is not UNKNOWN and not isinstance(value, Mapping)):
            return value
        given: Any = value
        if value is UNKNOWN:
            own = trace.objects.items()
            given = {item: UNKNOWN for item, kind in own if vocabulary.is_subtype(kind, kinds[0])}
        return {item: each(inner, kinds[1:]) for item, inner in given.items()}

    if not any(
        name in wanted
        and (value is UNKNOWN or (len(wanted[name]) > 1 and UNKNOWN in cast("Any", value).values()))
        for state in trace.states
        for name, value in state.items()
    ):
        return trace
    states = [
        {name: each(value, wanted.get(name, ())) for name, value in state.items()}
        for state in trace.states
    ]
    return replace(trace, states=tuple(states))


def _supposed(states: Sequence[State], values: Mapping[Subject, Value]) -> Iterator[State]:
    for state in states:
        changed: dict[str, Any] = dict(state)
        for (name, items), value in values.items():
            if not items:
                changed[name] = value
            else:
                changed[name] = _nested(changed.get(name) or {}, items, value)
        yield changed


def _nested(given: Mapping[str, Any], items: tuple[str, ...], value: Value) -> Mapping[str, Any]:
    first, *others = items
    inner = _nested(given.get(first) or {}, tuple(others), value) if others else value
    return {**given, first: inner}


def _constant_values(
    declaration: Declaration, bounds: object, formulas: Sequence[ltl.Formula]
) -> Sequence[Any]:
    """Values that stand for all that formulas can tell apart; none if the name is in sums."""
    name = declaration.name
    match declaration:
        case Enumeration(values=values):
            return list(values)
        case Signal():
            return [False, True]
    limits: set[Fraction] = set()
    for terms, limit in (x for formula in formulas for x in _comparisons_with(name, formula)):
        if len(terms) > 1:
            return []
        limits.add(limit / terms[0][0])
    within = None
    if isinstance(bounds, Interval):
        within = exact(bounds.low), exact(bounds.high)
    number = ltl.QuantityTerm(name)
    planes = [LinearPlane({number: Fraction(1)}, limit) for limit in limits]
    points = sample_points({number: within}, planes)
    return [] if points is None else [point[number] for point in points]


def _comparisons_with(
    name: str, formula: ltl.Formula
) -> Iterator[tuple[Sequence[tuple[Fraction, ltl.Term]], Fraction]]:
    """The sums in which a quantity takes part, with their limits, within counts too."""
    for atom in ltl.atoms_of(formula):
        if isinstance(atom, ltl.Comparison):
            for _, term in atom.terms:
                if isinstance(term, ltl.Count):
                    yield from _comparisons_with(name, term.body)
                elif term.name == name:
                    yield atom.terms, atom.limit

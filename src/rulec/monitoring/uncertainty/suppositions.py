"""Values that stand for all that unknown constants may have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any, cast

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.monitoring.bindings import Binding
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.completions import Subject, subjects_of_read
from rulec.monitoring.uncertainty.linear_arrangement import LinearPlane, sample_points
from rulec.monitoring.uncertainty.possible_letters import PossibleLetters
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, PartialValue
from rulec.vocabulary.vocabulary_model import choices

MOST_ALTERNATIVES = 1 << 6
"""Values of what does not change are gone through as long as there are no more combinations."""


class Suppositions:
    """What may be supposed of the constants of a trace.

    ``vocabulary`` has the defaults of what its states do not say.
    """

    def __init__(self, trace: Trace, rulebook: CompiledRulebook, vocabulary: Vocabulary) -> None:
        self._trace = trace
        self._rulebook = rulebook
        self._vocabulary = vocabulary
        self._letters = PossibleLetters(trace, rulebook, vocabulary)

    def of(self, rule: CompiledRule, binding: Binding) -> tuple[list[dict[Subject, Value]], bool]:
        """The values that unknown constants which a rule or a fact reads may have, together."""
        declarations = self._vocabulary.declarations
        facts = [axiom.formula for axiom in self._rulebook.axioms]
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
        trace, vocabulary = self._trace, self._vocabulary
        if not vocabulary.constants:
            return set()
        everybody = StateView(trace.states[0], trace.objects, vocabulary)
        found = {
            subject
            for read in rule.machine.reads
            for subject in subjects_of_read(read, binding.objects, everybody)
            if vocabulary.declarations[subject[0]].constant
        }
        in_facts = {name for axiom in self._rulebook.axioms for name in names_in(axiom.formula)}
        for name in in_facts.intersection(vocabulary.constants):
            types = vocabulary.declarations[name].parameters
            found |= {(name, items) for items in choices(types, trace.objects, vocabulary)}
        return found

    def _constant(self, subject: Subject) -> PartialValue | None:
        """What the states in which its objects are there, all alike, say of a constant."""
        first = max((self._trace.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
        return self._letters.values(*subject)[first]


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


def with_supposed(trace: Trace, values: Mapping[Subject, Value]) -> Trace:
    """The trace in each of whose states these are the values."""
    return replace(trace, states=tuple(_supposed(trace.states, values))) if values else trace


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

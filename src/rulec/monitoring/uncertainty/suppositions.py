"""Values that represent everything that unknown constants may be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.monitoring.bindings import Binding
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject, subjects_of_read
from rulec.trace import Trace, Value
from rulec.valuations.linear_arrangement import points_on_line
from rulec.vocabulary import Declaration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import (
    UNKNOWN,
    UNKNOWN_TYPES,
    Interval,
    PartialValue,
    UnknownValue,
)
from rulec.vocabulary.vocabulary_model import choices, values_of

MOST_ALTERNATIVES = 1 << 6
"""The most joint values of constants that are tried one after the other."""


class ConstantsReader:
    """The constants that the rules of a rulebook read, for a trace's objects.

    ``of_facts`` are those in axioms.
    """

    def __init__(
        self, rulebook: CompiledRulebook, vocabulary: Vocabulary, objects: Mapping[str, str]
    ) -> None:
        self._vocabulary = vocabulary
        self._constants = frozenset(vocabulary.constants)
        self._everybody = StateView({}, objects, vocabulary)
        self._facts = [axiom.formula for axiom in rulebook.axioms]
        self._in_facts = {name for formula in self._facts for name in names_in(formula)}
        self.of_facts = frozenset(
            (name, items)
            for name in self._in_facts.intersection(self._constants)
            for items in choices(vocabulary.declarations[name].parameters, objects, vocabulary)
        )
        self._reads: dict[str, tuple[Read | NumberRead, ...]] = {}
        """The reads of constants, by the name of the rule."""

    def read_by(self, rule: CompiledRule, objects: Mapping[str, str]) -> frozenset[Subject]:
        """The constants that a rule reads of its objects, and those in axioms about any objects."""
        if rule.name not in self._reads:
            reads = rule.machine.reads
            self._reads[rule.name] = tuple(
                [read for read in reads if not self._constants.isdisjoint(names_of_read(read))]
            )
        return self.of_facts.union(
            subject
            for read in self._reads[rule.name]
            for subject in subjects_of_read(read, objects, self._everybody)
            if subject[0] in self._constants
        )

    def suppositions(
        self, rule: CompiledRule, given: Mapping[Subject, PartialValue | None]
    ) -> tuple[list[dict[Subject, Value]], bool]:
        """The joint values of the constants, given what is known of them.

        The second item says whether each of these is possible.
        """
        formulas = [rule.formula, *self._facts]
        options: dict[Subject, Sequence[Value]] = {}
        is_exact = True
        for subject in sorted(given):
            bounds = given[subject]
            if type(bounds) not in UNKNOWN_TYPES:
                continue
            values = _values_of(self._vocabulary.declarations[subject[0]], bounds, formulas)
            if values:
                options[subject] = values
            # Axioms that become fully known by these values are not checked here.
            is_exact = is_exact and bool(values) and subject[0] not in self._in_facts
        if prod(map(len, options.values())) > MOST_ALTERNATIVES:
            return [{}], False
        return [
            dict(zip(options, chosen, strict=True)) for chosen in product(*options.values())
        ], is_exact


def by_name(supposed: Mapping[Subject, Value]) -> dict[str, object]:
    """Supposed values of constants by name, for comparison."""
    named: dict[str, object] = {}
    for (name, items), value in supposed.items():
        named[name] = (named.get(name), items, value) if items else value
    return named


def _values_of(
    declaration: Declaration, bounds: object, formulas: Sequence[ltl.Formula]
) -> Sequence[Any]:
    """Values that represent all that formulas distinguish; none if the name is in sums."""
    name = declaration.name
    if not isinstance(declaration, Quantity):
        return values_of(declaration)
    limits: set[Fraction] = set()
    for own in (x for formula in formulas for x in _comparisons_in(formula)):
        if any(isinstance(term, ltl.QuantityTerm) and term.name == name for _, term in own.terms):
            if len(own.terms) > 1:
                return []
            limits.add(own.limit / own.terms[0][0])
    within = None
    if isinstance(bounds, Interval):
        within = exact(bounds.low), exact(bounds.high)
    return points_on_line(limits, within)


def _comparisons_in(formula: ltl.Formula) -> Iterator[ltl.Comparison]:
    """The comparisons of a formula, including those within counts."""
    for atom in ltl.atoms_of(formula):
        if isinstance(atom, ltl.Comparison):
            yield atom
            for _, term in atom.terms:
                if isinstance(term, ltl.Count):
                    yield from _comparisons_in(term.body)


class Suppositions:
    """The values that may be supposed for the constants of a trace.

    ``vocabulary`` has the defaults of values missing in its states, ``letters`` read them.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        letters: PossibleLetters,
    ) -> None:
        self._trace = trace
        self._reader = ConstantsReader(rulebook, vocabulary, trace.objects)
        self._letters = letters

    def of(self, rule: CompiledRule, binding: Binding) -> tuple[list[dict[Subject, Value]], bool]:
        """The joint values that unknown constants read by a rule or an axiom may have."""
        subjects = self._reader.read_by(rule, binding.objects)
        if not subjects:
            return [{}], True
        return self._reader.suppositions(rule, {x: self._constant(x) for x in subjects})

    def _constant(self, subject: Subject) -> PartialValue | None:
        """The value of a constant, which is the same in all states with its objects."""
        first = max((self._trace.present.get(x, (0, 0))[0] for x in subject[1]), default=0)
        return self._letters.values(*subject)[first]


def spelled_out(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace in which a name that is unknown as a whole is unknown for each object."""
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

    nested = [name for name, kinds in wanted.items() if len(kinds) > 1]

    def is_short(state: Any) -> bool:
        if UnknownValue in map(type, state.values()) and any(
            state.get(name) is UNKNOWN for name in wanted
        ):
            return True
        return any(name in state and UNKNOWN in state[name].values() for name in nested)

    if not any(map(is_short, trace.states)):
        return trace
    states = [
        {name: each(value, wanted.get(name, ())) for name, value in state.items()}
        for state in trace.states
    ]
    return replace(trace, states=tuple(states))

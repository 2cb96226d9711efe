"""Axioms that exclude all states, and rules whose trigger is excluded.

These are found without automata if few values have to be tried; the rest is left to the compiler
and to `rulec analyze`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import pairwise
from math import floor
from typing import Any

from rulec.diagnostics import Diagnostic, Span
from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.linear_comparison import stands
from rulec.rulebook.rulebook_model import Axiom, Rule, Variable
from rulec.rulebook.rules import axiom_messages as say
from rulec.rulebook.rules.antecedents import antecedents, has_constant
from rulec.rulebook.rules.axiom_instances import (
    AxiomInstance,
    axiom_instances,
    linked,
    subjects_of,
)
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.vocabulary.vocabulary_model import number_of_choices

_MOST_INSTANCES = 200
"""The most instances of axioms that are examined together."""


def contradictions(
    variables: Sequence[Variable], axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[Diagnostic]:
    """Errors (R0409) for axioms that exclude all states of the objects that variables stand for.

    No axiom is in two of them.
    """
    for group in _groups(variables, axioms, vocabulary):
        rest = list(group)
        while not may_hold([instance.formula for instance in rest], vocabulary):
            needed = _needed(rest, (), vocabulary)
            yield say.contradictory_facts(needed, variables)
            reported = {id(instance.fact) for instance in needed}
            rest = [instance for instance in rest if id(instance.fact) not in reported]


def all_contradictions(axioms: Sequence[Axiom], vocabulary: Vocabulary) -> list[Diagnostic]:
    """The same for the objects in each of the axioms, with each set of axioms once."""
    scenes = dict.fromkeys(axiom.variables for axiom in axioms)
    diagnostics: dict[object, Diagnostic] = {}
    for variables in sorted(scenes, key=len):
        for diagnostic in contradictions(variables, axioms, vocabulary):
            diagnostics.setdefault((diagnostic.place, diagnostic.message), diagnostic)
    return list(diagnostics.values())


def impossible_triggers(
    rule: Rule, axioms: Sequence[Axiom], vocabulary: Vocabulary, span: Span | None
) -> Iterator[Diagnostic]:
    """Warnings (R0363), about a place, for triggers that no state can satisfy.

    An axiom that an option switches on says nothing about the rulebook with another option.
    """
    lasting = [axiom for axiom in axioms if not has_constant(axiom.formula)]
    groups = [*_groups(rule.variables, lasting, vocabulary)]
    for role, trigger in _triggers(rule):
        about = {ltl.subject_of(atom) for atom in ltl.atoms_of(trigger)}
        related = [instance for group in groups if subjects_of(group) & about for instance in group]
        if may_hold([trigger, *(instance.formula for instance in related)], vocabulary):
            continue
        needed = _needed(related, (trigger,), vocabulary)
        yield say.ruled_out(role, trigger, needed, span)


def _groups(
    variables: Sequence[Variable], axioms: Sequence[Axiom], vocabulary: Vocabulary
) -> Iterator[tuple[AxiomInstance, ...]]:
    """Instances of axioms in independent groups; none if there are too many."""
    objects = {variable.name: variable.type for variable in variables}
    types = ([variable.type for variable in axiom.variables] for axiom in axioms)
    number = sum(number_of_choices(own, objects, vocabulary) for own in types)
    if number <= _MOST_INSTANCES:
        yield from linked(axiom_instances(variables, axioms, vocabulary))


def _triggers(rule: Rule) -> Iterator[tuple[str, ltl.Formula]]:
    for antecedent in antecedents(rule):
        yield f"{antecedent.in_words} of rule `{rule.name}`", antecedent.formula
    match rule.required or rule.formula:
        case ltl.Unary(ltl.UnaryOperator.NEVER, operand) if not has_constant(operand):
            yield f"what rule `{rule.name}` forbids", operand


def _needed(
    instances: Sequence[AxiomInstance], others: Sequence[ltl.Formula], vocabulary: Vocabulary
) -> tuple[AxiomInstance, ...]:
    """A minimal set of instances that cannot hold together with other formulas."""
    needed = [*instances]
    for instance in instances:
        fewer = [axiom for axiom in needed if axiom is not instance]
        if not may_hold([*others, *(axiom.formula for axiom in fewer)], vocabulary):
            needed = fewer
    return tuple(needed)


_MOST_ATOMS = 100
_MOST_LOOKED_AT = 200_000
"""The most atoms in one question, and the most evaluations.

Larger questions are left to the compiler.
"""


@dataclass(frozen=True, slots=True)
class _Open:
    """The unknown value that decides: of an atom, a number, or a temporal part."""

    subject: object


def may_hold(formulas: Sequence[ltl.Formula], vocabulary: Vocabulary) -> bool:
    """False if no state satisfies all formulas; True also if this takes too long to decide."""
    atoms = [atom for formula in formulas for atom in ltl.atoms_of(formula)]
    if len(atoms) > _MOST_ATOMS:
        return True
    return _Search(formulas, _values(atoms, vocabulary), size=len(formulas) + len(atoms)).finds({})


@dataclass(slots=True)
class _Search:
    formulas: Sequence[ltl.Formula]
    values: Mapping[object, Sequence[object]]
    size: int
    left: int = field(default=_MOST_LOOKED_AT)

    def finds(self, known: Mapping[object, object]) -> bool:
        """Whether what is known of a state can be completed such that all formulas hold."""
        self.left -= self.size
        if self.left < 0:
            return True
        first: _Open | None = None
        algebra = _algebra(known)
        for formula in self.formulas:
            value = fold(formula, algebra)
            if value is False:
                return False
            if isinstance(value, _Open) and first is None:
                first = value
        if first is None:
            return True
        values = self.values.get(first.subject, (False, True))
        return any(self.finds({**known, first.subject: value}) for value in values)


def _algebra(known: Mapping[object, object]) -> Algebra[bool | _Open]:
    """The truth of formulas in a state of which something is known, or what else decides it."""

    def proposition(asked: ltl.Proposition) -> bool | _Open:
        if isinstance(asked, ltl.Atom):
            subject = ltl.subject_of(asked)
            value = known.get(subject)
            return _Open(subject) if value is None else value == (asked.value or True)
        number: Any = known.get(asked.terms)
        return _Open(asked.terms) if number is None else stands(number, asked.relation, asked.limit)

    def anything(part: ltl.Formula, *_: object) -> bool | _Open:
        value = known.get(part)
        return _Open(part) if value is None else value is True

    return Algebra(
        proposition=proposition,
        constant=bool,
        negation=lambda value: value if isinstance(value, _Open) else not value,
        conjunction=partial(_joined, settles=False),
        disjunction=partial(_joined, settles=True),
        equivalence=_equivalence,
        identity=anything,
        operation=anything,
    )


def _joined(first: bool | _Open, second: bool | _Open, *, settles: bool) -> bool | _Open:
    if first is settles or second is settles:
        return settles
    return first if isinstance(first, _Open) else second


def _equivalence(first: bool | _Open, second: bool | _Open) -> bool | _Open:
    unknown = [value for value in (first, second) if isinstance(value, _Open)]
    return unknown[0] if unknown else first is second


def _values(
    atoms: Iterable[ltl.Proposition], vocabulary: Vocabulary
) -> dict[object, Sequence[object]]:
    """The values to try for everything in atoms, the most usual first."""
    limits: dict[tuple[tuple[Fraction, ltl.Term], ...], set[Fraction]] = {}
    values: dict[object, Sequence[object]] = {}
    for proposition in atoms:
        if isinstance(proposition, ltl.Comparison):
            limits.setdefault(proposition.terms, set()).add(proposition.limit)
            continue
        if isinstance(proposition, ltl.Calculated):
            continue
        declaration = vocabulary.declarations[proposition.name]
        usual = declaration.default
        every = declaration.values if isinstance(declaration, Enumeration) else (False, True)
        values[ltl.subject_of(proposition)] = sorted(every, key=lambda value: value != usual)
    for terms, own in limits.items():
        is_count = len(terms) == 1 and isinstance(terms[0][1], ltl.Count)
        values[terms] = _whole(own) if is_count else _around(own)
    return values


def _around(limits: Iterable[Fraction]) -> list[Fraction]:
    """A number in each part of the number line between limits."""
    ascending = sorted(limits)
    between = [(low + high) / 2 for low, high in pairwise(ascending)]
    return [*ascending, *between, ascending[0] - 1, ascending[-1] + 1]


def _whole(limits: Iterable[Fraction]) -> list[Fraction]:
    """The same for numbers of objects."""
    near = {floor(limit) + more for limit in limits for more in (-1, 0, 1)}
    return [Fraction(number) for number in sorted({0, *near}) if number >= 0]

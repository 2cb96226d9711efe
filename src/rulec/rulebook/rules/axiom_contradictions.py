"""Axioms that exclude all states, and rules whose trigger is excluded.

These are found without automata if few values have to be tried; the rest is left to the compiler
and to `rulec analyze`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.diagnostics import Diagnostic, Span
from rulec.logic import formula as ltl
from rulec.rulebook.rulebook_model import Axiom, Rule, Variable
from rulec.rulebook.rules import axiom_messages as say
from rulec.rulebook.rules.antecedents import antecedents, has_constant
from rulec.rulebook.rules.axiom_instances import (
    AxiomInstance,
    axiom_instances,
    linked,
    subjects_of,
)
from rulec.rulebook.rules.possible_states import may_hold
from rulec.vocabulary import Vocabulary
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

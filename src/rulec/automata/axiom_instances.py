"""Axioms of a rulebook, instantiated for the variables of a rule.

A fact holds for all distinct objects of its types, so it holds for a rule's variables in every way
that they fit. Facts that count are no part of this: how many objects there are, and which, is
another matter in every state, so traces alone can tell (``rulec.monitoring.axiom_violations``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata import alphabet
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.free_names import rename_variables
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices


@dataclass(frozen=True, slots=True)
class AxiomInstance:
    """Axiom instantiated for a rule's ``variables``, in order of its own."""

    fact: Axiom
    variables: tuple[str, ...]
    formula: ltl.Formula


def axiom_instances(
    variables: Sequence[Variable], axioms: Iterable[Axiom], vocabulary: Vocabulary
) -> tuple[AxiomInstance, ...]:
    """Instances of every axiom for distinct variables of its types or subtypes.

    Facts without variables are said once, facts that count are left out.
    """
    types = {variable.name: variable.type for variable in variables}
    instances = []
    for fact in axioms:
        if counts(fact.formula):
            continue
        own = [variable.name for variable in fact.variables]
        for chosen in choices([variable.type for variable in fact.variables], types, vocabulary):
            renaming = dict(zip(own, chosen, strict=True))
            formula = rename_variables(fact.formula, renaming)
            instances.append(AxiomInstance(fact, chosen, formula))
    return tuple(instances)


def counts(formula: ltl.Formula) -> bool:
    """Tell whether a formula contains a count of objects."""
    return any(
        isinstance(term, ltl.Count)
        for atom in ltl.atoms_of(formula)
        if isinstance(atom, ltl.Comparison)
        for _, term in atom.terms
    )


@dataclass(frozen=True, slots=True)
class AxiomGroup:
    """Instances of facts that have to do with each other.

    ``natural`` is what is known besides of all that they speak of, in theirs and a rule's words.
    """

    natural: ltl.Formula
    instances: tuple[AxiomInstance, ...]

    @property
    def known(self) -> ltl.Formula:
        """All of it."""
        return alphabet.joined(
            alphabet.AND, [self.natural, *(instance.formula for instance in self.instances)]
        )


def axiom_groups(
    propositions: Iterable[ltl.Proposition],
    instances: Iterable[AxiomInstance],
    vocabulary: Vocabulary,
) -> tuple[AxiomGroup, ...]:
    """Independent groups of axioms, for a rule of these propositions."""
    every = tuple(propositions)
    groups = []
    for group in linked(instances):
        about = _subjects(group)
        touched = [
            proposition for proposition in every if alphabet.subject_of(proposition) in about
        ]
        whole = alphabet.joined(alphabet.AND, [*touched, *(instance.formula for instance in group)])
        natural = alphabet.knowledge(
            alphabet.reads_of(whole, vocabulary), alphabet.propositions_of(whole)
        )
        groups.append(AxiomGroup(natural, group))
    return tuple(groups)


def linked(instances: Iterable[AxiomInstance]) -> Iterator[tuple[AxiomInstance, ...]]:
    """The instances in groups that have nothing to do with each other."""
    groups: list[tuple[set[object], list[AxiomInstance]]] = []
    for instance in instances:
        about, members = _subjects([instance]), [instance]
        for group in [group for group in groups if group[0] & about]:
            groups.remove(group)
            about |= group[0]
            members = [*group[1], *members]
        groups.append((about, members))
    for _, members in groups:
        yield tuple(members)


def possible_letters(reads: Sequence[Read | NumberRead], known: ltl.Formula) -> int:
    """Bit set of letters in which a formula without time operators holds."""
    sets = alphabet.letters_with(reads, alphabet.propositions_of(known))
    return _letters_where(known, sets, everything=(1 << alphabet.count_letters(reads)) - 1)


def _letters_where(
    formula: ltl.Formula, sets: Mapping[ltl.Proposition, int], everything: int
) -> int:
    match formula:
        case ltl.Atom() | ltl.Comparison():
            return sets[formula]
        case ltl.Constant(value):
            return everything if value else 0
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return everything & ~_letters_where(operand, sets, everything)
        case ltl.Binary(operator, left, right):
            first = _letters_where(left, sets, everything)
            second = _letters_where(right, sets, everything)
            if operator is alphabet.AND:
                return first & second
            if operator is alphabet.OR:
                return first | second
    raise TypeError("what is known is said by `not`, `and` and `or`")


def _subjects(instances: Iterable[AxiomInstance]) -> set[object]:
    return {
        alphabet.subject_of(atom)
        for instance in instances
        for atom in ltl.atoms_of(instance.formula)
    }

"""The axioms of a rulebook, instantiated for the variables of a rule.

An axiom holds for all distinct objects of its types, so it holds for a rule's variables in every
way that they fit. Counting axioms are not included: how many objects there are, and which, differs
from state to state, so only traces can tell (``rulec.monitoring.axiom_violations``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.logic import formula as ltl
from rulec.logic.free_names import reads_in, rename_variables
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices


@dataclass(frozen=True, slots=True)
class AxiomInstance:
    """An axiom instantiated for a rule's ``variables``, in the order of its own."""

    fact: Axiom
    variables: tuple[str, ...]
    formula: ltl.Formula


def axiom_instances(
    variables: Sequence[Variable], axioms: Iterable[Axiom], vocabulary: Vocabulary
) -> tuple[AxiomInstance, ...]:
    """Instances of every axiom for distinct variables of its types or subtypes.

    Axioms without variables occur once, counting axioms are left out.
    """
    types = {variable.name: variable.type for variable in variables}
    instances = []
    for fact in axioms:
        if counts(fact.formula):
            continue
        for renaming in bound_to(fact.variables, types, vocabulary):
            formula = rename_variables(fact.formula, renaming)
            instances.append(AxiomInstance(fact, tuple(renaming.values()), formula))
    return tuple(instances)


def bound_to(
    variables: Sequence[Variable], objects: Mapping[str, str], vocabulary: Vocabulary
) -> Iterator[dict[str, str]]:
    """Each way to bind variables to distinct objects of their types, as ``choices``."""
    names = [variable.name for variable in variables]
    for chosen in choices([variable.type for variable in variables], objects, vocabulary):
        yield dict(zip(names, chosen, strict=True))


def counts(formula: ltl.Formula) -> bool:
    """Tell whether a formula contains a count of objects."""
    return any(isinstance(read, ltl.Count) for read in reads_in(formula))


def linked(instances: Iterable[AxiomInstance]) -> Iterator[tuple[AxiomInstance, ...]]:
    """The instances in independent groups."""
    groups: list[tuple[set[object], list[AxiomInstance]]] = []
    for instance in instances:
        about, members = subjects_of([instance]), [instance]
        for group in [group for group in groups if group[0] & about]:
            groups.remove(group)
            about |= group[0]
            members = [*group[1], *members]
        groups.append((about, members))
    for _, members in groups:
        yield tuple(members)


def subjects_of(instances: Iterable[AxiomInstance]) -> set[object]:
    """The subjects of instances."""
    return {
        ltl.subject_of(atom) for instance in instances for atom in ltl.atoms_of(instance.formula)
    }

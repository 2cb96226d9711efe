"""What the facts of a rulebook say of the objects that a rule speaks of.

A fact holds for all distinct objects of its types, so it holds for a rule's variables in every way
that they fit. Facts that count are no part of this: how many objects there are, and which, is
another matter in every state, so traces alone can tell (``rulec.runtime.facts``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from rulec.automata.letters import AND, joined, knowledge, propositions_of, reads_of
from rulec.logic.formula import Comparison, Constant, Count, Formula, Proposition, atoms_of
from rulec.logic.renaming import renamed
from rulec.rulebook.model import Fact, Variable
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.choices import choices


@dataclass(frozen=True, slots=True)
class FactInstance:
    """A fact, said of a rule's variables: ``variables`` are those in the places of its own."""

    fact: Fact
    variables: tuple[str, ...]
    formula: Formula


def fact_instances(
    variables: Sequence[Variable], facts: Iterable[Fact], vocabulary: Vocabulary
) -> tuple[FactInstance, ...]:
    """Every fact in every way to say it of distinct variables of its types, or of subtypes.

    Facts without variables are said once, facts that count are left out.
    """
    types = {variable.name: variable.type for variable in variables}
    return tuple(
        FactInstance(fact, chosen, renamed(fact.formula, dict(zip(own, chosen, strict=True))))
        for fact in facts
        if not counts(fact.formula)
        for own in [[variable.name for variable in fact.variables]]
        for chosen in choices([variable.type for variable in fact.variables], types, vocabulary)
    )


def counts(formula: Formula) -> bool:
    """Does it speak of how many objects there are, or whether there are some?"""
    return any(
        isinstance(term, Count)
        for one in atoms_of(formula)
        if isinstance(one, Comparison)
        for _, term in one.terms
    )


def known_of(
    propositions: Sequence[Proposition], instances: Iterable[FactInstance], vocabulary: Vocabulary
) -> Formula:
    """All that is known of propositions at any instant.

    An enumeration has one value, a number is on one side of each threshold, facts hold. The facts
    may bring in more propositions than these, of which the same is known; what is known of these
    alone is what holds for some values of the others. A fact that has nothing to do with these is
    left out, even if it cannot hold.
    """
    own = {_subject(one) for one in propositions}
    together = [one for group in linked(instances) if own & _subjects(group) for one in group]
    return _known(propositions, [one.formula for one in together], vocabulary)


def known_together(
    propositions: Iterable[Proposition], group: Sequence[FactInstance], vocabulary: Vocabulary
) -> Formula:
    """All that is known of what these facts speak of, in these propositions and in their own."""
    about = _subjects(group)
    touched = [one for one in propositions if _subject(one) in about]
    return _known(touched, [one.formula for one in group], vocabulary)


def _known(
    propositions: Sequence[Proposition], facts: Sequence[Formula], vocabulary: Vocabulary
) -> Formula:
    if not (propositions or facts):
        return Constant(True)
    spoken = joined(AND, [*propositions, *facts])
    natural = knowledge(reads_of(spoken, vocabulary), propositions_of(spoken))
    return joined(AND, [natural, *facts])


def linked(instances: Iterable[FactInstance]) -> Iterator[tuple[FactInstance, ...]]:
    """The instances in groups that have nothing to do with each other."""
    groups: list[tuple[set[object], list[FactInstance]]] = []
    for one in instances:
        about, members = _subjects([one]), [one]
        for group in [group for group in groups if group[0] & about]:
            groups.remove(group)
            about |= group[0]
            members = [*group[1], *members]
        groups.append((about, members))
    for _, members in groups:
        yield tuple(members)


def _subjects(instances: Iterable[FactInstance]) -> set[object]:
    return {_subject(atom) for one in instances for atom in atoms_of(one.formula)}


def _subject(one: Proposition) -> object:
    """What has a value by which a proposition is true or false."""
    return one.terms if isinstance(one, Comparison) else (one.name, one.arguments)

"""Groups of related axioms, as formulas over a rule's letters."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rulec.automata import alphabet
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.fold import bit_sets, fold
from rulec.rulebook.rules.axiom_instances import AxiomInstance, linked, subjects_of
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class AxiomGroup:
    """Instances of facts that are related to each other.

    ``natural`` is what their types imply about the propositions of these facts and the rule's
    propositions on the same subjects (``alphabet.knowledge``).
    """

    natural: ltl.Formula
    instances: tuple[AxiomInstance, ...]

    @property
    def known(self) -> ltl.Formula:
        """The conjunction of the group's knowledge."""
        return alphabet.joined(
            alphabet.AND, [self.natural, *(instance.formula for instance in self.instances)]
        )


def axiom_groups(
    propositions: Iterable[ltl.Proposition],
    instances: Iterable[AxiomInstance],
    vocabulary: Vocabulary,
) -> tuple[AxiomGroup, ...]:
    """The independent groups of axioms for a rule over these propositions."""
    every = tuple(propositions)
    groups = []
    for group in linked(instances):
        about = subjects_of(group)
        touched = [proposition for proposition in every if ltl.subject_of(proposition) in about]
        whole = alphabet.joined(alphabet.AND, [*touched, *(instance.formula for instance in group)])
        natural = alphabet.knowledge(
            alphabet.reads_of(whole, vocabulary), alphabet.propositions_of(whole)
        )
        groups.append(AxiomGroup(natural, group))
    return tuple(groups)


def possible_letters(reads: Sequence[Read | NumberRead], known: ltl.Formula) -> int:
    """The bit set of the letters in which a formula without temporal operators holds."""
    sets = alphabet.letters_with(reads, alphabet.propositions_of(known))
    return fold(known, bit_sets(sets, (1 << alphabet.count_letters(reads)) - 1))

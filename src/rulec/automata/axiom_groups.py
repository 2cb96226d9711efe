"""Groups of axioms that have to do with each other, in a rule's letters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata import alphabet
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.rulebook.rules.axiom_instances import AxiomInstance, linked, subjects_of
from rulec.vocabulary import Vocabulary


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
        about = subjects_of(group)
        touched = [proposition for proposition in every if ltl.subject_of(proposition) in about]
        whole = alphabet.joined(alphabet.AND, [*touched, *(instance.formula for instance in group)])
        natural = alphabet.knowledge(
            alphabet.reads_of(whole, vocabulary), alphabet.propositions_of(whole)
        )
        groups.append(AxiomGroup(natural, group))
    return tuple(groups)


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

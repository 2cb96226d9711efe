"""The digits of reads by the joint values of words, from one truth table for all states.

So a few conjunctions show what a partly known state allows, even if it was never met before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import reduce
from itertools import chain
from math import prod
from operator import itemgetter, or_
from typing import Any

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.completions.completions import Digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance
from rulec.monitoring.uncertainty.state_letters.truth_table import Bits, TruthTable
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import PartialView, Subject
from rulec.trace import Value
from rulec.vocabulary import Quantity
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import values_of

MOST_WAYS = 1 << 15
"""The most ways to give subjects values that fit into one set of bits (of 4 kB)."""


class JointValues:
    """The digits of reads by the ways to give ``subjects`` values that ``facts`` about them allow.

    Raises LookupError if there are too many ways, if a number other than a count is compared, or if
    a fact is about more than the subjects.
    """

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        facts: Sequence[FactInstance],
        binding: Mapping[str, str],
        everybody: PartialView,
    ) -> None:
        formulas = [fact.formula for fact in facts]
        formulas += [formula for read in reads for formula in _conditions(read)]
        groups = list(_told_apart([name for name, _ in subjects], formulas, everybody))
        if prod(map(len, groups)) > MOST_WAYS:
            raise LookupError
        table = TruthTable(dict(zip(subjects, groups, strict=True)), [{}], everybody)
        self._all = table.all
        self._ways: list[dict[Any, Bits]] = [
            {**table.words[subject], UNKNOWN: table.all} for subject in subjects
        ]
        """For each subject the ways that have a value."""
        places = {subject: place for place, subject in enumerate(subjects)}
        self._facts = [
            (
                [places[x] for x in fact.about(everybody)],
                table.truth(fact.formula, fact.environment).sure,
            )
            for fact in facts
        ]
        self._allowed = reduce(int.__and__, [kept for _, kept in self._facts], self._all)
        self._digits = [table.digits(read, binding) for read in reads]

    def digits(
        self, values: Sequence[PartialValue | None]
    ) -> tuple[Digits | None, frozenset[Digits]]:
        """The digits of the reads for these values of the subjects.

        First those that each read by itself has, if it has only one, then the possible joint ones.
        Axioms about known values are assumed to hold. Raises LookupError if a value is missing or
        no digits are possible.
        """
        given = self._all
        for own, value in zip(self._ways, values, strict=True):
            if value not in own and isinstance(value, OneOf):
                own[value] = reduce(or_, [own[single] for single in value.values])
            given &= own[value]
        ways = given & self._allowed
        if not ways:
            ways = given
            for places, kept in self._facts:
                if any(type(values[place]) in UNKNOWN_TYPES for place in places):
                    ways &= kept
        partial_digits: list[tuple[Digits, Bits]] = [((), ways)] if ways else []
        for own_digits in self._digits:
            partial_digits = [
                ((*before, digit), both)
                for before, so_far in partial_digits
                for digit, bits in own_digits.items()
                if (both := so_far & bits)
            ]
        if not partial_digits:
            raise LookupError
        alone = [[x for x, bits in own.items() if bits & given] for own in self._digits]
        known = tuple([x for x, *more in alone if not more])
        joint = frozenset([digits for digits, _ in partial_digits])
        return known if len(known) == len(alone) else None, joint


def _conditions(read: Read | NumberRead) -> Iterator[ltl.Formula]:
    """What decides a read: whether a word has each value, or what is counted."""
    if isinstance(read, Read):
        yield from (ltl.Atom(read.name, read.variables, value) for value in read.values or (None,))
    else:
        yield from (term.body for _, term in read.terms if isinstance(term, ltl.Count))


def _told_apart(
    names: Iterable[str], formulas: Iterable[ltl.Formula], everybody: PartialView
) -> Iterator[Sequence[Sequence[Value]]]:
    """The values of each word, in groups that no formula distinguishes."""
    propositions = [*chain.from_iterable(map(ltl.atoms_of, formulas))]
    if any(isinstance(x, ltl.Comparison) for x in propositions):
        raise LookupError
    told = {(x.name, x.value) for x in propositions if isinstance(x, ltl.Atom)}
    for name in names:
        declaration = everybody.vocabulary.declarations[name]
        if isinstance(declaration, Quantity):
            raise LookupError
        values = values_of(declaration)
        rest = [value for value in values if (name, value) not in told]
        if (name, None) in told or not rest:
            yield [[value] for value in values]
        else:
            yield [*[[value] for value in values if value not in rest], rest]


def values_at(keys: Sequence[Any]) -> Callable[[Any], tuple[Any, ...]]:
    """A getter of the values at these keys or places; LookupError if one is missing.

    Unlike ``itemgetter`` it always returns a tuple.
    """
    if len(keys) > 1:
        return itemgetter(*keys)
    if keys:
        (key,) = keys
        return lambda given: (given[key],)
    return lambda _: ()

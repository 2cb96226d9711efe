"""Joint values of words and truth values, as bits of their combinations.

Each way to give the subjects values has a bit, as in a truth table: the value of a subject, the
ways that an axiom allows, and the ways in which a read has a digit are sets of bits. So a few
conjunctions show what a partly known state allows, even if it was never met before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from itertools import chain
from operator import itemgetter, or_
from typing import Any, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.fold import bit_sets, fold
from rulec.monitoring.uncertainty.state_letters.completions.completion_search import digit_of_count
from rulec.monitoring.uncertainty.state_letters.completions.completions import Digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    candidates,
)
from rulec.trace import Value
from rulec.vocabulary import Quantity
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import values_of

MOST_KNOWN = 1 << 14
"""How many values keep their results before all are discarded."""

MOST_WAYS = 1 << 15
"""The most ways to give subjects values that fit into one set of bits (of 4 kB)."""

Bits: TypeAlias = int
"""A set of ways to give all subjects values."""


class JointValues:
    """The digits of reads by the ways to give ``subjects`` values that ``facts`` about them allow.

    Raises LookupError if there are too many ways, if something is a number that does not count, or
    if a fact is about more than the subjects.
    """

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        facts: Sequence[FactInstance],
        binding: Mapping[str, str],
        everybody: PartialView,
    ) -> None:
        conditions = [list(_conditions(read, binding, everybody)) for read in reads]
        formulas = [formula for formula, _ in chain(facts, *conditions)]
        self._all = 1
        self._ways: list[dict[Any, Bits]] = []
        """For each subject the ways that have a value."""
        for groups in _told_apart([name for name, _ in subjects], formulas, everybody):
            before, size = self._all, self._all.bit_length()
            if size * len(groups) > MOST_WAYS:
                raise LookupError
            # Each way so far is repeated for each group of values
            self._all = (1 << size * len(groups)) - 1
            self._ways = [
                {value: _repeated(ways, size, len(groups)) for value, ways in own.items()}
                for own in self._ways
            ]
            own: dict[Any, Bits] = {
                value: before << n * size for n, group in enumerate(groups) for value in group
            }
            self._ways.append(own)
        for own in self._ways:
            own[UNKNOWN] = self._all
        self._places = {subject: place for place, subject in enumerate(subjects)}
        about = [[self._places[x] for x in fact.about(everybody)] for fact in facts]
        self._facts = list(zip(about, map(self._truth, facts), strict=True))
        self._allowed = reduce(int.__and__, [kept for _, kept in self._facts], self._all)
        self._digits = [
            self._digits_of(read, [self._truth(own) for own in deciding])
            for read, deciding in zip(reads, conditions, strict=True)
        ]

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

    def _digits_of(self, read: Read | NumberRead, truths: Sequence[Bits]) -> Mapping[int, Bits]:
        """Each digit of a read, and the ways that have it, given those of its conditions."""
        if isinstance(read, Read):
            some = reduce(or_, truths, 0)
            ways = enumerate(
                (*truths, self._all ^ some) if read.values else (some ^ self._all, some)
            )
            return {digit: own for digit, own in ways if own}
        often = {0: self._all}
        for truth in truths:
            more: dict[int, Bits] = {}
            for number, own in often.items():
                for after, both in ((number, own & ~truth), (number + 1, own & truth)):
                    more[after] = more.get(after, 0) | both
            often = {number: own for number, own in more.items() if own}
        ways_of: dict[int, Bits] = {}
        for number, own in often.items():
            digit = digit_of_count(read, number)
            ways_of[digit] = ways_of.get(digit, 0) | own
        return ways_of

    def _truth(self, condition: tuple[ltl.Formula, Mapping[str, str]]) -> Bits:
        """The ways in which a formula holds for the objects of an environment."""
        formula, environment = condition

        def ways(proposition: ltl.Proposition) -> Bits:
            if not isinstance(proposition, ltl.Atom):
                raise LookupError
            items = tuple([environment[variable] for variable in proposition.arguments])
            place = self._places.get((proposition.name, items))
            # Of anything else the value decides nothing
            return 0 if place is None else self._ways[place][proposition.value or True]

        def are_same(pair: ltl.Same) -> Bits:
            return self._all * (environment[pair.left] == environment[pair.right])

        sets = replace(bit_sets({}, self._all), proposition=ways, identity=are_same)
        return fold(formula, sets)


def _repeated(ways: Bits, size: int, times: int) -> Bits:
    """The ways of ``size`` bits, for each of several values of one more subject."""
    return ways * (((1 << size * times) - 1) // ((1 << size) - 1))


def _conditions(
    read: Read | NumberRead, binding: Mapping[str, str], everybody: PartialView
) -> Iterator[tuple[ltl.Formula, Mapping[str, str]]]:
    """What decides a read: whether a word has each value, or whether each object counts."""
    if isinstance(read, Read):
        for value in read.values or (None,):
            yield ltl.Atom(read.name, read.variables, value), binding
        return
    match read.terms:
        case ((_, ltl.Count() as count),):
            for item in candidates(count, everybody):
                yield count.body, {**binding, count.variable: item}
        case _:
            raise LookupError


def _told_apart(
    names: Iterable[str], formulas: Iterable[ltl.Formula], everybody: PartialView
) -> Iterator[Sequence[Sequence[Value]]]:
    """The values of each word, in groups that no formula distinguishes."""
    propositions = chain.from_iterable(map(ltl.atoms_of, formulas))
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

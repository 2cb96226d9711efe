"""Joint values of words and truth values, as bits of their combinations.

Each way to give the subjects values has a bit, as in a truth table: the value of a subject, the
ways that an axiom allows, and the ways in which a read has a digit are sets of bits. So a few
conjunctions show what a partly known state allows, even if it was never met before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import reduce
from itertools import product
from math import prod
from operator import itemgetter, or_
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.free_names import reads_in
from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import Digits
from rulec.monitoring.uncertainty.state_letters.read_digits import ReadDigits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    Subject,
    subjects_in,
    subjects_of_read,
)
from rulec.trace import Value
from rulec.vocabulary import Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import values_of

MOST_KNOWN = 1 << 14
"""How many values keep their results before all are discarded."""

MOST_WAYS = 1 << 15
"""The most ways to give subjects values that fit into one set of bits (of 4 kB)."""

Bits: TypeAlias = int
"""A set of ways to give all subjects values."""

Alike: TypeAlias = tuple[tuple[Value, ...], ...]
"""The values of a word or truth value, in groups that are not distinguished."""


class JointValues:
    """All ways to give ``subjects`` values, and which of them the ``facts`` about them allow.

    Values in one group of ``alike`` are treated as one; names without groups have none. Raises
    LookupError if there are too many ways, if some subject is a number, or if an axiom is about
    more subjects than these.
    """

    def __init__(
        self,
        subjects: Sequence[Subject],
        facts: Iterable[FactInstance],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
        alike: Mapping[str, Alike] = MappingProxyType({}),
    ) -> None:
        self._objects, self._vocabulary = objects, vocabulary
        self._nobody = StateView({}, objects, vocabulary)
        declared = [vocabulary.declarations[name] for name, _ in subjects]
        if any(isinstance(declaration, Quantity) for declaration in declared):
            raise LookupError
        values = [
            alike.get(name) or tuple([(value,) for value in values_of(declaration)])
            for (name, _), declaration in zip(subjects, declared, strict=True)
        ]
        n_ways = prod(map(len, values))
        if n_ways > MOST_WAYS:
            raise LookupError
        self._all = (1 << n_ways) - 1
        self._ways: dict[Subject, dict[Value, Bits]] = {}
        """For each subject the ways that have a value, which represents its group."""
        self._of_places: list[dict[Any, Bits]] = []
        stride = 1
        for subject, groups in zip(subjects, values, strict=True):
            period = stride * len(groups)
            first = ((1 << stride) - 1) * (self._all // ((1 << period) - 1))
            ways = [first << n * stride for n in range(len(groups))]
            self._ways[subject] = {own[0]: bits for own, bits in zip(groups, ways, strict=True)}
            self._of_places.append({UNKNOWN: self._all})
            for own, bits in zip(groups, ways, strict=True):
                self._of_places[-1].update(dict.fromkeys(own, bits))
            stride = period
        self._allowed = self._all
        places = {subject: place for place, subject in enumerate(subjects)}
        self._facts: list[tuple[Sequence[int], Bits]] = []
        for fact in facts:
            about = [places[subject] for subject in fact.about(self._nobody)]
            kept = dict(self.truths(fact.formula, fact.environment)).get(1, 0)
            self._facts.append((about, kept))
            self._allowed &= kept

    def ways(self, values: Sequence[PartialValue | None]) -> Bits:
        """The ways that the axioms allow and that have these values of the subjects.

        Axioms about known values are assumed to hold. Raises LookupError if a value is missing.
        """
        ways = self._all
        for own, value in zip(self._of_places, values, strict=True):
            known = own.get(value)
            if known is None:
                if not isinstance(value, OneOf):
                    raise LookupError
                known = own[value] = reduce(or_, [own[single] for single in value.values])
            ways &= known
        allowed = ways & self._allowed
        if allowed:
            return allowed
        for places, kept in self._facts:
            if any(type(values[place]) in UNKNOWN_TYPES for place in places):
                ways &= kept
        return ways

    def digits(self, read: ReadDigits, binding: Mapping[str, str]) -> Sequence[tuple[int, Bits]]:
        """Each digit of a read for a binding's objects, and the ways that have it.

        Raises LookupError if it depends on more than the subjects.
        """

        def digit(view: StateView) -> int:
            return read.in_state(binding, view)

        ways_of: dict[int, Bits] = {}
        for bit, ways in self._by(subjects_of_read(read.read, binding, self._nobody), digit):
            if bit & (bit - 1):
                raise LookupError
            ways_of[bit] = ways_of.get(bit, 0) | ways
        return [(bit.bit_length() - 1, ways) for bit, ways in ways_of.items()]

    def truths(
        self, formula: ltl.Formula, environment: Mapping[str, str]
    ) -> Sequence[tuple[int, Bits]]:
        """The ways in which a formula does not hold, and in which it does, as for ``digits``."""
        ways_of = {False: 0, True: 0}
        about = subjects_in(formula, environment, self._nobody)
        for truth, ways in self._by(about, lambda view: holds(formula, environment, view)):
            if truth is not False and truth is not True:
                raise LookupError
            ways_of[truth] |= ways
        return [(int(truth), ways) for truth, ways in ways_of.items() if ways]

    def _by(
        self, about: Iterable[Subject], evaluate: Callable[[StateView], Any]
    ) -> Iterable[tuple[Any, Bits]]:
        """The results of ``evaluate`` for each choice of the subjects' values, with its ways."""
        own = [subject for subject in dict.fromkeys(about) if subject in self._ways]
        for chosen in product(*[self._ways[subject].items() for subject in own]):
            ways = self._all
            for _, bits in chosen:
                ways &= bits
            given = with_values({}, dict(zip(own, [value for value, _ in chosen], strict=True)))
            try:
                yield evaluate(StateView(given, self._objects, self._vocabulary)), ways
            except MissingValueError:
                raise LookupError from None


class ReadWays(NamedTuple):
    """Reads of some ``values``, each with the ways that have each of its digits."""

    values: JointValues
    digits: tuple[Sequence[tuple[int, Bits]], ...]

    def digits_of(self, values: Sequence[PartialValue | None]) -> frozenset[Digits]:
        """The possible joint digits of the reads for these values of the subjects.

        Raises LookupError if a value is missing or no digits are possible.
        """
        ways = self.values.ways(values)
        if not ways:
            raise LookupError
        partial_digits: list[tuple[Digits, Bits]] = [((), ways)]
        for own in self.digits:
            partial_digits = [
                ((*before, digit), both)
                for before, ways in partial_digits
                for digit, bits in own
                if (both := ways & bits)
            ]
        return frozenset([digits for digits, _ in partial_digits])


def read_ways(
    reads: Iterable[ReadDigits], binding: Mapping[str, str], values: JointValues
) -> ReadWays:
    """The reads for a binding's objects.

    Raises LookupError if they depend on more than the values.
    """
    return ReadWays(values, tuple([values.digits(read, binding) for read in reads]))


def alike_values(
    names: Iterable[str],
    reads: Sequence[Read | NumberRead],
    facts: Sequence[ltl.Formula],
    vocabulary: Vocabulary,
) -> dict[str, Alike]:
    """The values of words, in groups that neither reads nor axioms distinguish."""
    bodies = [
        term.body
        for read in reads
        if isinstance(read, NumberRead)
        for _, term in read.terms
        if isinstance(term, ltl.Count)
    ]
    atoms = {(atom.name, atom.value) for part in (*facts, *bodies) for atom in _atoms_in(part)}
    groups_of: dict[str, Alike] = {}
    for name in names:
        declaration = vocabulary.declarations[name]
        if isinstance(declaration, Enumeration):
            own = [read for read in reads if isinstance(read, Read) and read.name == name]
            groups: dict[object, list[Value]] = {}
            for value in declaration.values:
                apart = (name, value) in atoms and value
                groups.setdefault((apart, *[read.digit(value) for read in own]), []).append(value)
            groups_of[name] = tuple(map(tuple, groups.values()))
    return groups_of


def _atoms_in(formula: ltl.Formula) -> Iterator[ltl.Atom]:
    """The atoms of a formula, including those within counts."""
    for read in reads_in(formula):
        if isinstance(read, ltl.Atom):
            yield read
        elif isinstance(read, ltl.Count):
            yield from _atoms_in(read.body)


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

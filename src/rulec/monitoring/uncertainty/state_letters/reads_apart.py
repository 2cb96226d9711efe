"""Reads that may depend on each other, divided into independent parts.

Two reads are in the same part if they depend on a common value, or if axioms link the values of one
to those of the other. So a part's reads are determined by the values of its own subjects, which
have far fewer combinations than those of all subjects together. A count is divided further, into a
read for each object that may count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import prod
from typing import Any, NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic import formula as ltl
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import (
    Digits,
    added,
    digit_of_count,
    joint_digits,
)
from rulec.monitoring.uncertainty.state_letters.counted_crowd import count_in
from rulec.monitoring.uncertainty.state_letters.joint_values import (
    JointValues,
    values_at,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import Cube, Letters, read_digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance, instances_of
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    candidates,
    subjects_in,
    subjects_of_read,
)
from rulec.trace.remembered import Remembered
from rulec.valuations.connections import connected
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import values_of

MOST_SUPPOSED = 1 << 8
"""How many joint values of the world are supposed one after the other."""


class _Piece(NamedTuple):
    """What a read is ``about`` or, for a count, what decides whether an ``item`` counts."""

    read: int
    item: str | None
    about: frozenset[Subject]


class _Part(NamedTuple):
    """The places of the reads of some pieces, a getter of their values, and their table."""

    reads: tuple[int, ...]
    values: Callable[[Any], tuple[Any, ...]]
    table: _PartTable


class KnownParts:
    """The cached ``tables`` of the parts of all rules."""

    def __init__(self) -> None:
        self.tables: dict[object, _PartTable] = {}


class ReadsApart:
    """The reads of one rule that depend on these ``subjects``, in parts.

    They are evaluated for the objects of a ``binding``, with ``everybody`` present. Parts that
    differ only in the names of objects share their ``known`` results.

    ``counts_divided``: what decides whether an object counts is a part of its own, and the values
    of the world in such counts are supposed, one choice after the other; they must be words.
    """

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        binding: Mapping[str, str],
        axioms: Sequence[CompiledAxiom],
        everybody: PartialView,
        *,
        known: KnownParts,
        counts_divided: bool = False,
    ) -> None:
        self._reads, self._subjects, self._binding = reads, subjects, binding
        self._everybody, self._known_parts = everybody, known
        pieces = [piece for n in range(len(reads)) for piece in self._pieces(n, counts_divided)]
        self._counted = {n for n, read in enumerate(reads) if counts_divided and count_in(read)}
        declared = everybody.vocabulary.declarations
        world = {subject for piece in pieces if piece.item for subject in piece.about}
        self._given = {
            place: values_of(declared[subject[0]])
            for place, subject in enumerate(subjects)
            if subject in world and not subject[1]
        }
        self._parts = tuple(self._apart(pieces, list(instances_of(axioms, everybody))))
        self._letters = Remembered(self._joint_letters)

    def key(self, values: Sequence[PartialValue | None]) -> tuple[int, ...]:
        """The key of the letters for these values of the subjects.

        Raises MissingValueError, not necessarily about the first missing value.
        """
        return tuple([part.table.numbers[part.values(values)] for part in self._parts])

    def letters(self, key: tuple[int, ...], *, supposed: bool = False) -> tuple[Letters, bool]:
        """The joint letters of a key, and whether each of them is possible.

        Unless values are ``supposed``, a state whose reads are all known is taken to be possible.
        """
        return self._letters[key, supposed]

    def _joint_letters(self, about: tuple[tuple[int, ...], bool]) -> tuple[Letters, bool]:
        key, supposed = about
        parts = [part.table.possible[n] for part, n in zip(self._parts, key, strict=True)]
        sure = [[own.known] for own in parts if own.known is not None]
        if supposed or len(sure) < len(parts):
            return self._joint([own.joint for own in parts]), all(own.exact for own in parts)
        return self._joint(sure), True

    def letters_of(self, values: Sequence[PartialValue | None]) -> tuple[Letters, bool]:
        """The joint letters for these values of the subjects, and whether each is possible.

        Raises LookupError if none is, or if too many values of the world are unknown.
        """
        options = [_may_be(values[place], own) for place, own in self._given.items()]
        n_ways = prod(map(len, options))
        if n_ways == 1:
            return self.letters(self.key(values))
        if n_ways > MOST_SUPPOSED:
            raise LookupError
        supposed, joint, is_exact = list(values), set[Cube](), True
        for chosen in product(*options):
            for place, value in zip(self._given, chosen, strict=True):
                supposed[place] = value
            letters, own_exact = self.letters(self.key(supposed), supposed=True)
            joint.update(letters)
            is_exact = is_exact and own_exact
        if not joint:
            raise LookupError
        return tuple(sorted(joint)), is_exact

    def _joint(self, sets: Sequence[Iterable[Digits]]) -> Letters:
        """The joint letters of all reads, from the possible digits of the parts."""
        sums = {(0,) * len(self._reads)}
        for part, own in zip(self._parts, sets, strict=True):
            more = [tuple(zip(part.reads, digits, strict=True)) for digits in own]
            sums = {added(before, digits) for before in sums for digits in more}
        cubes = [tuple([1 << self._digit(n, x) for n, x in enumerate(numbers)]) for numbers in sums]
        # Each cube has one bit per read, so sorting gives the order of digits.
        return tuple(sorted(set(cubes)))

    def _digit(self, number: int, value: int) -> int:
        read = self._reads[number]
        return digit_of_count(read, value) if number in self._counted else value

    def _pieces(self, number: int, counts_divided: bool) -> Iterator[_Piece]:
        read, everybody = self._reads[number], self._everybody
        count = count_in(read) if counts_divided else None
        if count is None:
            about = subjects_of_read(read, self._binding, everybody)
            yield _Piece(number, None, frozenset(about))
            return
        for item in candidates(count, everybody):
            inner = {**self._binding, count.variable: item}
            yield _Piece(number, item, frozenset(subjects_in(count.body, inner, everybody)))

    def _apart(self, pieces: Sequence[_Piece], facts: Sequence[FactInstance]) -> Iterator[_Part]:
        subjects, given = self._subjects, {self._subjects[place] for place in self._given}
        of_facts = [(fact, fact.about(self._everybody)) for fact in facts]
        of_facts = [own for own in of_facts if not own[1].isdisjoint(subjects)]
        apart = connected([*[x.about - given for x in pieces], *[x - given for _, x in of_facts]])
        # What depends on nothing, or only on what is given, forms one more part.
        for own in [*[union for union, _ in apart if union], frozenset[Subject]()]:
            members = [x for x in pieces if x.about & own or (x.about <= given and not own)]
            bearing = [x for x in of_facts if x[1] & own or (x[1] <= given and not own)]
            if members or (bearing and given):
                there = own.union(*[x.about for x in members], *[x for _, x in bearing])
                places = [place for place, subject in enumerate(subjects) if subject in there]
                named = [subjects[place] for place in places]
                table = self._table(members, named, [fact for fact, _ in bearing])
                yield _Part(tuple([piece.read for piece in members]), values_at(places), table)

    def _table(
        self, pieces: Sequence[_Piece], subjects: Sequence[Subject], facts: Sequence[FactInstance]
    ) -> _PartTable:
        """The table of a part, with its objects numbered so that equal parts have one."""
        binding, everybody = self._binding, self._everybody
        items = [item for _, items in subjects for item in items]
        items += [item for fact in facts for item in fact.environment.values()]
        items += [piece.item for piece in pieces if piece.item is not None]
        if items or any(count_in(self._reads[piece.read]) for piece in pieces):
            items += binding.values()
        else:
            binding = {}
        names = {item: str(n) for n, item in enumerate(dict.fromkeys(items))}

        def bound(environment: Mapping[str, str]) -> dict[str, str]:
            return {variable: names[item] for variable, item in environment.items()}

        about = tuple([(name, tuple([names[item] for item in items])) for name, items in subjects])
        reads = [
            self._reads[read] if item is None else _one_counts(self._reads[read], names[item])
            for read, item, _ in pieces
        ]
        # Those who may count are variables, too, which have no such names.
        own = bound(binding) | {name: name for name in names.values()}
        instances = [FactInstance(formula, bound(chosen)) for formula, chosen in facts]
        objects = {name: everybody.objects[item] for item, name in names.items()}
        formulas = tuple([(formula, *chosen.items()) for formula, chosen in instances])
        key = tuple(reads), about, formulas, (*own.items(),), (*objects.items(),)
        tables = self._known_parts.tables
        if key not in tables:
            tables[key] = _PartTable(
                reads,
                about,
                own,
                instances,
                objects,
                vocabulary=everybody.vocabulary,
            )
        return tables[key]


def _one_counts(read: Read | NumberRead, item: str) -> NumberRead:
    """Whether an object counts, as a read."""
    count = count_in(read)
    assert count is not None, "the read is divided because it is a count"
    body = ltl.Binary(ltl.BinaryOperator.AND, ltl.Same(count.variable, item), count.body)
    only = ltl.Count(count.variable, count.type, body)
    return NumberRead(((Fraction(1), only),), (Threshold(Fraction(1), inclusive=True),))


def _may_be(value: PartialValue | None, values: Sequence[Any]) -> Sequence[PartialValue | None]:
    """The values that a word or truth value may have, given what is known of ``value``.

    They remain unknown values, so that axioms about them have to hold.
    """
    among = values if value is UNKNOWN else value.values if isinstance(value, OneOf) else None
    return [value] if among is None else [OneOf(frozenset({own})) for own in among]


class _PartDigits(NamedTuple):
    """The joint digits of a part's reads; ``exact`` if each of them is possible.

    ``known`` are their digits, if each read by itself has only one.
    """

    known: Digits | None
    joint: frozenset[Digits]
    exact: bool


class _PartTable:
    """The possible digits of some reads by the values of their ``subjects``, numbered."""

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        binding: Mapping[str, str],
        facts: Sequence[FactInstance],
        objects: Mapping[str, str],
        *,
        vocabulary: Vocabulary,
    ) -> None:
        self._reads, self._ready = reads, [read_digits(read) for read in reads]
        self._subjects, self._binding, self._facts = subjects, binding, facts
        self._objects, self._vocabulary = objects, vocabulary
        self.possible: list[_PartDigits] = []
        self._numbers: dict[_PartDigits, int] = {}
        self.numbers = Remembered(self._number)
        """The places among ``possible`` by values. Raises MissingValueError."""

    def _number(self, values: tuple[PartialValue | None, ...]) -> int:
        possible = self._possible(values)
        number = self._numbers.setdefault(possible, len(self.possible))
        if number == len(self.possible):
            self.possible.append(possible)
        return number

    @cached_property
    def _joint_values(self) -> JointValues | None:
        """The reads by the joint values of their subjects, if these are few words."""
        everybody = StateView({}, self._objects, self._vocabulary)
        with suppress(LookupError):
            return JointValues(self._reads, self._subjects, self._facts, self._binding, everybody)
        return None

    def _possible(self, values: Sequence[PartialValue | None]) -> _PartDigits:
        if self._joint_values is not None:
            # Missing values and contradictions of axioms are found below.
            with suppress(LookupError):
                return _PartDigits(*self._joint_values.digits(values), exact=True)
        state = self._state(values)
        digits = [read.in_state(self._binding, state) for read in self._ready]
        known = None
        if all(own & (own - 1) == 0 for own in digits):
            known = tuple([own.bit_length() - 1 for own in digits])
            # Only axioms can exclude what each read by itself is sure of.
            if not self._facts or UNKNOWN_TYPES.isdisjoint(map(type, values)):
                return _PartDigits(known, frozenset({known}), True)
        possible = joint_digits(self._reads, self._binding, state, self._facts)
        return _PartDigits(known, possible.digits, possible.exact)

    def _state(self, values: Sequence[PartialValue | None]) -> StateView:
        given = with_values({}, dict(zip(self._subjects, values, strict=True)))
        return StateView(given, self._objects, self._vocabulary)

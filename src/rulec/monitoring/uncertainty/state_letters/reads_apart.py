"""Entangled reads, divided into independent parts.

Two reads are in the same part if they depend on a common value, or if axioms link the values of one
to those of the other. So a part's reads are determined by the values of its own subjects, which
have far fewer combinations than those of all subjects together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.number_regions import NumberRegions, number_regions
from rulec.monitoring.uncertainty.state_letters.completions.completions import (
    Digits,
    joint_digits,
)
from rulec.monitoring.uncertainty.state_letters.counted_crowd import count_in
from rulec.monitoring.uncertainty.state_letters.joint_values import (
    MOST_KNOWN,
    JointValues,
    ReadWays,
    alike_values,
    instances_of,
    joined_sets,
    read_ways,
    values_at,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters, read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    subjects_of_read,
)
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval, PartialValue


class _PossibleDigits(NamedTuple):
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
        axioms: Sequence[CompiledAxiom],
        objects: Mapping[str, str],
        *,
        vocabulary: Vocabulary,
        together: dict[object, Any],
    ) -> None:
        self._reads, self._ready = reads, [read_digits(read) for read in reads]
        self._subjects, self._binding, self._axioms = subjects, binding, axioms
        self._objects, self._vocabulary, self._together = objects, vocabulary, together
        self._count = any(count_in(read) for read in reads)
        self.possible: list[_PossibleDigits] = []
        self._numbers: dict[_PossibleDigits, int] = {}
        self._known: dict[tuple[object, ...], int] = {}
        self._alike: dict[tuple[object, ...], int] = {}
        self._along: dict[tuple[object, ...], NumberRegions | None] = {}
        alone = number_regions(tuple(reads), tuple([axiom.formula for axiom in axioms]))
        self._regions = [
            (place, alone[name]) for place, (name, _) in enumerate(subjects) if name in alone
        ]

    def number(self, values: tuple[PartialValue | None, ...]) -> int:
        """The place among ``possible`` of the digits for these values. Raises MissingValueError."""
        known = self._known.get(values)
        if known is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
                self._alike.clear()
            known = self._known[values] = self._once_for_alike(values)
        return known

    def _once_for_alike(self, values: tuple[PartialValue | None, ...]) -> int:
        """The number, computed once for numbers in the same regions between limits."""
        alike: list[object] = list(values)
        for place, regions in self._regions:
            alike[place] = _region(values[place], regions)
        places = [place for place, value in enumerate(alike) if isinstance(value, Interval)]
        if len(places) == 1 and not self._axioms:
            (place,) = places
            others = (*values[:place], None, *values[place + 1 :])
            if others not in self._along:
                self._along[others] = self._regions_along(self._subjects[place], others)
            along = self._along[others]
            if along is not None:
                alike[place] = _region(values[place], along)
        key = tuple(alike)
        if key not in self._alike:
            possible = self._possible(values)
            self._alike[key] = self._numbers.setdefault(possible, len(self.possible))
            if self._alike[key] == len(self.possible):
                self.possible.append(possible)
        return self._alike[key]

    def _regions_along(
        self, along: Subject, others: Sequence[PartialValue | None]
    ) -> NumberRegions | None:
        """The regions in which reads distinguish a number, given the ``others``.

        None if more is unknown.
        """
        known = {x: value for x, value in zip(self._subjects, others, strict=True) if x != along}
        if None in known.values() or not UNKNOWN_TYPES.isdisjoint(map(type, known.values())):
            return None
        limits: set[Fraction] = set()
        for read in self._reads:
            if isinstance(read, Read):
                continue
            factor = rest = Fraction(0)
            for own, term in read.terms:
                if not isinstance(term, ltl.QuantityTerm):
                    return None
                subject = term.name, tuple([self._binding[item] for item in term.arguments])
                value = known.get(subject)
                if subject == along:
                    factor += own
                elif isinstance(value, int | float):
                    rest += own * exact(value)
                else:
                    return None
            if factor:
                limits.update((threshold.limit - rest) / factor for threshold in read.thresholds)
        return NumberRegions(tuple(sorted(limits)))

    @cached_property
    def _read_ways(self) -> ReadWays | None:
        """The reads by the joint values of their subjects, if these are few words."""
        vocabulary = self._vocabulary
        alike = alike_values(
            dict.fromkeys(name for name, _ in self._subjects),
            self._reads,
            [axiom.formula for axiom in self._axioms],
            vocabulary,
        )
        key = self._subjects, self._axioms, (*self._objects.items(),), (*alike.items(),)
        with suppress(LookupError):
            if key not in self._together:
                self._together[key] = None
                everybody = StateView({}, self._objects, vocabulary)
                of_all = [fact for axiom in self._axioms for fact in instances_of(axiom, everybody)]
                facts = [fact for fact in of_all if not fact.about.isdisjoint(self._subjects)]
                self._together[key] = JointValues(
                    self._subjects, facts, self._objects, vocabulary, alike
                )
            values = self._together[key]
            return None if values is None else read_ways(self._ready, self._binding, values)
        return None

    def _possible(self, values: Sequence[PartialValue | None]) -> _PossibleDigits:
        if self._read_ways is not None:
            # Missing values and contradictions of axioms are found below.
            with suppress(LookupError):
                joint = self._read_ways.digits_of(values)
                known = next(iter(joint)) if len(joint) == 1 and self._are_known(values) else None
                return _PossibleDigits(known, joint, True)
        state = self._state(values)
        digits = [read.in_state(self._binding, state) for read in self._ready]
        known = None
        if all(own & (own - 1) == 0 for own in digits):
            known = tuple([own.bit_length() - 1 for own in digits])
            if UNKNOWN_TYPES.isdisjoint(map(type, values)):
                return _PossibleDigits(known, frozenset({known}), True)
        possible = joint_digits(self._reads, self._binding, state, self._axioms)
        return _PossibleDigits(known, possible.digits, possible.exact)

    def _are_known(self, values: Sequence[PartialValue | None]) -> bool:
        """Whether each read by itself has only one digit, regardless of axioms."""
        unknown = [
            read
            for read, places in zip(self._ready, self._places, strict=True)
            if any(type(values[place]) in UNKNOWN_TYPES for place in places)
        ]
        if not unknown:
            return True
        state = self._state(values)
        digits = (read.in_state(self._binding, state) for read in unknown)
        return all(own & (own - 1) == 0 for own in digits)

    @cached_property
    def _places(self) -> Sequence[Sequence[int]]:
        """For each read the places of its subjects."""
        places = {subject: place for place, subject in enumerate(self._subjects)}
        everybody = StateView({}, self._objects, self._vocabulary)
        of_reads = [subjects_of_read(read, self._binding, everybody) for read in self._reads]
        return [[places[subject] for subject in set(own)] for own in of_reads]

    def _state(self, values: Sequence[PartialValue | None]) -> StateView:
        given = with_values({}, dict(zip(self._subjects, values, strict=True)))
        return StateView(given, self._objects, self._vocabulary)


def _region(value: PartialValue | None, regions: NumberRegions) -> object:
    """The region of a number, those of an interval's ends; anything else as it is."""
    if isinstance(value, Interval):
        return regions.region(exact(value.low)), regions.region(exact(value.high))
    return regions.region(exact(value)) if isinstance(value, int | float) else value


class _Part(NamedTuple):
    """The places of some reads among all, a getter of their subjects' values, and their table."""

    reads: tuple[int, ...]
    values: Callable[[Any], tuple[Any, ...]]
    table: _PartTable


PartNumber: TypeAlias = "tuple[Callable[[Any], tuple[Any, ...]], Callable[[tuple[Any, ...]], int]]"
"""A getter of a part's values among all, and a function that gives their number.

Raises MissingValueError.
"""


class KnownParts:
    """Cached results for parts of all rules.

    ``tables`` are those of parts of reads, ``together`` the joint values of subjects.
    """

    def __init__(self) -> None:
        self.tables: dict[object, _PartTable] = {}
        self.together: dict[object, Any] = {}


class ReadsApart:
    """The reads of one rule that depend on these ``subjects``, in parts.

    They are evaluated for the objects of a ``binding``, with ``everybody`` possibly present. Rules
    with a common part share its ``known`` results. ``numbers`` has for each part a getter of its
    subjects' values, and a function that gives their number in a ``key``.
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
    ) -> None:
        self._binding, self._everybody = binding, everybody
        self._n_reads = len(reads)
        self._parts = tuple(self._apart(reads, subjects, axioms, known))
        self.numbers = tuple([(part.values, part.table.number) for part in self._parts])
        self._letters: dict[tuple[int, ...], tuple[Letters, bool]] = {}

    def key(self, values: Sequence[PartialValue | None]) -> tuple[int, ...]:
        """The key of the letters for these values of the subjects.

        Raises MissingValueError, not necessarily about the first missing value.
        """
        return tuple([number(pick(values)) for pick, number in self.numbers])

    def letters(self, key: tuple[int, ...]) -> tuple[Letters, bool]:
        """The joint letters of a key, and whether each of them is possible."""
        known = self._letters.get(key)
        if known is None:
            known = self._letters[key] = self._together(key)
        return known

    def _together(self, key: Sequence[int]) -> tuple[Letters, bool]:
        parts = [part.table.possible[n] for part, n in zip(self._parts, key, strict=True)]
        sure = [own.known for own in parts]
        if None not in sure:
            return (self._cube([own for own in sure if own is not None]),), True
        letters = [self._cube(chosen) for chosen in product(*[own.joint for own in parts])]
        # Each cube has one bit per read, so sorting gives the order of digits.
        return tuple(sorted(letters)), all(own.exact for own in parts)

    def _cube(self, digits: Sequence[Digits]) -> tuple[int, ...]:
        cube = [0] * self._n_reads
        for part, own in zip(self._parts, digits, strict=True):
            for place, digit in zip(part.reads, own, strict=True):
                cube[place] = 1 << digit
        return tuple(cube)

    def _apart(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        axioms: Sequence[CompiledAxiom],
        known: KnownParts,
    ) -> Iterator[_Part]:
        everybody = self._everybody
        of_reads = [frozenset(subjects_of_read(read, self._binding, everybody)) for read in reads]
        of_facts = [
            (axiom, own) for axiom in axioms for _, _, own in instances_of(axiom, everybody)
        ]
        apart = joined_sets([*of_reads, *[own for _, own in of_facts]])
        # Reads that depend on nothing form one more part.
        for own in [*apart, frozenset[Subject]()]:
            members = tuple([n for n, about in enumerate(of_reads) if about & own or about == own])
            if not members:
                continue
            facts = tuple(dict.fromkeys([axiom for axiom, about in of_facts if about & own]))
            places = [place for place, subject in enumerate(subjects) if subject in own]
            table = self._table(
                tuple([reads[n] for n in members]),
                tuple([subjects[place] for place in places]),
                facts,
                known,
            )
            yield _Part(members, values_at(places), table)

    def _table(
        self,
        reads: tuple[Read | NumberRead, ...],
        subjects: tuple[Subject, ...],
        facts: tuple[CompiledAxiom, ...],
        known: KnownParts,
    ) -> _PartTable:
        binding, objects = self._binding, self._everybody.objects
        is_of_world = not any(items for _, items in subjects) and not any(map(count_in, reads))
        if is_of_world and not any(fact.variables for fact in facts):
            binding, objects = {}, {}
        key = reads, subjects, facts, (*binding.items(),), (*objects.items(),)
        tables, vocabulary = known.tables, self._everybody.vocabulary
        if key not in tables:
            tables[key] = _PartTable(
                reads,
                subjects,
                binding,
                facts,
                objects,
                vocabulary=vocabulary,
                together=known.together,
            )
        return tables[key]

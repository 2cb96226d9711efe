"""The possible joint digits of some reads, by the values of what they depend on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import (
    Digits,
    joint_digits,
)
from rulec.monitoring.uncertainty.state_letters.joint_values import MOST_KNOWN, JointValues
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.valuations.number_regions import NumberRegions, number_regions
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval, PartialValue


class PartDigits(NamedTuple):
    """The joint digits of a part's reads; ``exact`` if each of them is possible.

    ``known`` are their digits, if each read by itself has only one.
    """

    known: Digits | None
    joint: frozenset[Digits]
    exact: bool


class PartTable:
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
        self.possible: list[PartDigits] = []
        self._numbers: dict[PartDigits, int] = {}
        self._known: dict[tuple[object, ...], int] = {}
        self._alike: dict[tuple[object, ...], int] = {}
        self._along: dict[tuple[object, ...], NumberRegions | None] = {}
        alone = number_regions(tuple(reads), tuple([fact.formula for fact in facts]))
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
        if len(places) == 1 and not self._facts:
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
    def _joint_values(self) -> JointValues | None:
        """The reads by the joint values of their subjects, if these are few words."""
        everybody = StateView({}, self._objects, self._vocabulary)
        with suppress(LookupError):
            return JointValues(self._reads, self._subjects, self._facts, self._binding, everybody)
        return None

    def _possible(self, values: Sequence[PartialValue | None]) -> PartDigits:
        if self._joint_values is not None:
            # Missing values and contradictions of axioms are found below.
            with suppress(LookupError):
                return PartDigits(*self._joint_values.digits(values), exact=True)
        state = self._state(values)
        digits = [read.in_state(self._binding, state) for read in self._ready]
        known = None
        if all(own & (own - 1) == 0 for own in digits):
            known = tuple([own.bit_length() - 1 for own in digits])
            if UNKNOWN_TYPES.isdisjoint(map(type, values)):
                return PartDigits(known, frozenset({known}), True)
        possible = joint_digits(self._reads, self._binding, state, self._facts)
        return PartDigits(known, possible.digits, possible.exact)

    def _state(self, values: Sequence[PartialValue | None]) -> StateView:
        given = with_values({}, dict(zip(self._subjects, values, strict=True)))
        return StateView(given, self._objects, self._vocabulary)


def _region(value: PartialValue | None, regions: NumberRegions) -> object:
    """The region of a number, those of an interval's ends; anything else as it is."""
    if isinstance(value, Interval):
        return regions.region(exact(value.low)), regions.region(exact(value.high))
    return regions.region(exact(value)) if isinstance(value, int | float) else value

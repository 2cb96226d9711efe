"""The possible joint digits of some reads, by the values of what they depend on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from typing import NamedTuple

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions.completions import (
    Digits,
    joint_digits,
)
from rulec.monitoring.uncertainty.state_letters.joint_values import MOST_KNOWN, JointValues
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.related_facts import FactInstance
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, PartialValue


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

    def number(self, values: tuple[PartialValue | None, ...]) -> int:
        """The place among ``possible`` of the digits for these values. Raises MissingValueError."""
        known = self._known.get(values)
        if known is None:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            possible = self._possible(values)
            known = self._known[values] = self._numbers.setdefault(possible, len(self.possible))
            if known == len(self.possible):
                self.possible.append(possible)
        return known

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
            # Only axioms can exclude what each read by itself is sure of.
            if not self._facts or UNKNOWN_TYPES.isdisjoint(map(type, values)):
                return PartDigits(known, frozenset({known}), True)
        possible = joint_digits(self._reads, self._binding, state, self._facts)
        return PartDigits(known, possible.digits, possible.exact)

    def _state(self, values: Sequence[PartialValue | None]) -> StateView:
        given = with_values({}, dict(zip(self._subjects, values, strict=True)))
        return StateView(given, self._objects, self._vocabulary)

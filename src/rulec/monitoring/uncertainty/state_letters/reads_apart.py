"""Entangled reads in parts that have nothing to do with each other.

Two reads are in one part if they depend on one value, or if facts lead from one's values to the
other's. So what is said of a part's own subjects decides what its reads may be, and there are far
fewer ways to say that than for all subjects together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions import Digits, joint_digits
from rulec.monitoring.uncertainty.state_letters.counted_crowd import count_in
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters, ReadDigits, read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    subjects_in,
    subjects_of_read,
)
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, PartialValue
from rulec.vocabulary.vocabulary_model import choices

MOST_KNOWN = 1 << 14
"""Values of which it is kept what they come to before all are forgotten."""


class _PartFound(NamedTuple):
    """What a part's reads may be together, and whether no more is said than is.

    ``known`` are their digits if each has but one by itself.
    """

    known: Digits | None
    joint: frozenset[Digits]
    exact: bool


@dataclass(slots=True, eq=False)
class _Part:
    """Some of several reads, with what they depend on.

    ``reads`` and ``subjects`` are places among all of these.
    """

    reads: tuple[int, ...]
    subjects: tuple[int, ...]
    ready: tuple[ReadDigits, ...]
    axioms: tuple[CompiledAxiom, ...]
    objects: Mapping[str, str]
    found: list[_PartFound] = field(default_factory=list)
    _numbers: dict[_PartFound, int] = field(default_factory=dict)
    _known: dict[tuple[object, ...], int] = field(default_factory=dict)

    def number(self, values: Sequence[PartialValue | None], parts: ReadsApart) -> int:
        """The place of what is found for the values of all subjects. Raises MissingValueError."""
        own = tuple([values[place] for place in self.subjects])
        known = self._known.get(own)
        if known is None:
            found = self._found(own, parts)
            known = self._numbers.setdefault(found, len(self.found))
            if known == len(self.found):
                self.found.append(found)
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            self._known[own] = known
        return known

    def _found(self, values: Sequence[PartialValue | None], parts: ReadsApart) -> _PartFound:
        subjects = [parts.subjects[place] for place in self.subjects]
        given = with_values({}, dict(zip(subjects, values, strict=True)))
        state = StateView(given, self.objects, parts.everybody.vocabulary)
        digits = [read.in_state(parts.binding, state) for read in self.ready]
        known = None
        if all(own & (own - 1) == 0 for own in digits):
            known = tuple([own.bit_length() - 1 for own in digits])
            if UNKNOWN_TYPES.isdisjoint(map(type, values)):
                return _PartFound(known, frozenset({known}), True)
        reads = [read.read for read in self.ready]
        joint = joint_digits(reads, parts.binding, state, self.axioms)
        return _PartFound(known, joint.digits, joint.exact)


class ReadsApart:
    """Reads of one rule that depend on these ``subjects``, in parts.

    They are asked of the objects of a ``binding``, where only ``everybody`` may be there.
    """

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        binding: Mapping[str, str],
        axioms: Sequence[CompiledAxiom],
        everybody: PartialView,
    ) -> None:
        self.subjects, self.binding, self.everybody = tuple(subjects), binding, everybody
        self._n_reads = len(reads)
        self._parts = tuple(self._apart(reads, axioms))
        self._letters: dict[tuple[int, ...], tuple[Letters, bool]] = {}

    def letters(self, values: Sequence[PartialValue | None]) -> tuple[Letters, bool]:
        """What the reads may be together for these values, and whether no more is said than is.

        Raises MissingValueError, not always about the value that is missing first.
        """
        key = tuple([part.number(values, self) for part in self._parts])
        known = self._letters.get(key)
        if known is None:
            known = self._letters[key] = self._together(key)
        return known

    def _together(self, key: Sequence[int]) -> tuple[Letters, bool]:
        found = [part.found[n] for part, n in zip(self._parts, key, strict=True)]
        sure = [own.known for own in found]
        if None not in sure:
            return (self._cube([own for own in sure if own is not None]),), True
        letters = [self._cube(chosen) for chosen in product(*[own.joint for own in found])]
        # One bit each, so that they are in the order of their digits.
        return tuple(sorted(letters)), all(own.exact for own in found)

    def _cube(self, digits: Sequence[Digits]) -> tuple[int, ...]:
        cube = [0] * self._n_reads
        for part, own in zip(self._parts, digits, strict=True):
            for place, digit in zip(part.reads, own, strict=True):
                cube[place] = 1 << digit
        return tuple(cube)

    def _apart(
        self, reads: Sequence[Read | NumberRead], axioms: Sequence[CompiledAxiom]
    ) -> Iterator[_Part]:
        everybody = self.everybody
        of_reads = [frozenset(subjects_of_read(read, self.binding, everybody)) for read in reads]
        of_facts = [(axiom, own) for axiom in axioms for own in _instances(axiom, everybody)]
        for own in _joined([*of_reads, *[own for _, own in of_facts]]):
            members = tuple([n for n, about in enumerate(of_reads) if about & own])
            if not members:
                continue
            known = [n for n, subject in enumerate(self.subjects) if subject in own]
            facts = dict.fromkeys(axiom for axiom, about in of_facts if about & own)
            is_of_world = not any(items for _, items in own)
            is_of_world &= not any(axiom.variables for axiom in facts)
            counts = any(count_in(reads[n]) for n in members)
            objects = {} if is_of_world and not counts else everybody.objects
            ready = tuple([read_digits(reads[n]) for n in members])
            yield _Part(members, tuple(known), ready, tuple(facts), objects)
        alone = tuple([n for n, about in enumerate(of_reads) if not about])
        if alone:
            ready = tuple([read_digits(reads[n]) for n in alone])
            yield _Part(alone, (), ready, (), everybody.objects)


def _instances(axiom: CompiledAxiom, everybody: PartialView) -> Iterator[frozenset[Subject]]:
    """Of what a fact speaks, for each choice of its objects."""
    names = [variable.name for variable in axiom.variables]
    types = [variable.type for variable in axiom.variables]
    for chosen in choices(types, everybody.objects, everybody.vocabulary):
        environment = dict(zip(names, chosen, strict=True))
        yield frozenset(subjects_in(axiom.formula, environment, everybody))


def _joined(sets: Sequence[frozenset[Subject]]) -> list[frozenset[Subject]]:
    """The unions of those that have members in common."""
    found: list[frozenset[Subject]] = []
    for own in sets:
        if own:
            touched = [other for other in found if other & own]
            found = [other for other in found if not other & own]
            found.append(own.union(*touched))
    return found

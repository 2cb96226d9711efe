"""The classes of letters that a state may have, and these by the digits of some reads."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TypeAlias, TypeVar

from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.uncertainty.letter_diagram import LetterDiagram, bits_of

Cube: TypeAlias = tuple[int, ...]
"""For each read the bit set of its digits, each of which goes with each of the others'."""

Letters: TypeAlias = tuple[Cube, ...]
"""The letters that a state may have: those of all the cubes."""


MOST_KEPT = 1 << 16
"""Letters whose classes are kept before all are forgotten."""

_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class LetterClasses:
    """The classes of possible letters of a machine, as bit sets."""

    def __init__(self, machine: OutcomeMachine) -> None:
        self.diagram = LetterDiagram(machine)
        self._known: dict[Letters, int] = {}
        self._groups: dict[tuple[Letters, tuple[int, ...]], Mapping[Cube, int]] = {}

    def of(self, letters: Letters) -> int:
        """The classes of letters; 0 if facts exclude them all."""
        known = self._known.get(letters)
        if known is None:
            known = 0
            for cube in letters:
                known |= self.diagram.classes(cube)
            _keep(self._known, letters, known)
        return known

    def groups(self, letters: Letters, fixed: tuple[int, ...]) -> Mapping[Cube, int]:
        """The classes of letters by the digits, as bits, of ``fixed`` reads."""
        key = letters, fixed
        if key not in self._groups:
            groups: dict[Cube, int] = {}
            for cube in letters:
                for part in product(*[_single(cube[place]) for place in fixed]):
                    chosen = dict(zip(fixed, part, strict=True))
                    narrowed = [chosen.get(n, mask) for n, mask in enumerate(cube)]
                    groups[part] = groups.get(part, 0) | self.diagram.classes(narrowed)
            _keep(self._groups, key, {part: classes for part, classes in groups.items() if classes})
        return self._groups[key]


def _keep(known: dict[_Key, _Value], key: _Key, value: _Value) -> None:
    if len(known) >= MOST_KEPT:
        known.clear()
    known[key] = value


def _single(mask: int) -> list[int]:
    return [1 << bit for bit in bits_of(mask)]

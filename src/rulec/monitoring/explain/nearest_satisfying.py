"""Repairs: the nearest trace that satisfies a rule, found by dynamic programming.

Of two traces the nearer one differs in fewer things that the rule reads, each of them counted once
in every state; of equally near ones that one is nearer which is like the given one for longer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from math import prod

import numpy as np
from numpy.typing import NDArray

from rulec.automata.guards import Cube
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.verify import run
from rulec.witnesses.state_synthesis import are_consistent

Letter = tuple[int, ...]
"""The digit of each thing that a machine reads of a state, in its order."""

_Near = tuple[NDArray[np.int64], NDArray[np.int64]]
"""For each class of letters how far it is from a letter, and the number of its nearest one."""

_FAR = 1 << 40
"""Further than any trace, and still far from what 64 bits hold."""


@dataclass(frozen=True, slots=True)
class Repair:
    """Values that repair a state: the letters of any of the ``cubes``.

    ``place`` is the state's in the word. Of what need not be otherwise a cube has all digits.
    """

    place: int
    cubes: tuple[Cube, ...]


def nearest_satisfying(machine: MealyMonitor, word: Sequence[Letter]) -> tuple[Repair, ...] | None:
    """The fewest changes after which a non-empty word is accepted.

    None if no word of this length is. Letters that cannot be, by the facts of the vocabulary or by
    what their numbers say of each other, are not used.
    """
    alphabet = _LetterDistances(machine)
    given = [alphabet.number(letter) for letter in word]
    while True:
        letters = _nearest(machine, [alphabet.near(letter) for letter in word])
        if letters is None:
            return None
        changed = [place for place, letter in enumerate(letters) if letter != given[place]]
        wrong = [letters[place] for place in changed if not alphabet.can_be(letters[place])]
        if not wrong:
            break
        alphabet.exclude(wrong)
    symbols = [machine.letters[letter] for letter in letters]
    repairs, state = [], 0
    for place, symbol in enumerate(symbols):
        if letters[place] != given[place]:
            rest = symbols[place + 1 :] if place == changed[-1] else None
            does = _as_good(machine, state, symbol, rest)
            repairs.append(Repair(place, alphabet.ways(word[place], letters[place], does)))
        state = machine.successors[state][symbol]
    return tuple(repairs)


def _nearest(machine: MealyMonitor, near: Sequence[_Near]) -> list[int] | None:
    successors = np.array(machine.successors)
    # So far from being accepted is the rest of the word, by how much of it there is and the state.
    last = np.where(np.array(machine.outputs), near[-1][0], _FAR)
    costs = np.empty((len(near), len(successors)), dtype=np.int64)
    costs[-1] = last.min(axis=1)
    for place in range(len(near) - 2, -1, -1):
        (near[place][0] + costs[place + 1][successors]).min(axis=1, out=costs[place])
        np.minimum(costs[place], _FAR, out=costs[place])
    if costs[0][0] >= _FAR:
        return None
    letters, state = [], 0
    for place, (distances, nearest) in enumerate(near):
        beyond = costs[place + 1][successors[state]] if place + 1 < len(near) else None
        row = last[state] if beyond is None else distances + beyond
        best = np.flatnonzero(row == row.min())
        # Like the given word for as long as possible.
        symbol = best[np.argmin(distances[best])]
        letters.append(int(nearest[symbol]))
        state = machine.successors[state][symbol]
    return letters


def _as_good(
    machine: MealyMonitor, state: int, symbol: int, rest: Sequence[int] | None
) -> NDArray[np.bool_]:
    """The classes that do as well as one, read in a state.

    Those that lead to the same state; where nothing else is changed in the ``rest`` of the word,
    those after which it is accepted.
    """
    row = machine.successors[state]
    if rest is None:
        return np.array([target == row[symbol] for target in row])
    if not rest:
        return np.array(machine.outputs[state])
    return np.array([run(machine, rest, target)[0] for target in row])


class _LetterDistances:
    """Letters of a machine as columns of digits, and their distances."""

    def __init__(self, machine: MealyMonitor) -> None:
        self._reads = machine.reads
        sizes = [read.size for read in self._reads]
        self._strides = [prod(sizes[:n]) for n in range(len(sizes))]
        numbers = np.arange(len(machine.letters))
        self._digits = np.array(
            [numbers // stride % size for stride, size in zip(self._strides, sizes, strict=True)]
        ).reshape(len(sizes), len(numbers))
        self._numbers = [n for n, read in enumerate(machine.reads) if isinstance(read, NumberRead)]
        self._classes = np.array(machine.letters)
        self._n_classes = len(machine.successors[0])
        self._near: dict[Letter, _Near] = {}
        self._can_be: dict[Letter, bool] = {}
        self._ways: dict[tuple[Letter, int, bytes], tuple[Cube, ...]] = {}

    def number(self, letter: Letter) -> int:
        """The place of a letter among all."""
        return sum([stride * digit for stride, digit in zip(self._strides, letter, strict=True)])

    def near(self, letter: Letter) -> _Near:
        """The distances of the classes from a letter."""
        if letter not in self._near:
            n_letters = len(self._classes)
            ranks = self._differ(letter).sum(axis=0) * n_letters + np.arange(n_letters)
            possible = self._classes != IMPOSSIBLE
            best = np.full(self._n_classes, _FAR * n_letters)
            np.minimum.at(best, self._classes[possible], ranks[possible])
            self._near[letter] = best // n_letters, best % n_letters
        return self._near[letter]

    def _differ(self, letter: Letter) -> NDArray[np.bool_]:
        differ: NDArray[np.bool_] = self._digits != np.array(letter, dtype=np.int64)[:, np.newaxis]
        return differ

    def exclude(self, letters: Sequence[int]) -> None:
        """Exclude these letters, and all with the same digits of numbers."""
        numbers = self._digits[self._numbers]
        for letter in letters:
            self._classes[(numbers == numbers[:, [letter]]).all(axis=0)] = IMPOSSIBLE
        self._near.clear()

    def can_be(self, number: int) -> bool:
        """Tell whether some numbers have the digits of this letter."""
        digits = tuple(self._digits[self._numbers, number].tolist())
        if digits not in self._can_be:
            reads = [read for read in self._reads if isinstance(read, NumberRead)]
            self._can_be[digits] = are_consistent(list(zip(reads, digits, strict=True)))
        return self._can_be[digits]

    def ways(self, given: Letter, number: int, does: NDArray[np.bool_]) -> tuple[Cube, ...]:
        """Cubes of equally good letters, as near to a given one."""
        key = given, number, does.tobytes()
        if key not in self._ways:
            cubes = islice(self._all_ways(given, number, does), LIMITS.repairs_listed)
            self._ways[key] = tuple(cubes)
        return self._ways[key]

    def _all_ways(self, given: Letter, number: int, does: NDArray[np.bool_]) -> Iterator[Cube]:
        differ = self._differ(given)
        as_near = differ.sum(axis=0) == differ[:, number].sum()
        good = as_near & (self._classes != IMPOSSIBLE) & does[self._classes]
        by_reads: dict[tuple[int, ...], list[int]] = {}
        for letter in [number, *np.flatnonzero(good).tolist()]:
            reads = tuple(np.flatnonzero(differ[:, letter]).tolist())
            by_reads.setdefault(reads, []).append(letter)
        for reads, letters in sorted(by_reads.items()):
            yield from self._cubes(reads, letters)

    def _cubes(self, changed: tuple[int, ...], letters: Sequence[int]) -> Iterator[Cube]:
        """Cubes of letters with common changes, one cube if that is exact."""
        rows = {
            tuple(self._digits[changed, letter].tolist())
            for letter in letters
            if self.can_be(letter)
        }
        columns = [frozenset(digits) for digits in zip(*rows, strict=True)]
        if rows and prod(map(len, columns)) == len(rows):
            ways = [columns]
        else:
            ways = [[frozenset({digit}) for digit in row] for row in sorted(rows)]
        for digits in ways:
            cube = [frozenset(range(read.size)) for read in self._reads]
            for place, allowed in zip(changed, digits, strict=True):
                cube[place] = allowed
            yield tuple(cube)

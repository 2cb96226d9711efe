"""Repairs: the nearest trace that satisfies a rule, found by dynamic programming.

The distance of two traces is the number of reads, counted in every state, in which they differ; of
equally near traces the one that agrees with the given trace for longer is preferred.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from math import prod
from typing import NamedTuple

from rulec.automata.guards import Cube
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.uncertainty.known_words import run
from rulec.trace.remembered import Remembered
from rulec.witnesses.state_synthesis import are_consistent

Letter = tuple[int, ...]
"""The digit of each of a machine's reads in a state, in their order."""


class _Near(NamedTuple):
    """For each letter class its distance from a letter, and the number of its nearest letter."""

    distances: Sequence[int]
    nearest: Sequence[int]


_FAR = 1 << 40
"""Farther than any trace."""


@dataclass(frozen=True, slots=True)
class Repair:
    """Values that repair a state: the letters of any of the ``cubes``.

    ``place`` is the position of the state in the word. A cube has all digits of a read that need
    not change.
    """

    place: int
    cubes: tuple[Cube, ...]


def nearest_satisfying(machine: MealyMonitor, word: Sequence[Letter]) -> tuple[Repair, ...] | None:
    """The fewest changes after which a non-empty word is accepted.

    None if no word of this length is accepted. Letters that are impossible, by the axioms of the
    vocabulary or because their numbers contradict each other, are not used.
    """
    alphabet = _LetterDistances(machine)
    given = [alphabet.number(letter) for letter in word]
    while True:
        letters = _nearest(machine, [alphabet.near[letter] for letter in word])
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
            repairs.append(Repair(place, alphabet.ways[word[place], letters[place], does]))
        state = machine.successors[state][symbol]
    return tuple(repairs)


def _nearest(machine: MealyMonitor, near: Sequence[_Near]) -> list[int] | None:
    beyond = _costs(machine, near)
    if beyond[0][0] >= _FAR:
        return None
    letters, state = [], 0
    for place, (distances, nearest) in enumerate(near):
        row = _totals(machine, state, distances, beyond[place + 1])
        least = min(row)
        best = [symbol for symbol, total in enumerate(row) if total == least]
        # Equal to the given word for as long as possible.
        symbol = min(best, key=distances.__getitem__)
        letters.append(nearest[symbol])
        state = machine.successors[state][symbol]
    return letters


def _totals(
    machine: MealyMonitor, state: int, distances: Sequence[int], beyond: Sequence[int]
) -> list[int]:
    """For each class of the first letter, the distance of a word from being accepted.

    ``beyond`` is that distance by state after that letter; it is empty where the word ends.
    """
    if beyond:
        targets = machine.successors[state]
        return [
            distance + beyond[target] for distance, target in zip(distances, targets, strict=True)
        ]
    kept = machine.outputs[state]
    return [
        distance if is_kept else _FAR for distance, is_kept in zip(distances, kept, strict=True)
    ]


def _costs(machine: MealyMonitor, near: Sequence[_Near]) -> list[Sequence[int]]:
    """The fewest changes after which the rest of the word is accepted, by its place and the state.

    The classes of a state mostly lead to few other states; for each of these the nearest class
    counts.
    """
    states = range(len(machine.successors))
    last = [min(_totals(machine, state, near[-1].distances, ())) for state in states]
    costs: list[Sequence[int]] = [(), last]
    ways: dict[int, list[list[tuple[int, int]]]] = {}
    for place in range(len(near) - 2, -1, -1):
        key = id(near[place])
        if key not in ways:
            ways[key] = [_ways(row, near[place].distances) for row in machine.successors]
        if near[place] is near[place + 1] and len(costs) > 2 and costs[-1] == costs[-2]:
            costs.append(costs[-1])
            continue
        beyond = costs[-1]
        costs.append(
            [
                min(_FAR, *[distance + beyond[target] for target, distance in row])
                for row in ways[key]
            ]
        )
    return costs[::-1]


def _ways(targets: Sequence[int], distances: Sequence[int]) -> list[tuple[int, int]]:
    """The successors of a state, with the distance of the nearest class that leads to each."""
    least: dict[int, int] = {}
    for target, distance in zip(targets, distances, strict=True):
        if distance < least.get(target, _FAR + 1):
            least[target] = distance
    return list(least.items())


def _as_good(
    machine: MealyMonitor, state: int, symbol: int, rest: Sequence[int] | None
) -> tuple[bool, ...]:
    """Which classes are as good as a given one, read in a state.

    These are the classes that lead to the same state or, if nothing else is changed in the ``rest``
    of the word, those after which it is accepted.
    """
    row = machine.successors[state]
    if rest is None:
        return tuple([target == row[symbol] for target in row])
    if not rest:
        return tuple(machine.outputs[state])
    accepted = {target: run(machine, rest, target)[0] for target in set(row)}
    return tuple([accepted[target] for target in row])


class _LetterDistances:
    """The letters of a machine by number, and the distances between them."""

    def __init__(self, machine: MealyMonitor) -> None:
        self._reads = machine.reads
        self._sizes = [read.size for read in self._reads]
        self._strides = [prod(self._sizes[:n]) for n in range(len(self._sizes))]
        self._numbers = [n for n, read in enumerate(machine.reads) if isinstance(read, NumberRead)]
        self._classes = list(machine.letters)
        self._n_classes = len(machine.successors[0])
        self.near = Remembered(self._distances, None)
        """The distances of the classes from a letter."""
        self._differ = Remembered(self._differs)
        """In how many reads each letter differs from a given one."""
        self._can_be = Remembered(self._are_consistent)
        self.ways = Remembered(self._some_ways)
        """Cubes of letters as near to a given one, by the number of one, and the good classes."""

    def number(self, letter: Letter) -> int:
        """The number of a letter among all."""
        return sum([stride * digit for stride, digit in zip(self._strides, letter, strict=True)])

    def _digits(self, number: int, reads: Sequence[int]) -> tuple[int, ...]:
        """The digits of some reads in a letter."""
        return tuple([number // self._strides[n] % self._sizes[n] for n in reads])

    def _distances(self, letter: Letter) -> _Near:
        best, nearest = [_FAR] * self._n_classes, [0] * self._n_classes
        differs = enumerate(self._differ[letter])
        for symbol, (number, distance) in zip(self._classes, differs, strict=True):
            if symbol != IMPOSSIBLE and distance < best[symbol]:
                best[symbol], nearest[symbol] = distance, number
        return _Near(best, nearest)

    def _differs(self, letter: Letter) -> Sequence[int]:
        counts = b"\0"
        for size, given in zip(self._sizes, letter, strict=True):
            other = bytes([n + 1 for n in counts])
            counts = b"".join([counts if digit == given else other for digit in range(size)])
        return counts

    def exclude(self, letters: Sequence[int]) -> None:
        """Exclude these letters, and all letters with the same digits of numbers."""
        wrong = {self._digits(letter, self._numbers) for letter in letters}
        for number in range(len(self._classes)):
            if self._digits(number, self._numbers) in wrong:
                self._classes[number] = IMPOSSIBLE
        self.near.clear()

    def can_be(self, number: int) -> bool:
        """Whether some numbers have the digits of this letter."""
        return self._can_be[self._digits(number, self._numbers)]

    def _are_consistent(self, digits: Letter) -> bool:
        reads = [read for read in self._reads if isinstance(read, NumberRead)]
        return are_consistent(list(zip(reads, digits, strict=True)))

    def _some_ways(self, about: tuple[Letter, int, tuple[bool, ...]]) -> tuple[Cube, ...]:
        return tuple(islice(self._all_ways(*about), LIMITS.repairs_listed))

    def _all_ways(self, given: Letter, number: int, does: tuple[bool, ...]) -> Iterator[Cube]:
        differs = self._differ[given]
        good = [
            letter
            for letter, symbol in enumerate(self._classes)
            if differs[letter] == differs[number] and symbol != IMPOSSIBLE and does[symbol]
        ]
        by_reads: dict[tuple[int, ...], list[int]] = {}
        for letter in [number, *good]:
            digits = self._digits(letter, range(len(given)))
            reads = tuple([n for n, digit in enumerate(digits) if digit != given[n]])
            by_reads.setdefault(reads, []).append(letter)
        for reads, letters in sorted(by_reads.items()):
            yield from self._cubes(reads, letters)

    def _cubes(self, changed: tuple[int, ...], letters: Sequence[int]) -> Iterator[Cube]:
        """Cubes of letters with common changes; a single cube if that is exact."""
        rows = {self._digits(letter, changed) for letter in letters if self.can_be(letter)}
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

"""Guards of a monitor's edges: sets of letters, covered by few cubes.

A machine has many letters; those that lead from one state to another are covered by few cubes. A
cube allows some digits of each read and contains all letters with allowed digits. This is
two-level minimisation of multiple-valued logic, as in Rudell, Sangiovanni-Vincentelli,
"Multiple-valued minimization for PLA optimization" (1987), done greedily.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import or_

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.diagnostics import SourceLocation
from rulec.resource_limits import CUBES

Cube = tuple[frozenset[int], ...]
"""The allowed digits of each of a machine's reads."""


@dataclass(frozen=True, slots=True)
class GuardedEdge:
    """A guarded edge of a monitor, with one verdict on traces that end with it.

    Its letters are the union of ``cubes``, apart from letters that no state can have. At most one
    edge leaving a state is ``otherwise``: the one best described as "none of the others".
    """

    source: int
    target: int
    accepted: bool
    cubes: tuple[Cube, ...]
    otherwise: bool = False


def edges(
    machine: MealyMonitor, whose: str = "", place: SourceLocation | None = None
) -> tuple[GuardedEdge, ...]:
    """The guarded edges of a monitor by source state, except from sinks.

    Raises RulecError R0718, naming ``whose`` monitor it is and its place, for an edge with more
    cubes than the limit `cubes`; a parity, for example, needs as many as half of all letters.
    """
    cover = _Covers(machine, whose, place)
    guarded_edges: list[GuardedEdge] = []
    for source, row in enumerate(machine.successors):
        if source in (machine.rejecting_sink, machine.accepting_sink):
            continue
        onsets: dict[tuple[int, bool], int] = {}
        for symbol, target in enumerate(row):
            key = (target, machine.outputs[source][symbol])
            onsets[key] = onsets.get(key, 0) | cover.of_class[symbol]
        leaving = [
            GuardedEdge(source, target, accepted, cover.cubes(onset))
            for (target, accepted), onset in sorted(onsets.items())
        ]
        guarded_edges += _with_otherwise(leaving, cover.sizes)
    return tuple(guarded_edges)


def literals(cubes: Sequence[Cube], sizes: Sequence[int]) -> int:
    """The total number of reads that the cubes restrict."""
    return sum(
        len(allowed) < size for cube in cubes for allowed, size in zip(cube, sizes, strict=True)
    )


def _with_otherwise(leaving: Sequence[GuardedEdge], sizes: Sequence[int]) -> Iterator[GuardedEdge]:
    lengths = [literals(edge.cubes, sizes) for edge in leaving]
    longest = lengths.index(max(lengths))
    for number, edge in enumerate(leaving):
        last_resort = number == longest and len(leaving) > 1 and lengths[number] > 1
        yield replace(edge, otherwise=last_resort)


class _Covers:
    """Bit sets of a monitor's letters, and small covers of them.

    ``of_class`` has the letters of each class; letters in ``_free`` may be covered or not.
    """

    def __init__(self, machine: MealyMonitor, whose: str, place: SourceLocation | None) -> None:
        self._whose, self._place, self._most = whose, place, CUBES.value()
        self.sizes = [read.size for read in machine.reads]
        total = len(machine.letters)
        self._everything = (1 << total) - 1
        self._digits: list[list[int]] = []
        stride = 1
        for size in self.sizes:
            ones = ((1 << stride) - 1) * (self._everything // ((1 << (stride * size)) - 1))
            self._digits.append([ones << (digit * stride) for digit in range(size)])
            stride *= size
        rows = [bytearray(total // 8 + 1) for _ in [*machine.successors[0], IMPOSSIBLE]]
        for letter, symbol in enumerate(machine.letters):
            rows[symbol][letter // 8] |= 1 << letter % 8  # IMPOSSIBLE is -1: the last row
        *self.of_class, self._free = [int.from_bytes(row, "little") for row in rows]
        self._known: dict[int, tuple[Cube, ...]] = {}
        places = list(range(len(self.sizes)))
        turns = [places[n:] + places[:n] for n in places] or [places]
        self._orders = [*turns, *(turn[::-1] for turn in turns)]

    def cubes(self, onset: int) -> tuple[Cube, ...]:
        """Irredundant cubes that cover ``onset``, and no other letters than impossible ones."""
        if onset not in self._known:
            chosen: dict[Cube, int] = {}
            remaining = onset
            if self._lonely(onset).bit_count() > self._most:
                raise CUBES.exceeded(self._place, self._whose)
            while remaining:
                if len(chosen) == self._most:
                    raise CUBES.exceeded(self._place, self._whose)
                letter = (remaining & -remaining).bit_length() - 1
                primes = {self._prime(letter, onset | self._free, order) for order in self._orders}
                best = max(primes, key=lambda cube: self._worth(cube, remaining))
                chosen[best] = self._letters(best)
                remaining &= ~chosen[best]
            self._known[onset] = _needed(chosen, onset)
        return self._known[onset]

    def _lonely(self, onset: int) -> int:
        """The letters of ``onset`` that no allowed letter differs from in one read only.

        Each needs a cube of its own; in a parity all letters do.
        """
        stride, cover, lonely = 1, onset | self._free, onset
        for size, members in zip(self.sizes, self._digits, strict=True):
            once = twice = 0
            for digit, own in enumerate(members):
                here = (cover & own) >> (digit * stride)
                once, twice = once | here, twice | (once & here)
            for digit in range(size):
                lonely &= ~(twice << (digit * stride))
            stride *= size
        return lonely

    def _worth(self, cube: Cube, remaining: int) -> tuple[int, int, list[list[int]]]:
        covered = (self._letters(cube) & remaining).bit_count()
        return covered, -literals([cube], self.sizes), [sorted(allowed) for allowed in cube]

    def _letters(self, cube: Cube) -> int:
        letters = self._everything
        for place in range(len(cube)):
            letters &= self._allowed(cube, place)
        return letters

    def _allowed(self, cube: Sequence[frozenset[int]], place: int) -> int:
        if len(cube[place]) == self.sizes[place]:
            return self._everything
        return reduce(or_, (self._digits[place][digit] for digit in cube[place]))

    def _prime(self, letter: int, onset: int, order: Sequence[int]) -> Cube:
        """The largest cube around a letter within ``onset``, widened read by read in ``order``."""
        cube: list[frozenset[int]] = []
        for size in self.sizes:
            letter, digit = divmod(letter, size)
            cube.append(frozenset([digit]))
        for place in order:
            others = self._everything
            for other in range(len(cube)):
                if other != place:
                    others &= self._allowed(cube, other)
            cube[place] = frozenset(
                digit
                for digit, letters in enumerate(self._digits[place])
                if not others & letters & ~onset
            )
        return tuple(cube)


def _needed(chosen: dict[Cube, int], onset: int) -> tuple[Cube, ...]:
    """Drop cubes that the other cubes cover, last chosen first."""
    kept = dict(chosen)
    for cube, letters in reversed(chosen.items()):
        others = reduce(or_, (kept[other] for other in kept if other != cube), 0)
        if not letters & onset & ~others:
            del kept[cube]
    return tuple(kept)

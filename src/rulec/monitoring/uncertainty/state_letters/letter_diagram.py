"""A rule's letters as a decision diagram, which finds the classes of partly known letters.

It has a level for each read, whose digits choose among the nodes of the next level; equal parts
share a node (R. E. Bryant, "Graph-based algorithms for Boolean function manipulation", 1986). An
unknown read has several digits and leads to a set of nodes. Sets, and steps between them, are built
on demand.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence, Set
from itertools import chain, count
from math import prod

from rulec.automata.outcome_machine import OutcomeMachine, bits_of
from rulec.trace.remembered import Remembered

MOST_STEPS = 1 << 18
"""How many steps of one letter are kept before all are discarded."""


_BLOCK = 1 << 5
"""Parts of up to about so many letters are compared as a whole."""


class LetterDiagram:
    """A machine's letter classes by its reads' digits; the last read is the first level."""

    def __init__(self, machine: OutcomeMachine) -> None:
        self._n_reads = len(machine.reads)
        self._children: list[list[tuple[int, ...]]] = []
        sizes = [read.size for read in machine.reads]
        few = next((n for n in range(len(sizes)) if prod(sizes[:n]) >= _BLOCK), len(sizes))
        # Large tables repeat themselves, so equal parts are processed once.
        letters, width = machine.letters, prod(sizes[:few])
        blocks = [letters[start : start + width] for start in range(0, len(letters), width)]
        distinct, places = _distinct(blocks)
        below = list(chain.from_iterable(distinct))
        for size in sizes[:few]:
            below = self._add_level(below, size)
        below = [below[place] for place in places]
        for size in sizes[few:]:
            below = self._add_level(below, size)
        if self._children:
            # One more than the class; 0 stands for letters that axioms exclude.
            self._children[0] = [tuple([letter + 1 for letter in row]) for row in self._children[0]]
        self.start = 1 << (below[0] if self._children else below[0] + 1)
        self._steps = Remembered(self._step, MOST_STEPS)

    def _add_level(self, below: Sequence[int], size: int) -> list[int]:
        rows, above = _distinct_rows(below, size)
        self._children.append(rows)
        return above

    def classes(self, cube: Sequence[int]) -> int:
        """The classes, as bits, of letters that have for each read any of its digits, as bits."""
        return self.nodes(cube) >> 1

    def nodes(self, cube: Sequence[int]) -> int:
        """The same classes, shifted by one; the first bit stands for excluded letters."""
        here = self.start
        for read in range(self._n_reads - 1, -1, -1):
            here = self.step(read, here, cube[read])
        return here

    def nodes_side_by_side(
        self, first: Sequence[int], second: Sequence[int], fixed: Set[int]
    ) -> set[tuple[int, int]]:
        """The ``nodes`` of two cubes for each choice of digits of the ``fixed`` reads in both."""
        step = self.step
        reached = {(self.start, self.start)}
        for read in range(self._n_reads - 1, -1, -1):
            own, their = first[read], second[read]
            if read in fixed:
                digits = [1 << digit for digit in bits_of(own & their)]
                reached = {
                    (step(read, x, digit), step(read, y, digit))
                    for x, y in reached
                    for digit in digits
                }
            else:
                reached = {(step(read, x, own), step(read, y, their)) for x, y in reached}
        return reached

    def n_letters(self) -> Mapping[int, int]:
        """How many letters each class has, by its number."""
        here = {self.start.bit_length() - 1: 1}
        for children in reversed(self._children):
            below: defaultdict[int, int] = defaultdict(int)
            for node, n_own in here.items():
                for child in children[node]:
                    below[child] += n_own
            here = below
        return {node - 1: n_own for node, n_own in here.items()}

    def step(self, read: int, here: int, digits: int) -> int:
        """The nodes after some nodes and some digits of a read, all as bits."""
        return self._steps[read, here, digits]

    def _step(self, key: tuple[int, int, int]) -> int:
        read, here, digits = key
        children, after = self._children[read], 0
        for node in bits_of(here):
            for digit in bits_of(digits):
                after |= 1 << children[node][digit]
        return after


def _distinct_rows(numbers: Sequence[int], width: int) -> tuple[list[tuple[int, ...]], list[int]]:
    """The distinct rows of this width, and the place of each row among them."""
    return _distinct(zip(*[iter(numbers)] * width, strict=True))


def _distinct(rows: Iterable[tuple[int, ...]]) -> tuple[list[tuple[int, ...]], list[int]]:
    """The distinct rows, and the place of each row among them."""
    # A new row gets the next number, without executing Python code per row.
    places: defaultdict[tuple[int, ...], int] = defaultdict(count().__next__)
    place_of_row = list(map(places.__getitem__, rows))
    return list(places), place_of_row

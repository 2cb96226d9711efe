"""Letters of a rule as a decision diagram, by which those not known are classed.

A level for each read, whose digits choose among the nodes of the next one; equal parts are one node
(R. E. Bryant, "Graph-based algorithms for Boolean function manipulation", 1986). A read that is not
known has several digits and leads to a set of nodes. Sets, and steps between them, are made as they
are met.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.outcome_machine import OutcomeMachine, bits_of

MOST_STEPS = 1 << 18
"""Steps of one letter that are kept before all are forgotten."""

Numbers = NDArray[np.intp] | int


class LetterDiagram:
    """A machine's letter classes by its reads' digits, the last read being the first level."""

    def __init__(self, machine: OutcomeMachine) -> None:
        self._n_reads = len(machine.reads)
        # One more than the class: 0 is for what facts exclude.
        below: NDArray[Any] = np.array(machine.letters) + 1
        self._children: list[list[list[int]]] = []
        for read in machine.reads:
            rows, below = _distinct_rows(below.reshape(-1, read.size))
            self._children.append(rows.tolist())
        self.start = 1 << int(below[0])
        self._steps: dict[tuple[int, int, int], int] = {}

    def classes(self, cube: Sequence[int]) -> int:
        """The classes, as bits, of letters that have for each read any of its digits, as bits."""
        return self.nodes(cube) >> 1

    def nodes(self, cube: Sequence[int]) -> int:
        """The same classes, one place higher: the first bit stands for what facts exclude."""
        here = self.start
        for read in range(self._n_reads - 1, -1, -1):
            here = self.step(read, here, cube[read])
        return here

    def step(self, read: int, here: int, digits: int) -> int:
        """The nodes behind some nodes and some digits of a read, all as bits."""
        key = read, here, digits
        known = self._steps.get(key)
        if known is None:
            if len(self._steps) >= MOST_STEPS:
                self._steps.clear()
            children = self._children[read]
            known = 0
            for node in bits_of(here):
                for digit in bits_of(digits):
                    known |= 1 << children[node][digit]
            self._steps[key] = known
        return known


def _distinct_rows(rows: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """The rows that there are, in ascending order, and the place of each among them.

    Their numbers are natural ones. Rows are mostly few and narrow, and each is one number then.
    """
    base, width = int(rows.max()) + 1, rows.shape[1]
    if base**width > MOST_STEPS:
        found, places = np.unique(rows, axis=0, return_inverse=True)
        return found, places.ravel()
    weights = np.array([base**n for n in range(width)][::-1])
    numbers = rows @ weights
    is_there = np.zeros(base**width, dtype=bool)
    is_there[numbers] = True
    found = np.flatnonzero(is_there)
    place_of = np.cumsum(is_there) - 1
    return found[:, None] // weights % base, place_of[numbers]


class LetterSets:
    """The sets of classes of many letters at once, by numbers for what reads may be.

    ``meanings`` has for each read the digits, as bits, that its numbers stand for. ``sets`` are the
    sets of classes, as bits, that have been met: a letter's number is a place among them.
    """

    def __init__(self, diagram: LetterDiagram, meanings: Sequence[Sequence[int]]) -> None:
        self._diagram = diagram
        self._meanings = meanings
        # Places of sets of nodes behind each read, and before all.
        self._places: list[dict[int, int]] = [{} for _ in range(len(meanings))]
        self._places.append({diagram.start: 0})
        self._sets: list[int] = []
        self._several = [np.array([mask & (mask - 1) != 0 for mask in row]) for row in meanings]
        self._tables = [np.full((0, len(row)), -1, dtype=np.intp) for row in meanings]

    @property
    def sets(self) -> list[int]:
        """Sets of classes, as bits, by number."""
        own, places = self._sets, self._places[0]
        if len(own) < len(places):
            own += [nodes >> 1 for nodes in islice(places, len(own), None)]
        return own

    def number_of(self, classes: int) -> int:
        """The number of a set of classes, given as bits."""
        places = self._places[0]
        return places.setdefault(classes << 1, len(places))

    def are_partial(self, columns: Sequence[Numbers], reads: Sequence[int]) -> NDArray[np.bool_]:
        """Whether some of these reads may have several digits."""
        found: NDArray[np.bool_] = np.zeros(1, dtype=bool)
        for read in reads:
            found = found | self._several[read].take(columns[read])
        return found

    def numbers(self, columns: Sequence[Numbers]) -> Numbers:
        """The number of each letter, for columns of the reads' numbers, or one for all."""
        here: Numbers = 0
        for read in range(len(columns) - 1, -1, -1):
            here = self._behind(read, here, columns[read])
        return here

    def _behind(self, read: int, here: Numbers, column: Numbers) -> Numbers:
        width, n_before = len(self._meanings[read]), len(self._places[read + 1])
        table = self._tables[read]
        if len(table) < n_before:
            more = np.full((2 * n_before - len(table), width), -1, dtype=np.intp)
            table = self._tables[read] = np.concatenate([table, more])
        entry = here * width + column
        result: Numbers = table.take(entry)
        unmet = np.asarray(result) < 0
        if not unmet.any():
            return result
        # The entries may be very many, and the table is small.
        is_missing = np.zeros(table.size, dtype=bool)
        is_missing[np.asarray(entry)[unmet]] = True
        missing = np.flatnonzero(is_missing)
        before, places = list(self._places[read + 1]), self._places[read]
        for number in missing.tolist():
            nodes = self._diagram.step(
                read, before[number // width], self._meanings[read][number % width]
            )
            table.ravel()[number] = places.setdefault(nodes, len(places))
        return table.take(entry)

"""The sets of letter classes of many letters at once, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram

Numbers = NDArray[np.intp] | int

Columns = Sequence[Numbers] | Mapping[int, Numbers]
"""The numbers of each read."""


class LetterSets:
    """The sets of classes of many letters at once, by numbers for what reads may be.

    ``meanings`` has for each read the digits, as bits, that its numbers stand for. ``sets`` are the
    sets of classes, as bits, met so far; a letter's number is a place among them.
    """

    def __init__(self, diagram: LetterDiagram, meanings: Sequence[Sequence[int]]) -> None:
        self._diagram = diagram
        self._meanings = meanings
        self._widths = [len(row) for row in meanings]
        # The numbers of node sets before the first read, which are letters, and after each read:
        # from 1 on, since 0 stands for those that have not been met.
        self._places: list[dict[int, int]] = [{} for _ in meanings]
        self._places.append({diagram.start: 1 if meanings else 0})
        self._sets: list[int] = []
        self._several = [np.array([mask & (mask - 1) != 0 for mask in row]) for row in meanings]
        # What is behind a read: a number of a node set times the width of the next read's table,
        # or the number after that of a letter.
        self._tables = [np.zeros((2, len(row)), dtype=np.intp) for row in meanings]

    @property
    def sets(self) -> list[int]:
        """The sets of classes, as bits, by number."""
        own, places = self._sets, self._places[0]
        if len(own) < len(places):
            own += [nodes >> 1 for nodes in islice(places, len(own), None)]
        return own

    @property
    def numbers_of_none(self) -> list[int]:
        """The numbers of the empty set of classes, which impossible letters have."""
        places = self._places[0]
        return [places[nodes] for nodes in (0, 1) if nodes in places]

    def number_of(self, classes: int) -> int:
        """The number of a set of classes, given as bits."""
        places = self._places[0]
        return places.setdefault(classes << 1, len(places))

    def are_partial(self, columns: Columns, reads: Sequence[int]) -> NDArray[np.bool_]:
        """Whether some of these reads may have several digits."""
        partial: NDArray[np.bool_] = np.zeros(1, dtype=bool)
        for read in reads:
            partial = partial | self._several[read].take(columns[read])
        return partial

    def letters_of(self, columns: Columns) -> Numbers:
        """The number of each letter set, for columns of the reads' numbers.

        One for all if they are equal.
        """
        if not self._meanings:
            return 0
        here: Numbers = self._widths[-1]
        for read in range(len(self._meanings) - 1, -1, -1):
            entry, table = here + columns[read], self._tables[read]
            here = table.item(entry) if isinstance(entry, int) else table.take(entry)
        if isinstance(here, np.ndarray):
            return here - 1 if np.count_nonzero(here) == here.size else self._met_first(columns)
        # A single number for all letters may also be an array without axes
        return int(here) - 1 if here else self._met_first(columns)

    def _met_first(self, columns: Columns) -> Numbers:
        """The numbers of letters of which some have not been met."""
        here: Numbers = self._widths[-1]
        for read in range(len(self._meanings) - 1, -1, -1):
            entry = here + columns[read]
            # There may be very many entries, while the table is small.
            is_there = np.zeros(self._tables[read].size, dtype=bool)
            is_there[entry] = True
            before = list(self._places[read + 1])
            width = self._widths[read]
            for number in (is_there & (self._tables[read].ravel() == 0)).nonzero()[0].tolist():
                self._fill(read, number, before[number // width - 1])
            here = self._tables[read].take(entry)
        return here - 1 if isinstance(here, np.ndarray) else int(here) - 1

    def _fill(self, read: int, number: int, before: int) -> None:
        """Find what is behind a read, for a place in its table and the nodes before."""
        places, meanings = self._places[read], self._meanings[read]
        nodes = self._diagram.step(read, before, meanings[number % len(meanings)])
        place = places.setdefault(nodes, len(places) + (read > 0))
        if not read:
            self._tables[0].ravel()[number] = place + 1
            return
        table = self._tables[read - 1]
        self._tables[read].ravel()[number] = place * table.shape[1]
        if place >= len(table):
            self._tables[read - 1] = np.concatenate([table, np.zeros_like(table)])

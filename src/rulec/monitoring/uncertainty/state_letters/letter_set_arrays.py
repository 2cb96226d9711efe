"""The sets of letter classes of many letters at once, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram

Numbers = NDArray[np.intp] | int


class LetterSets:
    """The sets of classes of many letters at once, by numbers for what reads may be.

    ``meanings`` has for each read the digits, as bits, that its numbers stand for. ``sets`` are the
    sets of classes, as bits, met so far; a letter's number is a place among them.
    """

    def __init__(self, diagram: LetterDiagram, meanings: Sequence[Sequence[int]]) -> None:
        self._diagram = diagram
        self._meanings = meanings
        self._widths = [len(row) for row in meanings]
        # The numbers of node sets before the first read and after each read.
        self._places: list[dict[int, int]] = [{} for _ in range(len(meanings))]
        self._places.append({diagram.start: 0})
        self._sets: list[int] = []
        self._several = [np.array([mask & (mask - 1) != 0 for mask in row]) for row in meanings]
        self._tables = [np.full((0, len(row)), -1, dtype=np.intp) for row in meanings]

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

    def are_partial(
        self, columns: Sequence[Numbers] | Mapping[int, Numbers], reads: Sequence[int]
    ) -> NDArray[np.bool_]:
        """Whether some of these reads may have several digits."""
        partial: NDArray[np.bool_] = np.zeros(1, dtype=bool)
        for read in reads:
            partial = partial | self._several[read].take(columns[read])
        return partial

    def numbers(self, columns: Sequence[Numbers]) -> Numbers:
        """The number of each letter, for columns of the reads' numbers.

        One for all if they are equal.
        """
        here: Numbers = 0
        for read in range(len(columns) - 1, -1, -1):
            column = columns[read]
            # A single number for all letters may also be an array without axes
            if not isinstance(column, int) and not column.ndim:
                column = column.item()
            here = self._behind(read, here, column)
        return here

    def _behind(self, read: int, here: Numbers, column: Numbers) -> Numbers:
        """The node sets behind a read, by number, times the width of the next read's table."""
        width, n_before = self._widths[read], len(self._places[read + 1])
        table = self._tables[read]
        if len(table) < n_before:
            more = np.full((2 * n_before - len(table), width), -1, dtype=np.intp)
            table = self._tables[read] = np.concatenate([table, more])
        entry = here + column
        if isinstance(entry, int) and (known := table.item(entry)) >= 0:
            return known
        result = np.asarray(table.take(entry))
        if result.min(initial=0) >= 0:
            return result
        unmet = result < 0
        # There may be very many entries, while the table is small.
        is_missing = np.zeros(table.size, dtype=bool)
        is_missing[np.asarray(entry)[unmet]] = True
        missing = is_missing.nonzero()[0]
        before, places = list(self._places[read + 1]), self._places[read]
        for number in missing.tolist():
            nodes = self._diagram.step(
                read, before[number // width], self._meanings[read][number % width]
            )
            next_width = self._widths[read - 1] if read else 1
            table.ravel()[number] = next_width * places.setdefault(nodes, len(places))
        return table.item(entry) if isinstance(entry, int) else table.take(entry)

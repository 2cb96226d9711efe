"""The sets of letter classes of many letters at once, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram
from rulec.trace.plain_arrays import distinct

Numbers = NDArray[np.intp] | int

MOST_CODES = 1 << 16
"""Reads whose numbers have at most so many combinations are looked up together."""

_FEW_CODES = 1 << 15
"""With fewer letters than combinations, only so many combinations are looked up together."""

_MOST_KEPT = 1 << 18
"""How many combinations are kept before all are discarded."""

_UNMET = -1

_FEW_UNMET = 1 << 4
"""Up to so many new letters are computed together."""


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
        # Numbers of letters for all combinations, by the numbers of the reads that have only one
        self._together: dict[tuple[int | None, ...], NDArray[np.intp]] = {}
        self._kept = 0

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
        numbers = list(columns)
        given: list[Any] = list(numbers)
        varying: list[tuple[int, NDArray[np.intp]]] = []
        width, n_letters = 1, 1
        for read, own in enumerate(numbers):
            if isinstance(own, int):
                continue
            if own.ndim:
                width *= self._widths[read]
                n_letters = len(own)
                varying.append((read, own))
                given[read] = None
            else:
                # A single number for all letters may also be an array without axes
                numbers[read] = given[read] = own.item()
        if width > MOST_CODES or width > max(_FEW_CODES, n_letters):
            return self._one_by_one(numbers)
        codes: Numbers = 0
        for read, column in varying:
            if isinstance(codes, int):
                codes = column.astype(np.uint16)
            else:
                codes *= self._widths[read]
                np.add(codes, column, out=codes, casting="unsafe")
        key: tuple[int | None, ...] = tuple(given)
        table = self._together.get(key)
        if table is None:
            self._kept += width
            if self._kept > _MOST_KEPT:
                self._together.clear()
                self._kept = width
            table = self._together[key] = np.full(width, _UNMET, dtype=np.intp)
        if isinstance(codes, int):
            if table.item(codes) == _UNMET:
                table[codes] = self._of_code(codes, key)
            return table.item(codes)
        found: NDArray[np.intp] = table.take(codes)
        if found.min(initial=0) == _UNMET:
            unmet = distinct(codes[found == _UNMET])
            if len(unmet) < _FEW_UNMET:
                for code in unmet.tolist():
                    table[code] = self._of_code(code, key)
            else:
                table[unmet] = self._of_code(unmet.astype(np.intp), key)
            found = table.take(codes)
        return found

    def _of_code(self, code: Numbers, key: Sequence[int | None]) -> Numbers:
        """The number of each letter whose reads have these numbers, some given by a code."""
        columns: list[Numbers] = []
        for read in range(len(key) - 1, -1, -1):
            own = key[read]
            if own is None:
                width = len(self._meanings[read])
                code, rest = code // width, code % width
                columns.append(rest)
            else:
                columns.append(own)
        return self._one_by_one(columns[::-1])

    def _one_by_one(self, columns: Sequence[Numbers]) -> Numbers:
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
        if isinstance(entry, int) and (known := table.item(entry)) >= 0:
            return known
        result: Numbers = table.take(entry)
        unmet = np.asarray(result) < 0
        if not unmet.any():
            return result
        # There may be very many entries, while the table is small.
        is_missing = np.zeros(table.size, dtype=bool)
        is_missing[np.asarray(entry)[unmet]] = True
        missing = is_missing.nonzero()[0]
        before, places = list(self._places[read + 1]), self._places[read]
        for number in missing.tolist():
            nodes = self._diagram.step(
                read, before[number // width], self._meanings[read][number % width]
            )
            table.ravel()[number] = places.setdefault(nodes, len(places))
        return table.item(entry) if isinstance(entry, int) else table.take(entry)

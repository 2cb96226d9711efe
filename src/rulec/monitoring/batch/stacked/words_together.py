"""Words of sets of letters that are run together, a letter of each at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rulec.automata.outcome_machine import KEPT, SetMonitor
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import LetterSets
from rulec.trace.plain_arrays import distinct

_MOST_CELLS = 1 << 20
"""Of a larger table none is made: words are run one by one then."""

_TIMES_AS_MANY = 4
"""So many times as many words as the longest has letters are worth it."""

_OUT = 0
"""The row of words with a letter that cannot be: they stay there, and are not kept."""


def are_many(n_words: int, longest: int) -> bool:
    """Whether words are run sooner together than one by one."""
    return n_words >= _TIMES_AS_MANY * longest


class WordsTogether:
    """Where a machine gets by sets of letters, in a table that is filled as they are met.

    A cell is twice the row of the states that it leads to, and one more if all of them keep the
    rule; below 0 where nothing has been asked yet. A row's number is one more than its states'.
    """

    def __init__(self, monitor: SetMonitor, letters: LetterSets) -> None:
        self._monitor, self._letters = monitor, letters
        self._table = np.zeros((1, 0), dtype=np.intp)

    def are_kept(
        self, letters: NDArray[np.intp], bounds: NDArray[np.intp]
    ) -> NDArray[np.bool_] | None:
        """For each word whether all that it may be is kept; None if there are too many sets.

        Words of the numbers of sets begin and end at ``bounds``, with a letter or more each.
        """
        lengths, n_sets = np.diff(bounds), len(self._letters.sets)
        # The longest first, so that those that go on come before all others
        order = (-lengths).argsort(kind="stable")
        at, lengths = bounds[:-1][order], lengths[order]
        going_on = (-lengths).searchsorted(-np.arange(int(lengths[0])), side="left").tolist()
        found = np.full(len(order), 2 * (self._monitor.start + 1))
        for count in going_on:
            rows = found[:count] >> 1
            if not self._has_room(int(rows.max()), n_sets):
                return None
            cells = rows * self._table.shape[1] + letters.take(at[:count])
            next_ones = self._table.take(cells)
            if next_ones.min() < 0:
                self._fill(distinct(cells[next_ones < 0]))
                next_ones = self._table.take(cells)
            found[:count] = next_ones
            at += 1
        kept = np.empty(len(order), dtype=bool)
        kept[order] = found & 1
        return kept

    def _has_room(self, row: int, n_sets: int) -> bool:
        """Whether the table has this row and a column for each set, after growing if need be."""
        n_rows, n_columns = self._table.shape
        if row < n_rows and n_sets <= n_columns:
            return True
        shape = max(2 * row + 1, n_rows), max(2 * n_sets, n_columns)
        if shape[0] * shape[1] > _MOST_CELLS:
            return False
        table = np.full(shape, -1, dtype=np.intp)
        table[:n_rows, :n_columns] = self._table
        table[_OUT] = 2 * _OUT
        self._table = table
        return True

    def _fill(self, cells: NDArray[np.intp]) -> None:
        sets = self._letters.sets
        for cell in cells.tolist():
            row, number = divmod(cell, self._table.shape[1])
            classes = sets[number]
            if classes:
                step = self._monitor.step(row - 1, classes)
                self._table[row, number] = 2 * (step.states + 1) + (step.worst == KEPT)
            else:
                self._table[row, number] = 2 * _OUT

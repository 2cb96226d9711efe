"""Some cells of arrays with a row per participant and a column per state, laid flat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.trace.end_to_end import EndToEnd


@dataclass(frozen=True, eq=False, slots=True)
class Cells:
    """Some cells of arrays of one ``shape``; ``places`` are theirs in the arrays laid flat."""

    shape: tuple[int, ...]
    rows: NDArray[intp]
    columns: NDArray[intp]
    places: NDArray[intp]

    @staticmethod
    def at(flags: NDArray[bool_]) -> Cells:
        """Those that are flagged."""
        places = flags.ravel().nonzero()[0]
        n_rows, n_columns = flags.shape
        # Rows stand together, which is sooner known than what a division leaves
        bounds = places.searchsorted(np.arange(n_rows + 1) * n_columns)
        rows = np.arange(n_rows).repeat(bounds[1:] - bounds[:-1])
        return Cells(flags.shape, rows, places - rows * n_columns, places)

    @staticmethod
    def in_shape(shape: tuple[int, ...], rows: NDArray[intp], columns: NDArray[intp]) -> Cells:
        """Those in these rows and columns."""
        return Cells(shape, rows, columns, rows * shape[1] + columns)

    @staticmethod
    def of_runs(
        shape: tuple[int, ...], rows: NDArray[intp], first: NDArray[intp], last: NDArray[intp]
    ) -> Cells:
        """Those of runs in rows, from a first to a last column each, one run after the other."""
        lengths = last - first + 1
        ends = lengths.cumsum()
        columns = np.arange(lengths.sum()) + (first - ends + lengths).repeat(lengths)
        return Cells.in_shape(shape, rows.repeat(lengths), columns)

    @staticmethod
    def of_drives(flags: NDArray[bool_], spans: EndToEnd) -> tuple[Cells, EndToEnd]:
        """Those of whole drives in which a row has a flag, end to end, with where each is."""
        rows, drives = np.logical_or.reduceat(flags, spans.begins, axis=1).nonzero()
        first, lengths = spans.begins[drives], spans.lengths[drives]
        own = EndToEnd((0, *lengths.cumsum().tolist()))
        return Cells.of_runs(flags.shape, rows, first, first + lengths - 1), own

    def __len__(self) -> int:
        return len(self.places)

    def part(self, chosen: NDArray[intp]) -> Cells:
        """Some of them."""
        rows, columns = self.rows.take(chosen), self.columns.take(chosen)
        return Cells(self.shape, rows, columns, self.places.take(chosen))

    def in_rows(self, rows: NDArray[intp], n_rows: int) -> Cells:
        """The same cells in arrays of more rows, of which these have only some."""
        return Cells.in_shape((n_rows, self.shape[1]), rows.take(self.rows), self.columns)

    def number(self, row: int, column: int) -> int | None:
        """Which of them, in ascending order, is in a row and a column; None if none is."""
        place = row * self.shape[1] + column
        at = int(self.places.searchsorted(place))
        return at if at < len(self) and self.places[at] == place else None

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """The cells of an array, or of one with a value for each column only."""
        by_row = values.ndim > 1 and len(values) == self.shape[0]
        return values.take(self.places if by_row else self.columns)

    def least(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The least of the cells' values in each column, infinity where there is none."""
        least = np.full(self.shape[1], np.inf)
        np.minimum.at(least, self.columns, values)
        return least

    def laid(self, values: NDArray[Any], elsewhere: float = 0) -> NDArray[Any]:
        """The array with these values in the cells, and something else in all others."""
        array = np.zeros(self.shape, dtype=values.dtype)
        if elsewhere:
            array.fill(elsewhere)
        array.ravel()[self.places] = values
        return array

"""Selected cells of arrays with a row per participant and a column per state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.trace.end_to_end import EndToEnd


@dataclass(frozen=True, eq=False, slots=True)
class Cells:
    """Some cells of arrays of a ``shape``; ``places`` are their indices in the flattened array."""

    shape: tuple[int, ...]
    rows: NDArray[intp]
    columns: NDArray[intp]
    places: NDArray[intp]

    @staticmethod
    def at(flags: NDArray[bool_]) -> Cells:
        """The cells where a mask is True."""
        places = flags.ravel().nonzero()[0]
        n_rows, n_columns = flags.shape
        # Cells of a row are adjacent, so counting them is faster than division with remainder
        bounds = places.searchsorted(np.arange(n_rows + 1) * n_columns)
        rows = np.arange(n_rows).repeat(bounds[1:] - bounds[:-1])
        return Cells(flags.shape, rows, places - rows * n_columns, places)

    @staticmethod
    def in_shape(shape: tuple[int, ...], rows: NDArray[intp], columns: NDArray[intp]) -> Cells:
        """The cells at these pairs of row and column."""
        return Cells(shape, rows, columns, rows * shape[1] + columns)

    @staticmethod
    def of_runs(
        shape: tuple[int, ...], rows: NDArray[intp], first: NDArray[intp], last: NDArray[intp]
    ) -> Cells:
        """The cells of runs within rows, each from a first to a last column, one after another."""
        lengths = last - first + 1
        ends = lengths.cumsum()
        columns = np.arange(lengths.sum()) + (first - ends + lengths).repeat(lengths)
        return Cells.in_shape(shape, rows.repeat(lengths), columns)

    @staticmethod
    def of_drives(flags: NDArray[bool_], spans: EndToEnd) -> tuple[Cells, EndToEnd]:
        """All cells of each row and drive in which the row has a flag; those drives end to end."""
        rows, drives = np.logical_or.reduceat(flags, spans.begins, axis=1).nonzero()
        first, lengths = spans.begins[drives], spans.lengths[drives]
        own = EndToEnd((0, *lengths.cumsum().tolist()))
        return Cells.of_runs(flags.shape, rows, first, first + lengths - 1), own

    def __len__(self) -> int:
        return len(self.places)

    def part(self, chosen: NDArray[intp]) -> Cells:
        """The cells at these indices."""
        rows, columns = self.rows.take(chosen), self.columns.take(chosen)
        return Cells(self.shape, rows, columns, self.places.take(chosen))

    def in_rows(self, rows: NDArray[intp], n_rows: int) -> Cells:
        """The same cells in taller arrays; ``rows`` are the new numbers of the present rows."""
        return Cells.in_shape((n_rows, self.shape[1]), rows.take(self.rows), self.columns)

    def number(self, row: int, column: int) -> int | None:
        """The index of the cell at a row and column, None if it is not there; cells must ascend."""
        place = row * self.shape[1] + column
        at = int(self.places.searchsorted(place))
        return at if at < len(self) and self.places[at] == place else None

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """The cells' values in an array of that shape, or in one with a value per column only."""
        by_row = values.ndim > 1 and len(values) == self.shape[0]
        return values.take(self.places if by_row else self.columns)

    def in_columns(self, flags: NDArray[bool_]) -> NDArray[bool_]:
        """Mask of the columns in which some cell has a flag."""
        found = np.zeros(self.shape[1], dtype=bool)
        found[self.columns[flags]] = True
        return found

    def least(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The least of the cells' ``values`` in each column; infinity in columns without cells."""
        least = np.full(self.shape[1], np.inf)
        np.minimum.at(least, self.columns, values)
        return least

    def laid(self, values: NDArray[Any], elsewhere: float = 0) -> NDArray[Any]:
        """An array with these values in the cells and ``elsewhere`` in all others."""
        array = np.zeros(self.shape, dtype=values.dtype)
        if elsewhere:
            array.fill(elsewhere)
        np.put(array, self.places, values)
        return array

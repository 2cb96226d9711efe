"""Several ranges of columns of arrays laid out one behind the other, as drives are looked at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import bool_, float64, intp
from numpy.typing import NDArray

_SHORT = 48
"""Columns of ranges that are shorter are picked one by one, others, and one, range by range."""

_LONG = 200
"""Of ranges that are longer those who are absent are found for each by itself."""


@dataclass(frozen=True, eq=False)
class LaidOut:
    """Some rows of arrays in several ranges of columns, one behind the other.

    ``absent`` are flags of who is so from a whole range, by row and column of what is laid out.
    """

    rows: NDArray[intp]
    ranges: Sequence[slice]
    absent: NDArray[bool_]

    def __call__(self, values: NDArray[Any]) -> NDArray[Any]:
        """An array's part.

        Flags are false, sets empty and measures NaN for who is absent; a third axis stays the first
        in memory.
        """
        by_lane = values.transpose(2, 0, 1) if values.ndim > 2 else values[None]
        own = by_lane.take(self.rows, axis=1)
        part = one_behind_the_other(own, self.ranges, self.columns)
        none = values.dtype.type(np.nan if values.dtype.kind == "f" else 0)
        if self._are_long:
            for columns, gone in self._absent_in:
                part[:, gone, columns] = none
        elif self._are_absent:
            np.copyto(part, none, where=self.absent)
        own_part: NDArray[Any] = part.transpose(1, 2, 0) if values.ndim > 2 else part[0]
        return own_part

    def of_rows(self, rows: NDArray[intp]) -> LaidOut:
        """Some of the rows."""
        return LaidOut(self.rows[rows], self.ranges, self.absent[rows])

    def at_third(self, places: NDArray[intp], *arrays: NDArray[float64]) -> list[NDArray[float64]]:
        """Parts of arrays with one place of the third axis, by column; NaN as above."""
        n_rows, n_columns, _ = arrays[0].shape
        at = (places * n_rows + self.rows[:, None]) * n_columns + self.columns
        parts = [values.transpose(2, 0, 1).take(at) for values in arrays]
        for own in parts if self._are_absent else ():
            np.copyto(own, np.nan, where=self.absent)
        return parts

    @cached_property
    def columns(self) -> NDArray[intp]:
        """The columns of all ranges."""
        return columns_of(self.ranges)

    @cached_property
    def _are_absent(self) -> bool:
        return bool(self.absent.any())

    @property
    def _are_long(self) -> bool:
        return bool(self.absent.shape[1] > _LONG * len(self.ranges))

    @cached_property
    def _absent_in(self) -> list[tuple[slice, NDArray[intp]]]:
        """The columns of each range in what is laid out, and who is absent from it."""
        bounds = np.cumsum([0, *(own.stop - own.start for own in self.ranges)]).tolist()
        return [
            (slice(begin, end), self.absent[:, begin].nonzero()[0])
            for begin, end in pairwise(bounds)
        ]


def columns_of(ranges: Sequence[slice]) -> NDArray[intp]:
    """The columns of all ranges."""
    return np.concatenate([np.arange(own.start, own.stop) for own in ranges])


def one_behind_the_other(
    values: NDArray[Any], ranges: Sequence[slice], columns: NDArray[intp]
) -> NDArray[Any]:
    """An array's part in ranges of its last axis, whose ``columns`` are these."""
    if len(ranges) > 1 and len(columns) < _SHORT * len(ranges):
        return values.take(columns, axis=-1)
    return np.concatenate([values[..., own] for own in ranges], axis=-1)

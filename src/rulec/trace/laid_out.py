"""Several column ranges of arrays, placed side by side."""

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
"""Ranges of fewer columns (on average) are gathered column by column; longer ones are sliced."""

_LONG = 200
"""Ranges of more columns (on average) have absent rows blanked range by range, not by a mask."""


@dataclass(frozen=True, eq=False)
class LaidOut:
    """Some rows of arrays in several column ranges, placed side by side.

    ``absent``, by row and column of the result, marks participants absent from a whole range.
    """

    rows: NDArray[intp]
    ranges: Sequence[slice]
    absent: NDArray[bool_]

    def __call__(self, values: NDArray[Any]) -> NDArray[Any]:
        """An array's part in these rows and ranges.

        Where a participant is absent, flags are False, sets empty and measures NaN. A third axis
        stays first in memory.
        """
        by_lane = values.transpose(2, 0, 1) if values.ndim > 2 else values[None]
        if len(self.ranges) == 1:
            part = by_lane[..., self.ranges[0]].take(self.rows, axis=1)
        else:
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
        """The same ranges of some of the rows."""
        return LaidOut(self.rows[rows], self.ranges, self.absent[rows])

    def at_third(self, places: NDArray[intp], *arrays: NDArray[float64]) -> list[NDArray[float64]]:
        """Parts of 3-D arrays at one index of the third axis by column; NaN where absent."""
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
        """Each range's columns in the result, and the rows that are absent from it."""
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
    """An array's part in ``ranges`` of its last axis; ``columns`` are all their columns."""
    if len(ranges) > 1 and len(columns) < _SHORT * len(ranges):
        return values.take(columns, axis=-1)
    return np.concatenate([values[..., own] for own in ranges], axis=-1)

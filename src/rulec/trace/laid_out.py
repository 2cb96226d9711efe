"""Several column ranges of arrays, placed side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class LaidOut:
    """Some rows and columns of arrays: several column ranges, placed side by side.

    ``absent``, by row and column of the result, marks participants absent from a whole range.
    """

    rows: NDArray[intp]
    columns: NDArray[intp]
    absent: NDArray[bool_]

    def __call__(self, values: NDArray[Any]) -> NDArray[Any]:
        """An array's part in these rows and ranges.

        Where a participant is absent, flags are False, sets empty and measures NaN.
        """
        part = values.take(self.rows, axis=0).take(self.columns, axis=1)
        part[self.absent] = np.nan if values.dtype.kind == "f" else 0
        return part

    def of_rows(self, rows: NDArray[intp]) -> LaidOut:
        """The same ranges of some of the rows."""
        return LaidOut(self.rows[rows], self.columns, self.absent[rows])


def columns_of(ranges: Sequence[slice]) -> NDArray[intp]:
    """The columns of all ranges."""
    return np.concatenate([np.arange(own.start, own.stop) for own in ranges])

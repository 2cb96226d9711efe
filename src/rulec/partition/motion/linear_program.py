"""Linear programs, solved by HiGHS, to which rows can be added until a solution is good.

Source: Huangfu, Hall, "Parallelizing the dual revised simplex method" (2018); through the solver's
own Python interface, `highspy`.
"""

from __future__ import annotations

from dataclasses import dataclass

import highspy
import numpy as np
from numpy.typing import NDArray

Row = NDArray[np.float64]
"""One coefficient for each variable."""


@dataclass(frozen=True, slots=True)
class Solution:
    """The variables of a solution of least cost, and that cost."""

    values: Row
    cost: float


class LinearProgram:
    """Minimizes ``cost`` over variables within bounds, subject to rows within bounds."""

    def __init__(self, cost: Row, low: Row, high: Row) -> None:
        self._size, self._count = len(cost), 0
        self._solver = highspy.Highs()  # type: ignore[no-untyped-call]
        for name, value in (("output_flag", False), ("threads", 1), ("presolve", "off")):
            self._solver.setOptionValue(name, value)
        no_rows = (0, np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32), np.empty(0))
        self._solver.addCols(self._size, cost, _finite(low), _finite(high), *no_rows)

    def add(self, rows: NDArray[np.float64], low: Row, high: Row) -> int:
        """Add rows, times the variables, with their bounds; returns the first row's number."""
        first = self._count
        self._count += len(rows)
        used = rows != 0
        counts = used.sum(axis=1)
        starts = np.concatenate(([0], np.cumsum(counts)[:-1])).astype(np.int32)
        indices = np.nonzero(used)[1].astype(np.int32)
        coefficients = (len(indices), starts, indices, rows[used])
        self._solver.addRows(len(rows), _finite(low), _finite(high), *coefficients)
        return first

    def change(self, numbers: NDArray[np.intp], low: Row, high: Row) -> None:
        """Change the bounds of the rows with these numbers."""
        own = numbers.astype(np.int32)
        bounds = _finite(low), _finite(high)
        self._solver.changeRowsBounds(len(own), own, *bounds)  # type: ignore[attr-defined]

    def solved(self) -> Solution | None:
        """A solution of least cost; None if there is none."""
        self._solver.run()
        if self._solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return None
        values = np.array(self._solver.getSolution().col_value)
        return Solution(values, float(self._solver.getInfo().objective_function_value))


def _finite(bounds: Row) -> Row:
    return np.clip(bounds, -highspy.kHighsInf, highspy.kHighsInf)

"""Finding the piece of a line that contains a place, by table lookup instead of a search."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats

_HAIR_M = 1e-6
"""Upper bound (m) of the rounding error when a place is assigned to a cell."""

_FEWEST, _MOST_CELLS, _MOST_TRIED = 8, 1 << 14, 2


@dataclass(frozen=True, eq=False, slots=True)
class _Cells:
    """Intervals of equal length from ``origin`` (m) on, ``per_m`` of them per metre.

    ``before`` is the number of the last border before each cell; at most ``tried`` borders lie
    within one cell.
    """

    origin: float
    per_m: float
    before: NDArray[intp]
    tried: int


@dataclass(frozen=True, eq=False)
class Borders:
    """Ascending borders (m) between the pieces of a line."""

    places: Floats

    def before(self, s: Floats) -> NDArray[intp]:
        """For each place the number of the last border at or before it; 0 before the first border.

        The result for NaN is arbitrary.
        """
        cells = self._cells
        if cells is None:
            numbers: NDArray[intp] = self.places.searchsorted(s, "right") - 1
            return np.maximum(numbers, 0)
        with np.errstate(invalid="ignore"):
            own = ((s - cells.origin) * cells.per_m).astype(intp)
        numbers = cells.before.take(own, mode="clip")
        for _ in range(cells.tried):
            numbers += self._next.take(numbers) <= s
        return numbers

    @cached_property
    def _next(self) -> Floats:
        return np.append(self.places[1:], np.inf)

    @cached_property
    def _cells(self) -> _Cells | None:
        """A table whose cells contain few borders each; None if it would need too many cells."""
        # The first cell extends to before the second border, the last to behind the last but one
        inner = self.places[1:-1]
        if len(inner) < _FEWEST:
            return None
        usual_m = float(inner[-1] - inner[0]) / (len(inner) - 1)
        for length_m in (usual_m / 2, usual_m / 8):
            count = int((inner[-1] - inner[0]) / length_m) + 4
            if count > _MOST_CELLS:
                break
            starts = inner[0] + length_m * np.arange(-1, count - 1)
            before, last = (
                self.places.searchsorted(starts + more, "right") - 1
                for more in (-_HAIR_M, length_m + _HAIR_M)
            )
            before[0], last[-1] = 0, len(self.places) - 1
            tried = int((last - before).max())
            if tried <= _MOST_TRIED:
                return _Cells(float(starts[0]), 1 / length_m, before, tried)
        return None

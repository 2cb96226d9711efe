"""The pieces of a line on which a place may have its foot, found without trying each in full.

The places with a foot on a piece lie between the two lines that bound its fan, one through each
end. On which side of such a line a place is, is a sum of products: for all places and pieces that
is one product of matrices.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.recordings.recording import Points

_MARGIN_M = 1e-3
_FAR_M = 1e5
"""Up to so far from the line's first corner the margin covers what is rounded away."""

_AT_ONCE = 1 << 17
_MOST_PLACES = 2048
_Values = NDArray[float64]


@dataclass(frozen=True, eq=False, slots=True)
class LineFans:
    """For each piece (column) how far a place is beyond its beginning, and before its end.

    ``normals`` (3 rows) times x, y from ``origin`` and 1 is that, each with half of the columns;
    places with more than minus ``margin`` in both may have a foot there.
    """

    origin: Points
    normals: _Values
    margin: _Values

    def candidates(
        self, places: Points, low: NDArray[intp], high: NDArray[intp]
    ) -> tuple[NDArray[intp], NDArray[intp]]:
        """Numbers of places, ascending, with the pieces that may have a foot, ascending for each.

        Only pieces from ``low`` to ``high`` of each place; all that have a foot are among them.
        """
        parts = list(self._parts(places, low, high))
        if not parts:
            return np.empty(0, dtype=intp), np.empty(0, dtype=intp)
        numbers, pieces = (np.concatenate(part) for part in zip(*parts, strict=True))
        order = np.argsort(numbers, kind="stable")
        return numbers[order], pieces[order]

    def _parts(
        self, places: Points, low: NDArray[intp], high: NDArray[intp]
    ) -> Iterator[tuple[NDArray[intp], NDArray[intp]]]:
        homogeneous = np.column_stack((places - self.origin, np.ones(len(places))))
        scale = max(1.0, float(np.nanmax(np.abs(homogeneous), initial=0.0)) / _FAR_M)
        least = -self.margin * scale
        # Places with the same pieces in question go together
        order = np.argsort(low, kind="stable")
        widest = int((high - low).max(initial=0)) + 1
        bounded = bool((high - low + 1 < len(self.margin)).any())
        size = min(max(1, _AT_ONCE // widest), _MOST_PLACES)
        for at in range(0, len(places), size):
            numbers = order[at : at + size]
            first, last = low[numbers[0]], int(high[numbers].max())
            pieces = np.arange(first, last + 1)
            beyond = homogeneous[numbers] @ self.normals[:, :, first : last + 1]
            fits = (beyond >= least[first : last + 1]).all(axis=0)
            if bounded:
                fits &= (pieces >= low[numbers, None]) & (pieces <= high[numbers, None])
            place, piece = np.nonzero(fits)
            yield numbers[place], pieces[piece]


def line_fans(start: Points, ahead: Points, lengths: _Values, slopes: Points) -> LineFans:
    """The fans of pieces, with the slopes of their bounds (columns) at either end."""
    origin = start[:1]
    ux, uy = ahead.T
    first, last = slopes.T
    bounds = []
    for side, slope, corner in (
        (1.0, first, start - origin),
        (-1.0, last, start - origin + ahead * lengths[:, None]),
    ):
        nx, ny = side * (ux - uy * slope), side * (uy + ux * slope)
        bounds.append(np.stack((nx, ny, -(nx * corner[:, 0] + ny * corner[:, 1]))))
    margin = _MARGIN_M * (2 + np.abs(first) + np.abs(last))
    return LineFans(origin, np.stack(bounds), margin)

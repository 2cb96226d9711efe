"""The pieces of a line on which a place may have its foot, found without trying each in full.

The places with a foot on a piece lie between the two lines that bound its fan, one through each
end. On which side of such a line a place is, is a sum of products: for all places and pieces that
is one product of matrices. Single precision will do, since who may have a foot is tried in full.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import float32, float64, intp
from numpy.typing import NDArray

from rulec.recordings.recording import Points

_MARGIN_M, _MARGIN_PART = 1e-2, 1e-6
"""What single precision rounds away, of a place so far (m) from the line's first corner."""

_AT_ONCE = 1 << 17
_MOST_PLACES = 256
_FEW = 1 << 16
_Values = NDArray[float64]


@dataclass(frozen=True, eq=False, slots=True)
class LineFans:
    """How far places are beyond each end of a piece, first and last ones included.

    That is ``normals`` (3 rows, a column for each end) times x, y from ``origin`` and 1. A place
    beyond the one end and before the other, but for ``margin``, may have its foot on the piece.
    """

    origin: Points
    normals: NDArray[float32]
    margin: _Values

    def candidates(
        self, places: Points, low: NDArray[intp], high: NDArray[intp]
    ) -> tuple[NDArray[intp], NDArray[intp]]:
        """Numbers of places, each's end to end, with the pieces that may have a foot, ascending.

        Only pieces from ``low`` to ``high`` of each place; all that have a foot are among them.
        """
        parts = list(self._parts(places, low, high))
        if not parts:
            return np.empty(0, dtype=intp), np.empty(0, dtype=intp)
        numbers, pieces = (np.concatenate(part) for part in zip(*parts, strict=True))
        return numbers, pieces

    def _parts(
        self, places: Points, low: NDArray[intp], high: NDArray[intp]
    ) -> Iterator[tuple[NDArray[intp], NDArray[intp]]]:
        count = len(self.margin)
        away = places - self.origin
        farthest = float(np.nanmax(np.abs(away), initial=0.0))
        margin = (self.margin * (_MARGIN_M + _MARGIN_PART * farthest)).astype(float32)
        homogeneous = np.column_stack((away, np.ones(len(away)))).astype(float32)
        # Places with the same pieces in question go together; few numbers are sorted faster
        order = (low.astype(np.uint16) if count < _FEW else low).argsort(kind="stable")
        widest = int((high - low).max(initial=0)) + 1
        bounded = bool((high - low + 1 < count).any())
        size = min(max(1, _AT_ONCE // widest), _MOST_PLACES)
        for at in range(0, len(places), size):
            numbers = order[at : at + size]
            first, end = int(low[numbers[0]]), int(high[numbers].max()) + 1
            beyond = homogeneous[numbers] @ self.normals[:, first : end + 1]
            fits = beyond[:, :-1] >= -margin[first:end]
            fits &= beyond[:, 1:] <= margin[first:end]
            place, piece = fits.nonzero()
            numbers, pieces = numbers[place], piece + first
            if bounded:
                inside = (pieces >= low[numbers]) & (pieces <= high[numbers])
                numbers, pieces = numbers[inside], pieces[inside]
            yield numbers, pieces


def line_fans(start: Points, ahead: Points, lengths: _Values, slopes: Points) -> LineFans:
    """The fans of pieces, with the slopes of the lines that bound them (columns) at either end."""
    origin = start[:1]
    corners = np.concatenate((start, start[-1:] + ahead[-1:] * lengths[-1:, None])) - origin
    # Two pieces have the line between them in common
    directions = np.concatenate((ahead, ahead[-1:]))
    slope = np.concatenate((slopes[:, 0], slopes[-1:, 1]))
    normals = directions + slope[:, None] * np.stack((-directions[:, 1], directions[:, 0]), axis=1)
    normals /= np.hypot(*normals.T)[:, None]
    offsets = -(normals * corners).sum(axis=1)
    margin = 1 + 1e-2 * np.abs(slopes).sum(axis=1)
    return LineFans(origin, np.vstack((normals.T, offsets)).astype(float32), margin)

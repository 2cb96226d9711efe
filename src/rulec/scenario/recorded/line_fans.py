"""The pieces of a line that may contain the foot of a place, without trying every piece in full.

The places with a foot on a piece lie in its fan, between two bounding lines through its ends. The
side of such a line on which a place lies is given by a sum of products, so one matrix product
decides it for all places and pieces. Single precision is enough, because every candidate is then
computed in full.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import float32, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.recording import Points

_MARGIN_M, _MARGIN_PART = 1e-2, 1e-6
"""Rounding error of single precision: a constant (m), and a share of the largest distance."""

_AT_ONCE = 1 << 17
_MOST_PLACES = 256
_FEW = 1 << 16


@dataclass(frozen=True, eq=False, slots=True)
class LineFans:
    """The bounding lines of pieces' fans, for testing which pieces may contain a place's foot.

    ``normals`` (3 rows, one column per bounding line, first and last included) times (x, y, 1),
    relative to ``origin``, is how far (m) a place is beyond each line. A place beyond the first
    line of a piece and before its second, within ``margin``, may have its foot on the piece.
    """

    origin: Points
    normals: NDArray[float32]
    margin: Floats

    def candidates(
        self, places: Points, low: NDArray[intp], high: NDArray[intp]
    ) -> tuple[NDArray[intp], NDArray[intp]]:
        """Pairs of places' numbers and numbers of pieces that may contain their feet.

        The pairs of a place are consecutive, pieces ascending. Only pieces from ``low`` to ``high``
        of each place are considered; none that contains a foot is left out.
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
        # Batch places with similar piece ranges; 16-bit keys sort faster
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


def line_fans(start: Points, ahead: Points, lengths: Floats, slopes: Points) -> LineFans:
    """The fans of pieces; ``slopes`` has a column for the bounding lines at either end."""
    origin = start[:1]
    corners = np.concatenate((start, start[-1:] + ahead[-1:] * lengths[-1:, None])) - origin
    # Neighbouring pieces share a bounding line
    directions = np.concatenate((ahead, ahead[-1:]))
    slope = np.concatenate((slopes[:, 0], slopes[-1:, 1]))
    normals = directions + slope[:, None] * np.stack((-directions[:, 1], directions[:, 0]), axis=1)
    normals /= np.hypot(*normals.T)[:, None]
    offsets = -(normals * corners).sum(axis=1)
    margin = 1 + 1e-2 * np.abs(slopes).sum(axis=1)
    return LineFans(origin, np.vstack((normals.T, offsets)).astype(float32), margin)

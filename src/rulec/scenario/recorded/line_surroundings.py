"""Distance filter around a line, by a grid of squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import bool_, float64
from numpy.typing import NDArray

from rulec.recordings.polylines import arc_lengths, interpolated
from rulec.recordings.recording import Points

_SQUARE_M = 10.0
_MOST_SQUARES = 1 << 22
_MOST_ALONG = 1 << 16
"""So many squares at most along the line, however far beyond its ends somebody may come from."""

_Values = NDArray[float64]


@dataclass(frozen=True, eq=False, slots=True)
class LineSurroundings:
    """Squares of a grid, those flagged that places near a line may lie in.

    ``corner`` is the grid's lowest one, ``size`` a square's (m). The outermost are not flagged.
    """

    corner: Points
    size: float
    flags: NDArray[bool_]

    def holds(self, x: _Values, y: _Values) -> NDArray[bool_]:
        """Flags of places that may be near, all that are among them; NaN is nowhere."""
        (i, j) = (
            # NaN comes to lie in the outermost square
            np.fmin(np.fmax((values - low) * (1 / self.size), 0.0), count - 1).astype(np.int32)
            for values, low, count in zip((x, y), self.corner, self.flags.shape, strict=True)
        )
        flags: NDArray[bool_] = self.flags.take(i * self.flags.shape[1] + j)
        return flags


def line_surroundings(corners: Points, near_m: float) -> LineSurroundings:
    """The squares in which all places lie that are within ``near_m`` of a line through corners."""
    arc = arc_lengths(corners)
    size = _SQUARE_M
    area = (np.ptp(corners, axis=0) + 2 * near_m).prod()
    while area > _MOST_SQUARES * size**2 or arc[-1] > _MOST_ALONG * size:
        size *= 2
    count = int(np.ceil(arc[-1] / (size / 2))) + 1
    at = np.linspace(0.0, arc[-1], count)
    samples = interpolated(at, arc, corners)
    # The nearest sample is a quarter of a square farther away than the line, at most
    more = int(np.ceil(near_m / size + 0.25))
    corner = samples.min(axis=0) - (more + 1.5) * size
    squares = ((samples - corner) / size).astype(int)
    flags = np.zeros(squares.max(axis=0) + more + 2, dtype=bool)
    flags[squares[:, 0], squares[:, 1]] = True
    for _ in range(2):
        counts = np.pad(flags, ((more + 1, more), (0, 0))).cumsum(axis=0, dtype=np.int32)
        flags = (counts[2 * more + 1 :] > counts[: -2 * more - 1]).T
    return LineSurroundings(corner, size, np.ascontiguousarray(flags))

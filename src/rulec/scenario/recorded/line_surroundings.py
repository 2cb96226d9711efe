"""A fast filter for places near a line: a grid of squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import bool_
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.polylines import arc_lengths, interpolated
from rulec.recordings.recording import Points

_SQUARE_M = 10.0
_MOST_SQUARES = 1 << 22
_MOST_ALONG = 1 << 16
"""The most squares along the line, however far it is extended beyond its ends."""


@dataclass(frozen=True, eq=False, slots=True)
class LineSurroundings:
    """A grid of squares, with flags of those that may contain places near a line.

    ``corner`` is the grid's lowest corner, ``size`` a square's edge (m). The outermost have no
    flag.
    """

    corner: Points
    size: float
    flags: NDArray[bool_]

    def holds(self, x: Floats, y: Floats) -> NDArray[bool_]:
        """Mask of the places that may be near, including all that are; False for NaN."""
        (i, j) = (
            # NaN is put in the outermost square, which has no flag
            np.fmin(np.fmax((values - low) * (1 / self.size), 0.0), count - 1).astype(np.int32)
            for values, low, count in zip((x, y), self.corner, self.flags.shape, strict=True)
        )
        flags: NDArray[bool_] = self.flags.take(i * self.flags.shape[1] + j)
        return flags


def line_surroundings(corners: Points, near_m: float) -> LineSurroundings:
    """The squares that contain all places within ``near_m`` of the line through ``corners``."""
    arc = arc_lengths(corners)
    size = _SQUARE_M
    area = (np.ptp(corners, axis=0) + 2 * near_m).prod()
    while area > _MOST_SQUARES * size**2 or arc[-1] > _MOST_ALONG * size:
        size *= 2
    count = int(np.ceil(arc[-1] / (size / 2))) + 1
    at = np.linspace(0.0, arc[-1], count)
    samples = interpolated(at, arc, corners)
    # Samples are half a square apart, so the nearest is at most a quarter farther than the line
    more = int(np.ceil(near_m / size + 0.25))
    corner = samples.min(axis=0) - (more + 1.5) * size
    squares = ((samples - corner) / size).astype(int)
    flags = np.zeros(squares.max(axis=0) + more + 2, dtype=bool)
    flags[squares[:, 0], squares[:, 1]] = True
    for _ in range(2):
        counts = np.pad(flags, ((more + 1, more), (0, 0))).cumsum(axis=0, dtype=np.int32)
        flags = (counts[2 * more + 1 :] > counts[: -2 * more - 1]).T
    return LineSurroundings(corner, size, np.ascontiguousarray(flags))

"""Street-wise coordinates: the arc length ``s`` along a reference line and the offset ``d`` from it.

The foot of a place is where the place is perpendicular to the line. On a line of straight pieces
that leaves gaps at the outside of every bend and overlaps at the inside; so directions are
interpolated along each piece between those of its ends (Bender, Ziegler, Stiller, "Lanelets:
Efficient map representation for autonomous driving", IV 2014), and ``s`` and ``d`` vary without
jumps. Beyond its ends the line goes on straight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.scenario.commonroad.recording import Points

BEYOND_M = 2000.0
"""How far the line goes on straight beyond its ends."""

_CLOSEST_M = 0.05
_AT_ONCE = 1 << 20
_Values = NDArray[float64]


@dataclass(frozen=True, slots=True)
class ReferenceLine:
    """A line of straight pieces: corners, arc lengths there, and directions there as angles."""

    corners: Points
    arc: _Values
    headings: _Values

    @property
    def length(self) -> float:
        """From the first corner to the last, without what lies beyond."""
        return float(self.arc[-2])

    def heading_at(self, s: float) -> float:
        """The direction of the piece at ``s``, in radians."""
        piece = int(np.clip(np.searchsorted(self.arc, s, "right") - 1, 0, len(self.arc) - 2))
        dx, dy = self.corners[piece + 1] - self.corners[piece]
        return float(np.arctan2(dy, dx))

    def coordinates(self, places: Points) -> Points:
        """``s`` and ``d`` of places, a row each; not a number where a place has no foot."""
        pieces = len(self.arc) - 1
        size = max(1, _AT_ONCE // pieces)
        parts = [self._some(places[at : at + size]) for at in range(0, len(places), size)]
        return np.concatenate(parts) if parts else np.empty((0, 2))

    def _some(self, places: Points) -> Points:
        ahead = np.diff(self.corners, axis=0)
        lengths = np.hypot(ahead[:, 0], ahead[:, 1])
        ux, uy = ahead[:, 0] / lengths, ahead[:, 1] / lengths
        own = np.arctan2(ahead[:, 1], ahead[:, 0])
        # Slopes of the directions at both ends, as seen from the piece
        first = np.tan(_turn(own, self.headings[:-1]))
        change = np.tan(_turn(own, self.headings[1:])) - first
        dx = places[:, :1] - self.corners[None, :-1, 0]
        dy = places[:, 1:] - self.corners[None, :-1, 1]
        along = dx * ux + dy * uy
        across = ux * dy - uy * dx
        room = lengths - across * change
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (along + across * first) / room
        good = (room > 0) & (part >= -1e-9) & (part <= 1 + 1e-9)
        distance = np.where(good, np.hypot(along - part * lengths, across), np.inf)
        best = np.argmin(distance, axis=1)
        row = np.arange(len(places))
        found = np.isfinite(distance[row, best])
        s = self.arc[best] + part[row, best] * lengths[best]
        d = np.copysign(distance[row, best], across[row, best])
        return np.where(found[:, None], np.stack((s, d), axis=1), np.nan)


def reference_line(corners: Points) -> ReferenceLine:
    """The line through corners, of which those too close to the one before are left out."""
    kept = [corners[0]]
    for corner in corners[1:]:
        if np.hypot(*(corner - kept[-1])) > _CLOSEST_M:
            kept.append(corner)
    points = np.array(kept)
    start, end = points[1] - points[0], points[-1] - points[-2]
    extended = np.concatenate(
        (
            [points[0] - start / np.hypot(*start) * BEYOND_M],
            points,
            [points[-1] + end / np.hypot(*end) * BEYOND_M],
        )
    )
    steps = np.diff(extended, axis=0)
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1])))) - BEYOND_M
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    halves = angles[:-1] + _turn(angles[:-1], angles[1:]) / 2
    return ReferenceLine(extended, arc, np.concatenate((angles[:1], halves, angles[-1:])))


def _turn(before: _Values, after: _Values) -> _Values:
    """From one angle to another, the short way."""
    return (after - before + np.pi) % (2 * np.pi) - np.pi

"""Lanelets as strips beside a straight line, to tell fast which places are near them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from rulec.array_types import Flags, Floats
from rulec.recordings.recording import Lanelet, Points

_HAIR_M = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class _Bound:
    """The corners of a bound: their places along the line, and how far left of it they are (m).

    Between corners, one metre along the line is at most ``per_m`` metres along the bound.
    """

    along: Floats
    aside: Floats
    per_m: float

    @staticmethod
    def of(along: Floats, aside: Floats) -> _Bound | None:
        """None for a bound that leads back for a while, or straight aside."""
        # Maps repeat corners
        moved = (along[1:] != along[:-1]) | (aside[1:] != aside[:-1])
        kept = np.concatenate(([True], moved))
        along, aside = along[kept], aside[kept]
        steps = along[1:] - along[:-1]
        if not len(steps) or steps.min() <= _HAIR_M:
            return None
        steepest = float(np.abs((aside[1:] - aside[:-1]) / steps).max())
        return _Bound(along, aside, float(np.hypot(1.0, steepest)))

    def at(self, along: Floats) -> Floats:
        """How far left of the line the bound is; beyond an end, like that end."""
        return np.interp(along, self.along, self.aside)


@dataclass(frozen=True, eq=False, slots=True)
class LaneStrip:
    """A lanelet seen along the line from its start to its end, with its area.

    Without ``bounds`` its bounds lead back for a while, or cross each other.
    """

    start: Points
    ahead: Points
    area: shapely.Polygon
    bounds: tuple[_Bound, _Bound] | None

    @staticmethod
    def of(lanelet: Lanelet, area: shapely.Polygon) -> LaneStrip:
        """The strip of a lanelet with this area."""
        start, ahead = lanelet.centre[0], lanelet.centre[-1] - lanelet.centre[0]
        length = float(np.hypot(*ahead))
        if length:
            ahead = ahead / length
        strip = LaneStrip(start, ahead, area, None)
        right, left = (
            _Bound.of(*strip._along_and_aside(*line.T)) if length else None
            for line in (lanelet.right, lanelet.left)
        )
        if right is None or left is None:
            return strip
        # Lanes begin with no width, as numbers are rounded
        is_between = (right.at(left.along) <= left.aside + _HAIR_M / 2).all()
        is_between &= (left.at(right.along) >= right.aside - _HAIR_M / 2).all()
        return LaneStrip(start, ahead, area, (right, left)) if is_between else strip

    def near(self, x: Floats, y: Floats, near_m: float) -> Flags:
        """Mask of the places within ``near_m`` of the area."""
        near, unsure = self._sure_and_possible(x, y, near_m)
        asked = unsure.nonzero()[0]
        if len(asked):
            shapely.prepare(self.area)
            near[asked] = shapely.dwithin(self.area, shapely.points(x[asked], y[asked]), near_m)
        return near

    def _sure_and_possible(self, x: Floats, y: Floats, near_m: float) -> tuple[Flags, Flags]:
        """Masks of the places surely near the area, and of those that may be.

        A bound's place across from a place is in the area. The area lies beyond both bounds drawn
        on at their ends, from which a place is no nearer than its gap there if they were as steep
        as at their steepest.
        """
        if self.bounds is None:
            return np.zeros(len(x), dtype=bool), np.ones(len(x), dtype=bool)
        right, left = self.bounds
        along, aside = self._along_and_aside(x, y)
        off_right, off_left = right.at(along) - aside, aside - left.at(along)
        begin = max(right.along[0], left.along[0])
        end = min(right.along[-1], left.along[-1])
        least, most = near_m - _HAIR_M, near_m + _HAIR_M
        near: Flags = (along >= begin) & (along <= end)
        near &= (off_right <= least) & (off_left <= least)
        before, beyond = min(right.along[0], left.along[0]), max(right.along[-1], left.along[-1])
        unsure: Flags = (along >= before - most) & (along <= beyond + most) & ~near
        unsure &= (off_right <= most * right.per_m) & (off_left <= most * left.per_m)
        return near, unsure

    def _along_and_aside(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """How far (m) along the line, and left of it, places are."""
        (ux, uy), (x0, y0) = self.ahead.tolist(), self.start.tolist()
        dx, dy = x - x0, y - y0
        return dx * ux + dy * uy, dy * ux - dx * uy

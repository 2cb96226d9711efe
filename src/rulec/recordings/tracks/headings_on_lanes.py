"""The direction of the lane that a place is nearest to."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import atan2

import shapely

from rulec.recordings.recording import Lanelet

HeadingAt = Callable[[float, float], float]


def heading_on(lanelets: Iterable[Lanelet]) -> HeadingAt:
    """The direction (rad) of the nearest lanelet at a place; 0 without any lanelets."""
    middles = [shapely.LineString(lanelet.centre) for lanelet in lanelets]
    tree = shapely.STRtree(middles)

    def heading_at(x: float, y: float) -> float:
        nearest = tree.nearest(shapely.Point(x, y))
        if nearest is None:
            return 0.0
        line = middles[int(nearest)]
        at = line.project(shapely.Point(x, y))
        reach = min(1.0, line.length / 2)
        start = line.interpolate(max(0.0, at - reach))
        end = line.interpolate(min(line.length, at + reach))
        return atan2(end.y - start.y, end.x - start.x)

    return heading_at

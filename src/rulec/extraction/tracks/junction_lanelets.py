"""The lanelets of junctions, by the map or by crossing ways."""

from __future__ import annotations

from math import radians

import numpy as np
import shapely

from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.route import directions_beside, is_lane

_CROSSING_ANGLE = radians(30.0)
"""Ways that meet at a smaller angle run into each other, as where lanes join or part."""


def junction_lanelets(recording: Recording) -> frozenset[str]:
    """The ids of the lanelets in junctions.

    Where a map marks any, only those count: whoever drew it has thought of junctions.
    """
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    marked = {lanelet.id for lanelet in lanes if "intersection" in lanelet.types}
    if marked or not lanes:
        return frozenset(marked)
    lines = [shapely.LineString(lanelet.centre) for lanelet in lanes]
    firsts, seconds = shapely.STRtree(lines).query(lines, predicate="crosses")
    crossing: set[str] = set()
    for first, second in zip(firsts.tolist(), seconds.tolist(), strict=True):
        meeting = shapely.intersection(lines[first], lines[second])
        if first < second and _angle(lanes[first], lanes[second], meeting) > _CROSSING_ANGLE:
            crossing.update((lanes[first].id, lanes[second].id))
    return frozenset(crossing)


def _angle(first: Lanelet, second: Lanelet, meeting: shapely.Geometry) -> float:
    """The sharper angle (rad) between two lanelets where they meet.

    It is at most a right angle.
    """
    place = np.array([shapely.point_on_surface(meeting)])
    turn = directions_beside(first, place)[0] - directions_beside(second, place)[0]
    return float(abs(np.arctan(np.tan(turn))))

"""Which lanelets lie in a junction: those that a map says do, and those whose ways cross."""

from __future__ import annotations

from math import radians

import numpy as np
import shapely

from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.route import is_lane

_CROSSING = radians(30.0)
"""Ways that meet at a smaller angle run into each other, as where lanes join or part."""


def junction_lanelets(recording: Recording) -> frozenset[str]:
    """The ids of the lanelets in junctions."""
    lanes = [one for one in recording.lanelets.values() if is_lane(one)]
    found = {one.id for one in lanes if "intersection" in one.types}
    if found or not lanes:
        # Whoever drew the map has thought of junctions
        return frozenset(found)
    lines = [shapely.LineString(one.centre) for one in lanes]
    ones, others = shapely.STRtree(lines).query(lines, predicate="crosses")
    for one, other in zip(ones.tolist(), others.tolist(), strict=True):
        meeting = shapely.intersection(lines[one], lines[other])
        if one < other and _angle(lanes[one], lanes[other], meeting) > _CROSSING:
            found.update((lanes[one].id, lanes[other].id))
    return frozenset(found)


def _angle(one: Lanelet, other: Lanelet, meeting: shapely.Geometry) -> float:
    """The sharper angle between two lines where they meet."""
    place = shapely.point_on_surface(meeting)
    turn = _direction(one, place) - _direction(other, place)
    return float(abs(np.arctan(np.tan(turn))))


def _direction(lanelet: Lanelet, place: shapely.Point) -> float:
    along = shapely.line_locate_point(shapely.LineString(lanelet.centre), place)
    steps = np.diff(lanelet.centre, axis=0)
    reached = np.concatenate(([0.0], np.cumsum(np.hypot(*steps.T))))
    piece = int(np.clip(np.searchsorted(reached, along, "right") - 1, 0, len(steps) - 1))
    return float(np.arctan2(steps[piece, 1], steps[piece, 0]))

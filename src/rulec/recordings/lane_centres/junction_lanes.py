"""The lanes that lie in junctions, by where their centres cross."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
import shapely

from rulec.recordings.lane_centres.road_features import CentreLane, Places3d, RoadFeatures

CROSSING_RAD = np.radians(30.0)
"""Lanes that meet at a smaller angle join or part."""

APART_M = 2.5
"""Lanes whose heights differ by more do not meet: no truck gets through below."""


def junction_lanes(features: RoadFeatures) -> frozenset[str]:
    """The lanes in junctions.

    Those whose centres cross others at their height, those with a light or a stop sign, which stand
    where a junction begins, and those that begin at the same place as one of them.
    """
    inside = _crossed(features.lanes) | (features.stop_lanes | set(features.lights))
    inside &= set(features.lanes)
    begin_with = defaultdict(set)
    for lane in features.lanes.values():
        for before in lane.follows:
            begin_with[before].add(lane.id)
    for group in begin_with.values():
        if group & inside:
            inside |= group & set(features.lanes)
    return frozenset(inside)


def _crossed(lanes: Mapping[str, CentreLane]) -> set[str]:
    cars = [lane for lane in lanes.values() if "bicycleLane" not in lane.types]
    lines = [shapely.LineString(lane.centre[:, :2]) for lane in cars]
    if not lines:
        return set()
    pairs = shapely.STRtree(lines).query(lines, predicate="crosses").T.tolist()
    found: set[str] = set()
    for one, other in pairs:
        if one < other:
            place = shapely.point_on_surface(shapely.intersection(lines[one], lines[other]))
            (turn, z), (other_turn, other_z) = (
                _at(cars[index].centre, place) for index in (one, other)
            )
            # Heights that are not known do not part lanes
            meets = not abs(z - other_z) > APART_M
            if meets and abs(np.arctan(np.tan(turn - other_turn))) > CROSSING_RAD:
                found.update((cars[one].id, cars[other].id))
    return found


def _at(centre: Places3d, place: shapely.Point) -> tuple[float, float]:
    """The direction (rad) and the height (m) of a centre at its piece nearest a place."""
    away = np.hypot(*(centre[:-1, :2] + np.diff(centre[:, :2], axis=0) / 2 - (place.x, place.y)).T)
    piece = int(np.argmin(away))
    x, y = centre[piece + 1, :2] - centre[piece, :2]
    return float(np.arctan2(y, x)), float(centre[piece, 2])

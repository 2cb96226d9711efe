"""The lanes that lie in junctions, found from where their centre lines cross."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
import shapely

from rulec.recordings.lane_centres.road_features import (
    CentreLane,
    Places3d,
    RoadFeatures,
)
from rulec.recordings.polylines import arc_lengths

CROSSING_RAD = np.radians(30.0)
"""Lanes that meet at a smaller angle (rad) merge or diverge rather than cross."""

APART_M = 2.5
"""Lanes whose heights differ by more (m) do not meet: a truck fits through below."""


LONGEST_M = 60.0
"""The longest way (m) through a junction; of a longer lane only a part lies in one."""

AROUND_M = 15.0
"""How far (m) that part extends before and after the crossings with other lanes."""

Stretch = tuple[int, int]
"""The part of a lane between two points of its centre line, by index."""


def junction_stretches(features: RoadFeatures) -> dict[str, Stretch]:
    """The lanes in junctions, with the parts of them that lie there.

    These are lanes whose centre line crosses another at the same height, lanes with a light or a
    stop sign, which stand where a junction begins, and lanes that begin at the same place as one of
    these.
    """
    lanes, crossed = features.lanes, _crossed(features.lanes)
    begin = (features.stop_lanes | set(features.lights)) & set(lanes)
    begin_with = defaultdict(set)
    for lane in lanes.values():
        for before in lane.follows:
            begin_with[before].add(lane.id)
    for group in begin_with.values():
        if group & (begin | crossed.keys()):
            begin |= group
    return {
        name: _stretch(lanes[name], crossed.get(name, []), from_start=name in begin)
        for name in sorted(begin | crossed.keys())
    }


def _stretch(lane: CentreLane, places: list[float], *, from_start: bool) -> Stretch:
    along = arc_lengths(lane.centre[:, :2])
    last = len(along) - 1
    if along[-1] <= LONGEST_M:
        return 0, last
    starts = [0.0] if from_start else []
    low = min([*starts, *(place - AROUND_M for place in places)])
    high = max([*starts, *places]) + AROUND_M
    start, end = np.searchsorted(along, [low, high]).tolist()
    return int(start), min(int(end), last)


def _crossed(lanes: Mapping[str, CentreLane]) -> dict[str, list[float]]:
    """The lanes that others cross, with the positions of the crossings along them (m)."""
    cars = [lane for lane in lanes.values() if "bicycleLane" not in lane.types]
    lines = [shapely.LineString(lane.centre[:, :2]) for lane in cars]
    if not lines:
        return {}
    pairs = shapely.STRtree(lines).query(lines, predicate="crosses").T.tolist()
    crossings: dict[str, list[float]] = defaultdict(list)
    for first, second in pairs:
        if first < second:
            place = shapely.point_on_surface(shapely.intersection(lines[first], lines[second]))
            (turn, z), (other_turn, other_z) = (
                _at(cars[index].centre, place) for index in (first, second)
            )
            # Unknown heights do not separate lanes
            meets = not abs(z - other_z) > APART_M
            if meets and abs(np.arctan(np.tan(turn - other_turn))) > CROSSING_RAD:
                for index in (first, second):
                    crossings[cars[index].id].append(float(lines[index].project(place)))
    return crossings


def _at(centre: Places3d, place: shapely.Point) -> tuple[float, float]:
    """The direction (rad) and the height (m) of a centre line at its segment nearest to a place."""
    away = np.hypot(*(centre[:-1, :2] + np.diff(centre[:, :2], axis=0) / 2 - (place.x, place.y)).T)
    piece = int(np.argmin(away))
    x, y = centre[piece + 1, :2] - centre[piece, :2]
    return float(np.arctan2(y, x)), float(centre[piece, 2])

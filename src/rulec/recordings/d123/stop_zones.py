"""Stop zones of 123D's maps, as signs of the lanes that lead to them.

A zone names its lanes, but not whether it lies where these begin or where they end: Waymo's are the
lanes after the line, as in its own files, and the parser of OpenDRIVE puts zones where its lanes
begin. The position of the zone decides.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import shapely

from rulec.recordings.recording import Lanelet, Points

SIGNS: Mapping[int, str] = {2: "STOP", 3: "YIELD"}
"""Zone types that stand for signs, by number."""

_NEAR_M = 2.0
_BESIDE_M = 1.5
"""Lanelets whose centre line is this near (m) to a zone belong to it; a neighbour's is farther."""

_INTERSECTION = "intersection"


@dataclass(frozen=True, slots=True, eq=False)
class StopZone:
    """A zone that stands for a sign: its outline, and its lanes."""

    sign: str
    outline: Points
    lanes: tuple[str, ...]


def with_signs(
    lanelets: Mapping[str, Lanelet], zones: Iterable[StopZone], *, all_behind: bool
) -> tuple[dict[str, Lanelet], int]:
    """The lanelets with the signs of zones, and the number of zones that could not be placed.

    For lanelets at those zones, and for their lanes, it is unknown whether the sign applies.
    ``all_behind``: zones name the lanes after their lines, whether these are in an intersection or
    not.
    """
    signs: dict[str, set[str]] = defaultdict(set)
    untold: dict[str, set[str]] = defaultdict(set)
    middles = shapely.STRtree([shapely.LineString(lanelet.centre) for lanelet in lanelets.values()])
    names = list(lanelets)
    left_out = 0
    for zone in zones:
        shape = shapely.convex_hull(shapely.MultiPoint(zone.outline))
        before = [
            name
            for lane in zone.lanes
            if lane in lanelets
            for name in _lanes_before(lanelets, lanelets[lane], shape, all_behind=all_behind)
        ]
        if not before:
            left_out += 1
            near = middles.query(shape, predicate="dwithin", distance=_BESIDE_M).tolist()
            for name in {names[k] for k in near} | lanelets.keys() & zone.lanes:
                untold[name].add(zone.sign)
        for name in before:
            signs[name].add(zone.sign)
    signed = dict(lanelets)
    for name, own in signs.items():
        signed[name] = replace(signed[name], signs=signed[name].signs | own)
    for name, own in untold.items():
        signed[name] = replace(signed[name], untold_signs=frozenset(own - signed[name].signs))
    return signed, left_out


def _lanes_before(
    lanelets: Mapping[str, Lanelet], lane: Lanelet, zone: shapely.Geometry, *, all_behind: bool
) -> list[str]:
    """The lanes that end at a zone: those before a lane that begins there, or the lane itself."""
    start, end = (shapely.distance(zone, shapely.Point(lane.centre[at])) for at in (0, -1))
    if min(start, end) > _NEAR_M:
        return []
    if start < end:
        if not all_behind and _INTERSECTION not in lane.types:
            return []
        names = [name for name in lane.predecessors if name in lanelets]
        return [name for name in names if _INTERSECTION not in lanelets[name].types]
    return [] if _INTERSECTION in lane.types else [lane.id]

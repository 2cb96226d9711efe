"""The lanes that lie in junctions, found from where their centre lines cross."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np

from rulec.recordings.lane_centres.road_features import CentreLane, RoadFeatures
from rulec.recordings.polylines import arc_lengths, crossings

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
    found: dict[str, list[float]] = defaultdict(list)
    for pair in crossings([lane.centre[:, :2] for lane in cars], CROSSING_RAD):
        first, second = cars[pair.first], cars[pair.second]
        apart_m = _height(first, pair.first_along) - _height(second, pair.second_along)
        # Unknown heights do not separate lanes
        if not abs(apart_m) > APART_M:
            found[first.id].append(pair.first_along)
            found[second.id].append(pair.second_along)
    return found


def _height(lane: CentreLane, along: float) -> float:
    """The height (m) of a centre line where the segment at a place along it (m) begins."""
    piece = int(arc_lengths(lane.centre[:, :2])[1:-1].searchsorted(along, "right"))
    return float(lane.centre[piece, 2])

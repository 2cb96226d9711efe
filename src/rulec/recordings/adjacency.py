"""Lanelets side by side, as their borders lie, whether or not the file says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import cos, radians

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import Lanelet, Points, Recording, is_lane

BORDER_M = 0.5
"""Borders that are no farther apart are one."""

WHOLE = 0.9
"""Lanelets whose borders are one for so much of either are neighbours."""

LONG_M = 30.0
"""Shorter ones side by side, as where turning lanes begin, may lead different ways."""

_EVERY_M = 2.0
_LIKE = cos(radians(30))
_NAMED = 3


@dataclass(frozen=True, slots=True)
class Bordering:
    """A lanelet right of another one; for which part of each their border is one, and how long."""

    right: Lanelet
    left: Lanelet
    part: float
    length: float


def bordering(lanelets: Iterable[Lanelet]) -> Iterator[Bordering]:
    """The pairs of lanes of like direction with a stretch of border in common.

    Without those of which the map says so.
    """
    lanes = [lanelet for lanelet in lanelets if is_lane(lanelet)]
    lefts = [shapely.LineString(lanelet.left) for lanelet in lanes]
    rights = [shapely.LineString(lanelet.right) for lanelet in lanes]
    if not lanes:
        return
    pairs = shapely.STRtree(rights).query(lefts, predicate="dwithin", distance=BORDER_M)
    for own, other in pairs.T.tolist():
        if own == other or lanes[own].left_of == lanes[other].id:
            continue
        near = _near(lefts[own], rights[other]), _near(rights[other], lefts[own])
        part = float(min(flags.mean() for flags in near))
        yield Bordering(lanes[own], lanes[other], part, float(near[0].mean() * lefts[own].length))


def _near(line: shapely.LineString, other: shapely.LineString) -> NDArray[np.bool_]:
    """Flags of places along a line that lie at another one, which leads the same way there."""
    count = max(2, round(line.length / _EVERY_M)) + 1
    at = np.linspace(0.0, line.length, count)
    points = shapely.line_interpolate_point(line, at)
    near = shapely.distance(other, points) <= BORDER_M
    along = shapely.line_locate_point(other, points)
    like = (_directions(line, at) * _directions(other, along)).sum(axis=1) >= _LIKE
    flags: NDArray[np.bool_] = near & like
    return flags


def _directions(line: shapely.LineString, at: NDArray[float64]) -> Points:
    ends = (
        shapely.line_interpolate_point(line, np.clip(at + way, 0, line.length)) for way in (-1, 1)
    )
    before, after = (shapely.get_coordinates(points) for points in ends)
    steps = after - before
    directions: Points = steps / np.maximum(np.hypot(*steps.T), 1e-9)[:, None]
    return directions


def _crossed(lanelets: Iterable[Lanelet]) -> set[str]:
    """The lanes whose middles cross another one's."""
    lanes = [lanelet for lanelet in lanelets if is_lane(lanelet)]
    middles = [shapely.LineString(lanelet.centre) for lanelet in lanes]
    if not lanes:
        return set()
    pairs = shapely.STRtree(middles).query(middles, predicate="crosses")
    return {lanes[number].id for number in pairs.ravel().tolist()}


def with_neighbours(recording: Recording) -> Recording:
    """The recording, with neighbours that its map does not name, and a remark that says so.

    Lanes that others cross are left out: side by side in a junction, they lead different ways.
    """
    lanelets = dict(recording.lanelets)
    crossed = _crossed(lanelets.values())
    found = []
    for pair in sorted(bordering(lanelets.values()), key=lambda pair: -pair.part):
        right, left = lanelets[pair.right.id], lanelets[pair.left.id]
        if pair.part < WHOLE or pair.length < LONG_M or crossed.intersection((right.id, left.id)):
            continue
        if right.left_of is not None or left.right_of is not None:
            continue
        lanelets[right.id] = replace(right, left_of=left.id)
        lanelets[left.id] = replace(left, right_of=right.id)
        found.append(f"{right.id} and {left.id}")
    if not found:
        return recording
    more = f", and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    remark = (
        "lanelets side by side are taken to be neighbours, which the file does not say: "
        + ", ".join(found[:_NAMED])
        + more
    )
    return replace(recording, lanelets=lanelets, remarks=(*recording.remarks, remark))

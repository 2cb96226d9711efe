"""Distances of lane bounds from the centre lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.lane_centres.road_features import (
    BoundaryPart,
    CentreLane,
    LaneSide,
    RoadFeatures,
)
from rulec.recordings.polylines import arc_lengths, parallel_line

Widths = NDArray[float64]

USUAL_HALF_M = 1.8
"""Half of 12 ft (m), the usual lane width in the USA (AASHTO, A Policy on Geometric Design)."""

NARROWEST_HALF_M, WIDEST_HALF_M = 0.6, 2.5
"""A line nearer or farther (m) is not a bound of this lane, such as a kerb behind parked cars."""

_WITHIN_M = 0.2


class HalfWidths(NamedTuple):
    """The distances (m) of a lane's left and right bounds from the points of its centre line."""

    left: Widths
    right: Widths


def half_widths(features: RoadFeatures) -> dict[str, HalfWidths]:
    """The half widths of all lanes.

    They come from a lane's own outline or boundaries, else from half the distance to neighbours.
    Between places where they are known they are interpolated; if a side is unknown, they are
    continued from the lanes before and after, as through junctions, or else have the usual value.
    """
    lines = {name: shapely.LineString(points) for name, points in features.lines.items()}
    centres = {
        name: shapely.LineString(lane.centre[:, :2]) for name, lane in features.lanes.items()
    }
    known = {
        name: _by_area(lane) if lane.area is not None else _by_sides(lane, lines, centres)
        for name, lane in features.lanes.items()
    }
    return {
        name: HalfWidths(*(_filled(lane, known, side) for side in (0, 1)))
        for name, lane in features.lanes.items()
    }


def _by_sides(
    lane: CentreLane,
    lines: Mapping[str, shapely.LineString],
    centres: Mapping[str, shapely.LineString],
) -> HalfWidths:
    points = shapely.points(lane.centre[:, :2])
    return HalfWidths(*(_by_side(points, side, lines, centres) for side in (lane.left, lane.right)))


def _by_side(
    points: NDArray[np.object_],
    side: LaneSide,
    lines: Mapping[str, shapely.LineString],
    centres: Mapping[str, shapely.LineString],
) -> Widths:
    widths = np.full(len(points), np.nan)
    for part in side.boundaries:
        own = slice(part.start, part.end + 1)
        if part.line in lines:
            widths[own] = _sound(_distances(points[own], lines[part.line]))
    for beside in side.neighbours:
        own = slice(beside.start, beside.end + 1)
        if beside.lane in centres:
            halves = _sound(_distances(points[own], centres[beside.lane]) / 2)
            widths[own] = np.where(np.isnan(widths[own]), halves, widths[own])
    return widths


def at_their_lines(features: RoadFeatures) -> dict[str, CentreLane]:
    """The lanes, with only those parts of their boundaries whose line lies where the bound is.

    Where a line is farther away than a bound may be, as beside a slip road, its mark does not
    count.
    """
    lines = {name: shapely.LineString(points) for name, points in features.lines.items()}

    def at_lines(lane: CentreLane, side: LaneSide) -> LaneSide:
        points = shapely.points(lane.centre[:, :2])
        parts = (part for known in side.boundaries for part in _near_its_line(known, points, lines))
        return replace(side, boundaries=tuple(parts))

    return {
        name: lane
        if lane.area is not None
        else replace(lane, left=at_lines(lane, lane.left), right=at_lines(lane, lane.right))
        for name, lane in features.lanes.items()
    }


def _near_its_line(
    part: BoundaryPart, points: NDArray[np.object_], lines: Mapping[str, shapely.LineString]
) -> Iterator[BoundaryPart]:
    """The parts of a boundary along which its line is neither too near nor too far."""
    if part.line not in lines:
        yield part
        return
    away = _distances(points[part.start : part.end + 1], lines[part.line])
    near = np.concatenate(([False], ~np.isnan(_sound(away)), [False]))
    edges = np.flatnonzero(np.diff(near.astype(np.int8))).reshape(-1, 2) + part.start
    for start, end in edges.tolist():
        yield replace(part, start=start, end=end - 1)


def _distances(points: NDArray[np.object_], line: shapely.LineString) -> Widths:
    # GEOS divides by the square of a segment's length, which may be almost 0
    with np.errstate(all="ignore"):
        distances: Widths = shapely.distance(points, line)
    return distances


def _by_area(lane: CentreLane) -> HalfWidths:
    """Half widths from where lines straight across the lane leave its outline.

    Those at the lane's ends are taken slightly inside, since the ends belong to the outline, too.
    """
    centre = lane.centre[:, :2].copy()
    for end, inner in ((0, 1), (-1, -2)):
        along = lane.centre[inner, :2] - lane.centre[end, :2]
        centre[end] += along * min(_WITHIN_M / float(np.hypot(*along)), 0.5)
    ring = shapely.LinearRing(lane.area)
    points = shapely.points(centre)
    widths = []
    for away in (WIDEST_HALF_M, -WIDEST_HALF_M):
        rays = shapely.linestrings(np.stack((centre, parallel_line(centre, away)), axis=1))
        met = shapely.intersection(rays, ring)
        widths.append(
            _sound(np.where(shapely.is_empty(met), np.nan, shapely.distance(points, met)))
        )
    return HalfWidths(*widths)


def _sound(widths: Widths) -> Widths:
    sound = (widths >= NARROWEST_HALF_M) & (widths <= WIDEST_HALF_M)
    return np.where(sound, widths, np.nan)


def _filled(lane: CentreLane, known: Mapping[str, HalfWidths], side: int) -> Widths:
    own = known[lane.id][side]
    there = ~np.isnan(own)
    along = arc_lengths(lane.centre[:, :2])
    if there.any():
        filled: Widths = np.interp(along, along[there], own[there])
        return filled
    before = _mean(known[name][side][-1] for name in lane.follows if name in known)
    after = _mean(known[name][side][0] for name in lane.leads_to if name in known)
    start = before if before is not None else after
    end = after if after is not None else before
    if start is None or end is None:
        return np.full(len(own), USUAL_HALF_M)
    between: Widths = start + (end - start) * along / along[-1]
    return between


def _mean(values: Iterable[float]) -> float | None:
    known = [value for value in values if not np.isnan(value)]
    return float(np.mean(known)) if known else None

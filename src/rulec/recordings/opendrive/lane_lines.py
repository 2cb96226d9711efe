"""Borders of lanes as lines of points, within a centimetre of the standard's curves.

The points of all borders of a piece have the same values of ``s``, so that neighbouring lines have
the same number of points. Heights and superelevation are ignored: lines are those of a level road.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.opendrive.content.elements import LaneSection, MapRoad
from rulec.recordings.opendrive.pieces import RoadPiece
from rulec.recordings.opendrive.plan_view import cubics_at, places_on
from rulec.recordings.recording import Points

WITHIN_M = 0.004
_LONGEST_M = 10.0
_SHORTEST_M = 0.02
_QUARTERS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
_BEFORE_M = 1e-7
MOST_PLACES = 1_000_000
"""The most points of all lines of a piece together."""

_LARGEST = 1e8
_NARROWEST_M = -1000.0

Lines = NDArray[float64]
"""Lines beside each other, in an array of the shape (lines, points, 2)."""


def lane_borders(piece: RoadPiece) -> Mapping[int, Lines]:
    """Lane -> its borders at smaller and at greater ``t``, both in the road's direction.

    Raises ValueError if the road winds so much that it needs too many points, if it leads too far
    away, or if a lane's width is far below 0.
    """
    road, section = piece.road, piece.section
    numbers = _in_order(section)
    breaks = [x.s for x in road.geometries] + [x.start for x in road.offsets]
    for lane in section.lanes.values():
        breaks += [section.start + x.start for x in (*lane.widths, *lane.borders)]
    s = np.array(sorted({piece.start, piece.end, *breaks}))
    s = _fine_enough(piece, s[(s >= piece.start) & (s <= piece.end)])
    _check_widths(section, np.minimum(s, max(piece.end - _BEFORE_M, piece.start)))
    lines = _lines(piece, s)
    return {
        lane: lines[row : row + 2]
        for row, lane in enumerate(number for number in numbers if number != 0)
    }


def _check_widths(section: LaneSection, s: Floats) -> None:
    """Raise ValueError for a width far below 0; slightly negative widths occur where lanes end."""
    for number, lane in section.lanes.items():
        least = cubics_at(lane.widths, s - section.start).min()
        if not least > _NARROWEST_M:
            raise ValueError(f"its lane {number} has a width of {least:g} m")


def _in_order(section: LaneSection) -> list[int]:
    """The lanes from right to left; a lane that is left out has no width."""
    return sorted(section.lanes)


def _fine_enough(piece: RoadPiece, s: Floats) -> Floats:
    """Values of ``s`` close enough that no line is farther from its curve than allowed."""
    parts = [
        np.linspace(low, high, max(1, int(np.ceil((high - low) / _LONGEST_M))), endpoint=False)
        for low, high in itertools.pairwise(s)
    ]
    waiting = np.append(np.concatenate(parts), s[-1])
    ends = np.column_stack((waiting[:-1], waiting[1:]))
    done = [s]
    count = 0
    while len(ends):
        count += len(ends) * len(piece.section.lanes)
        if count > MOST_PLACES:
            raise ValueError(f"its lanes wind so much that they need over {MOST_PLACES:,} points")
        done.append(ends.ravel())
        at = ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * _QUARTERS
        flat = at.ravel()
        order = np.argsort(flat, kind="stable")
        places = _lines(piece, flat[order])
        lines = np.empty_like(places)
        lines[:, order] = places
        lines = lines.reshape(len(places), len(ends), len(_QUARTERS), 2)
        chords = lines[:, :, :1] + (lines[:, :, -1:] - lines[:, :, :1]) * _QUARTERS[:, None]
        away = np.hypot(*np.moveaxis(lines - chords, -1, 0)).max(axis=(0, 2))
        coarse = ends[(away > WITHIN_M) & (ends[:, 1] - ends[:, 0] > _SHORTEST_M)]
        middle = coarse.mean(axis=1)
        ends = np.concatenate(
            (np.column_stack((coarse[:, 0], middle)), np.column_stack((middle, coarse[:, 1])))
        )
    return np.unique(np.concatenate(done))


def _lines(piece: RoadPiece, s: Floats) -> Lines:
    """All borders of a piece from right to left, at ascending values of ``s``."""
    inside = np.minimum(s, piece.end - _BEFORE_M) if piece.end > piece.start else s
    t = border_offsets(piece.road, piece.section, inside)
    with np.errstate(all="ignore"):
        line = places_on(piece.road.geometries, s)
        x, y = line.x - t * np.sin(line.heading), line.y + t * np.cos(line.heading)
    if not max(np.abs(x).max(), np.abs(y).max()) < _LARGEST:
        raise ValueError("it leads farther away than the earth is large")
    return np.stack((x, y), axis=-1)


def span_at(piece: RoadPiece, lane: int, s: float) -> tuple[float, float]:
    """The ``t`` of a lane's right and left border at ``s``."""
    row = [number for number in _in_order(piece.section) if number != 0].index(lane)
    inside = np.clip(s, piece.start, max(piece.end - _BEFORE_M, piece.start))
    offsets = border_offsets(piece.road, piece.section, np.array([inside]))[:, 0]
    return float(offsets[row]), float(offsets[row + 1])


def places_beside(road: MapRoad, places: Sequence[tuple[float, float]]) -> Points:
    """The points with these pairs of ``s`` and ``t``, in their order."""
    s, t = np.array(places, dtype=float).reshape(-1, 2).T
    s = np.clip(s, 0.0, road.length)
    order = np.argsort(s, kind="stable")
    line = places_on(road.geometries, s[order])
    points = np.empty((len(s), 2))
    across = t[order]
    points[order, 0] = line.x - across * np.sin(line.heading)
    points[order, 1] = line.y + across * np.cos(line.heading)
    return points


def border_offsets(road: MapRoad, section: LaneSection, s: Floats) -> Lines:
    """The ``t`` of all borders of a lane section from right to left, one row each."""
    centre = cubics_at(road.offsets, s)
    way = s - section.start
    sides: list[list[Floats]] = []
    for side in (-1, 1):
        borders: list[Floats] = []
        inner = centre
        for number in sorted((x for x in section.lanes if x * side > 0), key=abs):
            lane = section.lanes[number]
            if lane.widths or not lane.borders:
                inner = inner + side * np.maximum(cubics_at(lane.widths, way), 0.0)
            else:
                # Tools differ in the sign of borders right of the centre
                inner = centre + side * np.abs(cubics_at(lane.borders, way))
            borders.append(inner)
        sides.append(borders)
    right, left = sides
    return np.stack((*reversed(right), centre, *left))

"""The shapes of lanes: bounds and centre line with equally many points, in the points' order.

Each lane has a reference line: its centre line, or else its longest boundary. Boundaries become
lateral offsets from that line, so they may consist of several parts, begin and end elsewhere
(dashed ones at a dash), or be missing on one side.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.osi.lane_messages import Boundary, TraceLane
from rulec.recordings.polylines import line_length
from rulec.recordings.recording import Points

USUAL_WIDTH_M = 3.5
"""The width (m) assumed for a lane whose width is unknown."""

WIDTHS_M = (2.0, 5.0)
"""Adjacent centre lines this far apart (m, least and most) give the lanes' width."""

_BEYOND_M = 1.0
"""How far (m) the ends of adjacent lanes may lie beyond each other."""

_CLOSEST_M = 0.01
_SHARPEST = 0.5


class LaneShape(NamedTuple):
    """Left and right bound and centre line; ``assumed``: whether a width is not from the trace."""

    left: Points
    right: Points
    centre: Points
    assumed: bool = False


class _Line:
    """A polyline of at least two points, with positions along and beside it."""

    def __init__(self, points: Points) -> None:
        steps = np.diff(points, axis=0)
        lengths = np.hypot(*steps.T)
        self.points = points
        self.reached = np.concatenate(([0.0], np.cumsum(lengths)))
        self._ahead = steps / lengths[:, None]
        self._string = shapely.LineString(points)

    def beside(self, points: Points) -> tuple[NDArray[float64], NDArray[float64]]:
        """Each point's distance along the line (m) and offset to its left (m), in order."""
        along = shapely.line_locate_point(self._string, shapely.points(points))
        piece = self._piece(along)
        away = points - self.points[piece]
        ahead = self._ahead[piece]
        left = ahead[:, 0] * away[:, 1] - ahead[:, 1] * away[:, 0]
        # Beyond its ends the line is extended straight
        beyond = (along <= 0) | (along >= self.reached[-1])
        along = np.where(beyond, self.reached[piece] + (ahead * away).sum(axis=1), along)
        order = np.argsort(along, kind="stable")
        return along[order], left[order]

    def at(self, along: NDArray[float64], left: NDArray[float64] | float = 0.0) -> Points:
        """The points at the given distances along the line and offsets to its left."""
        x, y = (np.interp(along, self.reached, axis) for axis in self.points.T)
        piece = self._piece(along)
        ahead = self._ahead[piece].copy()
        # At a corner, the parallels of both segments meet on its bisector
        corner = (np.abs(along - self.reached[piece]) < _CLOSEST_M / 2) & (piece > 0)
        before = self._ahead[piece[corner] - 1]
        both = 1.0 + (before * ahead[corner]).sum(axis=1)
        ahead[corner] = (before + ahead[corner]) / np.maximum(both, _SHARPEST)[:, None]
        across = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)
        places: Points = np.stack((x, y), axis=1) + across * np.reshape(left, (-1, 1))
        return places

    def _piece(self, along: NDArray[float64]) -> NDArray[np.intp]:
        piece = np.searchsorted(self.reached, along + _CLOSEST_M / 2, side="right") - 1
        clipped: NDArray[np.intp] = np.clip(piece, 0, len(self._ahead) - 1)
        return clipped


def lane_shape(
    lane: TraceLane, boundaries: Mapping[str, Boundary], middles: Mapping[str, Points]
) -> LaneShape | None:
    """The shape of a lane; None if it has neither a centre line nor boundaries.

    ``middles``: the centre lines of all lanes, used where boundaries are missing.
    """
    bounds = lane.left_bounds, lane.right_bounds
    sides = [[boundaries[x].line for x in ids if x in boundaries] for ids in bounds]
    lines = [lane.centre] if len(lane.centre) > 1 else [x for side in sides for x in side]
    if not lines:
        return None
    line = _Line(max(lines, key=line_length))
    known = [_side(line, side) if side else None for side in sides]
    end = line.reached[-1]
    stations = np.concatenate([line.reached, *(side[0] for side in known if side is not None)])
    stations = np.unique(np.clip(stations, 0.0, end))
    stations = stations[np.concatenate(([True], np.diff(stations) > _CLOSEST_M))]
    stations[-1] = end
    left, right = (None if side is None else np.interp(stations, *side) for side in known)
    widths, assumed = _widths(lane, line, left, right, middles)
    left = np.full(len(stations), widths[0]) if left is None else left
    right = np.full(len(stations), -widths[1]) if right is None else right
    middle = 0.0 if len(lane.centre) > 1 else (left + right) / 2
    at = [line.at(stations, side) for side in (left, right, middle)]
    return LaneShape(at[0], at[1], at[2], assumed)


def _side(line: _Line, parts: Iterable[Points]) -> tuple[NDArray[float64], NDArray[float64]]:
    """The boundaries of one side as distances along and offsets beside a line, in order."""
    beside = sorted((line.beside(points) for points in parts), key=lambda x: float(x[0].mean()))
    along, left = (np.concatenate(rows) for rows in zip(*beside, strict=True))
    order = np.argsort(along, kind="stable")
    return along[order], left[order]


def _widths(
    lane: TraceLane,
    line: _Line,
    left: NDArray[float64] | None,
    right: NDArray[float64] | None,
    middles: Mapping[str, Points],
) -> tuple[tuple[float, float], bool]:
    """Left and right half widths (m) for sides without boundary, and whether any is the default.

    A half width comes from the adjacent lanes, else from the lane's other side.
    """
    if left is not None and right is not None:
        return (0.0, 0.0), False
    if len(lane.centre) < 2:
        # Only one side has a boundary
        width = USUAL_WIDTH_M
        return (width, width), True
    halves = [
        float(np.median(np.abs(side))) if side is not None else _half(line, beside, middles)
        for side, beside in ((left, lane.left_of), (right, lane.right_of))
    ]
    known = [half for half in halves if half is not None]
    usual = known[0] if known else USUAL_WIDTH_M / 2
    filled = [usual if half is None else half for half in halves]
    return (filled[0], filled[1]), not known


def _half(line: _Line, beside: Sequence[str], middles: Mapping[str, Points]) -> float | None:
    """Half the distance to an adjacent lane's centre line; None if no distance is plausible."""
    for name in beside:
        if name in middles:
            along, left = line.beside(middles[name])
            inside = (along > -_BEYOND_M) & (along < line.reached[-1] + _BEYOND_M)
            away = float(np.median(np.abs(left[inside]))) if inside.any() else 0.0
            if WIDTHS_M[0] <= away <= WIDTHS_M[1]:
                return away / 2
    return None


def way_across(before: LaneShape, after: LaneShape) -> LaneShape:
    """The shape of a way from one lane's end to another's start, from these ends alone."""
    length = float(np.hypot(*(after.centre[0] - before.centre[-1])))
    at = np.linspace(0.0, 1.0, int(np.clip(length, 8, 64)) + 1)[:, None]
    ends = zip(before[:3], after[:3], strict=True)
    left, right, centre = (_curve(first, last, at) for first, last in ends)
    return LaneShape(left, right, centre)


def _curve(before: Points, after: Points, at: NDArray[float64]) -> Points:
    """A cubic Hermite curve from the end of one line to the start of another.

    ``at``: the positions on it, as fractions.
    """
    start, end = before[-1], after[0]
    length = max(float(np.hypot(*(end - start))), _CLOSEST_M)
    first, last = (_heading(line) * length for line in (before[-2:], after[:2]))
    curve: Points = (
        (2 * at**3 - 3 * at**2 + 1) * start
        + (at**3 - 2 * at**2 + at) * first
        + (3 * at**2 - 2 * at**3) * end
        + (at**3 - at**2) * last
    )
    return curve


def _heading(pair: Points) -> NDArray[float64]:
    step = pair[1] - pair[0]
    direction: NDArray[float64] = step / max(float(np.hypot(*step)), 1e-9)
    return direction

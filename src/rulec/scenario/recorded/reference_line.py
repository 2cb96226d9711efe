"""Frenet coordinates: arc length ``s`` along a reference line, offset ``d``.

A place's foot is where the perpendicular of the line leads through the place. On a line of straight
pieces that leaves gaps on the outside of every bend and overlaps on the inside; so the direction is
interpolated along each piece between the directions at its ends (Bender, Ziegler, Stiller,
"Lanelets: Efficient map representation for autonomous driving", IV 2014), and ``s`` and ``d`` vary
without jumps. Pieces are 5 m long at most, so that a bend has no effect farther away than that.
Beyond its ends the line continues straight.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.polylines import (
    Angle,
    arc_lengths,
    densified,
    interpolated,
    without_repeats,
    wrapped,
)
from rulec.recordings.recording import Points
from rulec.trace.plain_arrays import ranges

BEYOND_M = 2000.0
"""How far (m) the line continues straight beyond its ends."""

_BESIDE_M = 15.0
"""A place this near (m) to the line itself is not assigned to the line's straight extensions.

The real road beyond the ends is unknown, and the straight extension may pass the line's own other
parts after a bend or two.
"""

_CLOSEST_M = 0.05
_BACK_M = 1.0
_PIECE_M = 5.0
_SMOOTH_M = 5.0
_STEP_M = 0.5
_TURN_RAD = np.radians(5.0)
_HAIR = 1e-9
_MARGIN_M = 1e-5

_AT_ONCE = 1 << 16
"""Pairs of places and pieces that are looked at together, so that they stay in the cache."""

_AROUND = 1.02
"""An area around a line is so much wider, as its arcs are made of chords."""


@dataclass(frozen=True, kw_only=True)
class ReferenceLine:
    """A line of straight pieces: arc length, start, direction and length of each.

    ``first`` and ``change``: the slope of the interpolated direction at a piece's beginning,
    relative to the piece, and by how much the slope changes up to its end.
    """

    arc: Floats
    start: Points
    ahead: Points
    lengths: Floats
    first: Floats
    change: Floats

    @property
    def length(self) -> float:
        """The length (m) from the first corner to the last, without the extensions."""
        return float(self.arc[-1])

    def headings_at(self, s: Floats) -> Floats:
        """The directions (rad) of the pieces at places."""
        return self._headings[self._piece(s)]

    @cached_property
    def _headings(self) -> Floats:
        headings: Floats = np.arctan2(self.ahead[:, 1], self.ahead[:, 0])
        return headings

    def directions_at(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """The directions (rad) of the pieces at places, with their cosines and sines."""
        pieces = self._piece(s)
        headings, cosines, sines = (values.take(pieces) for values in self._directions)
        return headings, cosines, sines

    @cached_property
    def _directions(self) -> tuple[Floats, Floats, Floats]:
        return self._headings, np.cos(self._headings), np.sin(self._headings)

    def heading_at(self, s: float) -> float:
        """The direction (rad) of the piece at ``s``."""
        return float(self.headings_at(np.array([s]))[0])

    def coordinates(self, places: Points) -> Points:
        """Frenet coordinates ``s`` and ``d`` of places, one row each; NaN without a foot."""
        coordinates = np.empty((len(places), 2))
        (first_normals, first_at), (last_normals, last_at) = self._ends
        for part in _blocks(len(places), len(self.arc)):
            away = places[part] - self.start[0]
            may_be = away @ first_normals.T >= first_at - _MARGIN_M
            may_be &= away @ last_normals.T <= last_at + _MARGIN_M
            coordinates[part] = self._nearest(places[part], *may_be.nonzero())
        return coordinates

    def coordinates_near(
        self, places: Points, around: Floats, reach: Floats, counts: NDArray[intp] | int = 1
    ) -> Points:
        """Frenet coordinates of places, with feet within ``reach`` of ``around`` (``s``).

        ``counts``: to how many places, one after the other, each ``around`` and ``reach`` applies.
        """
        low, high = (self._piece(s).repeat(counts) for s in (around - reach, around + reach))
        widths, coordinates = high - low + 1, np.empty((len(places), 2))
        for part in _blocks(len(places), int(widths.max(initial=1))):
            own, pieces = np.arange(len(widths[part])), ranges(low[part], widths[part])[0]
            coordinates[part] = self._nearest(places[part], own.repeat(widths[part]), pieces)
        return coordinates

    def surroundings(self, near_m: float, beyond_m: float) -> shapely.Polygon:
        """An area with all places within ``near_m`` of the line, up to ``beyond_m`` off its ends.

        It is prepared, and hardly larger than needed.
        """
        at = np.concatenate(([-beyond_m], self.arc[1:], [self.length + beyond_m]))
        pieces = self._piece(at)
        corners = self.start[pieces] + (at - self.arc[pieces])[:, None] * self.ahead[pieces]
        area = shapely.LineString(corners).buffer(near_m * _AROUND)
        shapely.prepare(area)
        return area

    def _piece(self, s: Floats) -> NDArray[intp]:
        return np.maximum(self.arc.searchsorted(s, "right") - 1, 0)

    @cached_property
    def _columns(self) -> Floats:
        """A column for each piece; the last row is how much farther (m) it is taken to be."""
        more = np.zeros(len(self.arc))
        more[[0, -1]] = _BESIDE_M
        own = self.lengths, self.first, self.change, self.arc, more
        return np.stack((*self.ahead.T, *self.start.T, *own))

    @cached_property
    def _ends(self) -> tuple[tuple[Points, Floats], ...]:
        """The lines through both ends of each piece between which a foot on it may be.

        As unit normals (a row for each piece), and how far (m) the lines are along them.
        """
        left = np.stack((-self.ahead[:, 1], self.ahead[:, 0]), axis=1)
        last = self.start + self.lengths[:, None] * self.ahead
        found = []
        for corners, slopes in ((self.start, self.first), (last, self.first + self.change)):
            normals = (self.ahead + slopes[:, None] * left) / np.hypot(1.0, slopes)[:, None]
            found.append((normals, ((corners - self.start[0]) * normals).sum(axis=1)))
        return tuple(found)

    def _nearest(self, places: Points, own: NDArray[intp], pieces: NDArray[intp]) -> Points:
        """The coordinates of each place's nearest foot; ``own`` (ascending) with ``pieces``."""
        ux, uy, x, y, lengths, first, change, arc, more = self._columns.take(pieces, axis=1)
        dx, dy = places[own, 0] - x, places[own, 1] - y
        along, across = dx * ux + dy * uy, ux * dy - uy * dx
        turned_lengths = lengths - across * change
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (along + across * first) / turned_lengths
        foot = part * lengths
        distance = np.sqrt(np.square(along - foot) + np.square(across))
        is_foot = (turned_lengths > 0) & (part >= -_HAIR) & (part <= 1 + _HAIR)
        away = np.where(is_foot, distance + more, np.inf)
        begins = np.diff(own, prepend=-1).nonzero()[0]
        least = np.minimum.reduceat(away, begins).repeat(np.diff(begins, append=len(own)))
        nearest = ((away == least) & is_foot).nonzero()[0]
        best = nearest[np.diff(own[nearest], prepend=-1).nonzero()[0]]
        coordinates = np.full((len(places), 2), np.nan)
        coordinates[own[best], 0] = (arc + foot)[best]
        coordinates[own[best], 1] = np.copysign(distance, across)[best]
        return coordinates


def _blocks(count: int, width: int) -> Iterator[slice]:
    """Slices of places with up to ``width`` pieces each."""
    size = max(_AT_ONCE // width, 1)
    return (slice(begin, begin + size) for begin in range(0, count, size))


def reference_line(corners: Points) -> ReferenceLine:
    """The line through corners, leaving out those too close together.

    Raises ValueError if all of them are in one place.
    """
    kept = without_repeats(corners, _CLOSEST_M)
    if len(kept) == 1:
        raise ValueError("all points of its lane's centre line are in one place")
    points = densified(kept, _PIECE_M)
    start, end = points[1] - points[0], points[-1] - points[-2]
    extended = np.concatenate(
        (
            [points[0] - start / np.hypot(*start) * BEYOND_M],
            points,
            [points[-1] + end / np.hypot(*end) * BEYOND_M],
        )
    )
    steps = np.diff(extended, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    halves = turn(angles[:-1], angles[1:]) / 2
    first, last = np.tan(np.append(0.0, -halves)), np.tan(np.append(halves, 0.0))
    arc = np.concatenate(([0.0], lengths.cumsum()[:-1])) - BEYOND_M
    return ReferenceLine(
        arc=arc,
        start=extended[:-1],
        ahead=steps / lengths[:, None],
        lengths=lengths,
        first=first,
        change=last - first,
    )


def leading_on(corners: Points) -> Points:
    """Drop the corners at which a line turns back for less than 1 m, as where maps overlap.

    A place beside such a corner would be as far along the line as the line's end.
    """
    kept = without_repeats(corners, _CLOSEST_M)
    steps = np.diff(kept, axis=0)
    leads_back = (steps[1:] * steps[:-1]).sum(axis=1) < 0.0
    leads_back &= np.minimum(np.hypot(*steps[1:].T), np.hypot(*steps[:-1].T)) < _BACK_M
    found: Points = kept[np.concatenate(([True], ~leads_back, [True]))]
    return found


def smoothed(corners: Points) -> Points:
    """A centre line without the small zigzags that it has where lanelets meet.

    Some lanes away from it, a vehicle that drives straight on would otherwise jump along the line
    there. Each place becomes the mean of the 10 m around it; the amount by which that flattens
    curves is estimated in the same way and added again (twicing: Tukey, "Exploratory data
    analysis", 1977). The ends do not move.
    """
    kept = densified(without_repeats(corners, _CLOSEST_M), _STEP_M)
    arc = arc_lengths(kept)
    count = max(2, round(float(arc[-1]) / _STEP_M) + 1)
    at = np.linspace(0.0, arc[-1], count)
    points = interpolated(at, arc, kept)
    means = _means(points)
    line: Points = 2 * means - _means(means)
    return line[_bends(line)]


def _means(points: Points) -> Points:
    """The moving mean of points, over fewer points near the ends."""
    sums = np.concatenate((np.zeros((1, 2)), points.cumsum(axis=0)))
    own = np.arange(len(points))
    reach = np.minimum(np.minimum(own, own[::-1]), round(_SMOOTH_M / _STEP_M))
    means: Points = (sums[own + reach + 1] - sums[own - reach]) / (2 * reach + 1)[:, None]
    return means


def _bends(points: Points) -> NDArray[intp]:
    """The numbers of the points to keep: one every 5 m, and more where the line bends."""
    steps = np.diff(points, axis=0)
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    turned = np.concatenate(([0.0], np.abs(turn(angles[:-1], angles[1:]))))
    share = np.hypot(*steps.T) / _PIECE_M + turned / _TURN_RAD
    reached = np.concatenate(([0.0], share.cumsum()))
    wanted = np.linspace(0.0, reached[-1], int(np.ceil(reached[-1])) + 1)
    numbers: NDArray[intp] = np.unique(reached.searchsorted(wanted).clip(0, len(points) - 1))
    return numbers


def turn(before: Angle, after: Angle) -> Angle:
    """The signed difference (rad) between two angles, the short way round."""
    return wrapped(after - before)


def pieces_at(borders: Floats, s: Floats) -> NDArray[intp]:
    """The index of the piece between ascending borders at each place; beyond, the nearest."""
    pieces = borders.searchsorted(np.where(np.isnan(s), 0.0, s), "right") - 1
    return np.minimum(np.maximum(pieces, 0), len(borders) - 2)

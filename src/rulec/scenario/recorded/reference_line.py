"""Frenet coordinates: arc length ``s`` along a reference line, offset ``d``.

A place's foot is where the perpendicular of the line leads through the place. On a line of straight
pieces that leaves gaps on the outside of every bend and overlaps on the inside; so the direction is
interpolated along each piece between the directions at its ends (Bender, Ziegler, Stiller,
"Lanelets: Efficient map representation for autonomous driving", IV 2014), and ``s`` and ``d`` vary
without jumps. Pieces are 5 m long at most, so that a bend has no effect farther away than that.
Beyond its ends the line continues straight.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
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
from rulec.scenario.recorded.line_fans import LineFans, line_fans
from rulec.scenario.recorded.line_surroundings import LineSurroundings, line_surroundings
from rulec.scenario.recorded.sure_feet import MANY, PieceFans, sure_feet
from rulec.trace.plain_arrays import distinct

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
        coordinates, pieces = sure_feet(self.piece_fans, places)
        left = (pieces < 0).nonzero()[0]
        low = np.zeros(len(left), dtype=intp)
        coordinates[left] = self._nearest(places[left], low, low + len(self.arc) - 1)
        return coordinates

    def coordinates_near(
        self, places: Points, around: Floats, reach: Floats, counts: NDArray[intp] | int = 1
    ) -> Points:
        """Frenet coordinates of places, with feet within ``reach`` of ``around`` (``s``).

        ``counts``: to how many places, one after the other, each ``around`` and ``reach`` applies.
        """
        low, high = (self._piece(s).repeat(counts) for s in (around - reach, around + reach))
        if len(places) < MANY:
            return self._nearest(places, low, high)
        coordinates, pieces = sure_feet(self.piece_fans, places)
        left = ((pieces < low) | (pieces > high)).nonzero()[0]
        coordinates[left] = self._nearest(places[left], low[left], high[left])
        return coordinates

    def surroundings(self, near_m: float, beyond_m: float) -> LineSurroundings:
        """A filter for places within ``near_m`` of the line, up to ``beyond_m`` beyond its ends."""
        at = np.concatenate(([-beyond_m], self.arc[1:], [self.length + beyond_m]))
        pieces = self._piece(at)
        return line_surroundings(
            self.start[pieces] + (at - self.arc[pieces])[:, None] * self.ahead[pieces], near_m
        )

    def _piece(self, s: Floats) -> NDArray[intp]:
        return self.piece_fans.at(s)

    @cached_property
    def _fans(self) -> LineFans:
        slopes = np.stack((self.first, self.first + self.change), axis=1)
        return line_fans(self.start, self.ahead, self.lengths, slopes)

    @cached_property
    def piece_fans(self) -> PieceFans:
        """The pieces in the form that ``sure_feet`` needs."""
        own = self.lengths, self.first, self.change, self.arc
        return PieceFans(np.stack((*self.ahead.T, *self.start.T, *own)))

    def _nearest(self, places: Points, low: NDArray[intp], high: NDArray[intp]) -> Points:
        """The coordinates of each place's nearest foot on the pieces from ``low`` to ``high``."""
        if not len(places):
            return np.empty((0, 2))
        numbers, pieces = self._fans.candidates(places, low, high)
        ux, uy, x, y, lengths, first, change, arc = self.piece_fans.columns.take(pieces, axis=1)
        dx, dy = places[numbers, 0] - x, places[numbers, 1] - y
        along = dx * ux + dy * uy
        across = ux * dy - uy * dx
        turned_lengths = lengths - across * change
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (along + across * first) / turned_lengths
        good = (turned_lengths > 0) & (part >= -_HAIR) & (part <= 1 + _HAIR)
        at = good.nonzero()[0]
        numbers, own, foot, across = numbers[at], pieces[at], part[at] * lengths[at], across[at]
        # The same formula as in sure_feet, for bit-identical results
        distance = np.sqrt(np.square(along[at] - foot) + np.square(across))
        away = distance + np.where((own == 0) | (own == len(self.arc) - 1), _BESIDE_M, 0.0)
        best = _least_of_each(numbers, away)
        coordinates = np.full((len(places), 2), np.nan)
        coordinates[numbers[best], 0] = arc[at[best]] + foot[best]
        coordinates[numbers[best], 1] = np.copysign(distance[best], across[best])
        return coordinates


def _least_of_each(groups: NDArray[intp], values: Floats) -> NDArray[intp]:
    """The index of the first least value in each group; the values of a group are consecutive."""
    if not len(groups):
        return groups
    begins = np.concatenate(([True], groups[1:] != groups[:-1]))
    if begins.all():
        return np.arange(len(groups))
    least = np.minimum.reduceat(values, begins.nonzero()[0])[begins.cumsum() - 1]
    at: NDArray[intp] = (values == least).nonzero()[0]
    return at[np.concatenate(([True], groups[at[1:]] != groups[at[:-1]]))]


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
    numbers: NDArray[intp] = distinct(reached.searchsorted(wanted).clip(0, len(points) - 1))
    return numbers


def turn(before: Angle, after: Angle) -> Angle:
    """The signed difference (rad) between two angles, the short way round."""
    return wrapped(after - before)


def pieces_at(borders: Floats, s: Floats) -> NDArray[intp]:
    """The index of the piece between ascending borders at each place; beyond, the nearest."""
    pieces = borders.searchsorted(np.where(np.isnan(s), 0.0, s), "right") - 1
    return np.minimum(np.maximum(pieces, 0), len(borders) - 2)

"""The lanes of ego's road, and coordinates between their straightened bounds.

Recorded lanes widen, narrow, begin and end, but a scenario's road has lanes of constant width. So a
place's offset is scaled between the bounds of its lane: the middle of a lane stays the middle, and
a car that keeps within its lane does so in the scenario too. Each lane has the width that it has at
ego's place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from operator import itemgetter

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.polylines import densified, densified_lines
from rulec.recordings.recording import Lanelet, Points, Recording
from rulec.scenario.recorded.joined_outlines import JoinedOutlines
from rulec.scenario.recorded.reference_line import ReferenceLine, pieces_at
from rulec.scenario.recorded.route import lanelet_length, lanes_beside

NARROWEST_LANE_M = 1.0
"""Where a lane is narrower than this (m), it has not begun yet or has ended."""

TOUCHING_M = 0.3
"""A body is not in a lane that it enters by less (m): recorded positions are no more precise."""

_WIDEST_M = 20.0
"""The greatest distance (m) along a road between two edges of one pedestrian crossing."""

_NARROWEST_M = 0.1
_BESIDE_LINE_M = 0.5
_EDGE_EVERY_M = 0.5
_EVERY_M = 1.0
_MARGIN_M = 5.0
_FAR_M = 50.0
_ABOUT_M = 20.0
_HAIR_M = 0.01
_AT_ONCE = 1 << 11
"""Outlines processed per batch, so that intermediate arrays stay in the processor's cache."""

_Beside = Sequence["Lanelet | None"]


@dataclass(frozen=True, eq=False)
class Lanes:
    """Bounds of lanes from right to left along the road.

    ``bounds[i]`` are the offsets of the bounds at ``s[i]``, ``straight`` those in the scenario.
    ``there[i][k]``: whether lane k (from 0) exists between ``s[i]`` and ``s[i + 1]``.
    """

    s: Floats
    bounds: Floats
    straight: Floats
    there: NDArray[np.bool_]

    def straightened(self, places: Points) -> Points:
        """The scenario's ``d`` of places (rows ``s``, ``d``), as one column."""
        left_of = self.from_bounds(places)
        lane = np.clip((left_of >= 0).sum(axis=1) - 1, 0, left_of.shape[1] - 2)
        row = np.arange(len(places))
        from_right, from_left = left_of[row, lane], left_of[row, lane + 1]
        low, high = self.straight[lane], self.straight[lane + 1]
        stretched = low + from_right * (high - low) / (from_right - from_left)
        beyond = np.where(from_right < 0, low + from_right, high + from_left)
        inside = (from_right >= 0) & (from_left <= 0)
        return np.column_stack((np.where(inside, stretched, beyond),))

    def from_bounds(self, places: Points) -> Points:
        """How far (m) each place (row) is to the left of each bound (column)."""
        at, off = places.T
        return np.column_stack([off - np.interp(at, self.s, bound) for bound in self.bounds.T])

    def existing_at(self, s: Floats) -> NDArray[np.bool_]:
        """Mask of the lanes (last axis, from the right) that exist at places."""
        return self.there[self.pieces_at(s)]

    def pieces_at(self, s: Floats) -> NDArray[intp]:
        """The index of the interval of ``self.s`` at each place; the nearest beyond the ends."""
        return pieces_at(self.s, s)

    def missing(
        self, start: float, end: float, shift: float
    ) -> tuple[tuple[int, tuple[float, float]], ...]:
        """The lanes that are missing from ``start`` to ``end``, and where.

        ``shift`` is subtracted from ``s``.
        """
        missing = []
        for lane, column in enumerate(self.there.T, 1):
            pieces = zip(column.tolist(), pairwise(self.s.tolist()), strict=True)
            for there, group in groupby(pieces, key=itemgetter(0)):
                run = [piece for _, piece in group]
                low, high = max(run[0][0], start), min(run[-1][1], end)
                if not there and high - low > _HAIR_M:
                    missing.append((lane, (low - shift, high - shift)))
        return tuple(missing)


def lanes_along(
    recording: Recording,
    way: Sequence[str],
    line: ReferenceLine,
    ego_s: float,
    numbers: Sequence[int] | None = None,
    *,
    borders: Floats | None = None,
) -> Lanes:
    """The lanes of the road along a route: the route's own and those beside it in its direction.

    ``numbers``: the lane number of each lanelet of the route, from any first number on; without
    them the route is one lane. ``borders`` are those of ``borders_along``, if already known. Raises
    ValueError if no lane is as wide as ``NARROWEST_LANE_M``.
    """
    lanelets = [recording.lanelets[number] for number in way]
    borders = borders_along(lanelets, line) if borders is None else borders
    grid = np.unique(np.concatenate([np.arange(0.0, line.length, _EVERY_M), borders]))
    grid = grid[np.concatenate(([True], np.diff(grid) > _HAIR_M))]
    own_number = np.zeros(len(way), dtype=int) if numbers is None else np.array(numbers)
    strip = _Strip(recording, lanelets, line, borders, grid, own_number=own_number)
    beside = {left: _beside(strip, left=left) for left in (False, True)}
    right, left, *outer = _bounds(
        strip,
        [(lanelets, False), (lanelets, True)]
        + [(lane, left) for left, lanes in beside.items() for lane in lanes],
    )
    bounds_of = iter(outer)
    on_the_right = _side(strip, right, [(x, next(bounds_of)) for x in beside[False]], left=False)
    on_the_left = _side(strip, left, [(x, next(bounds_of)) for x in beside[True]], left=True)
    own = np.maximum(left - right, _HAIR_M), np.ones(len(lanelets), dtype=bool)
    columns = list(_by_number(strip, [*reversed(on_the_right), own, *on_the_left]))
    middles = pieces_at(borders, (grid[:-1] + grid[1:]) / 2)
    there = np.stack(
        [
            present[middles] & (np.minimum(width[:-1], width[1:]) >= NARROWEST_LANE_M)
            for width, present in columns
        ],
        axis=1,
    )
    existing = there.any(axis=0).nonzero()[0]
    if not len(existing):
        raise ValueError(f"no lane of the road is as wide as {NARROWEST_LANE_M:g} m")
    kept = slice(existing[0], existing[-1] + 1)
    widths = np.stack([width for width, _ in columns], axis=1)
    # The number of columns right of the route's own lanelet, at each place
    before = own_number[pieces_at(borders, grid)] - own_number.min() + len(on_the_right)
    first = right - np.where(np.arange(len(columns)) < before[:, None], widths, 0.0).sum(axis=1)
    bounds = np.column_stack((first, widths)).cumsum(axis=1)
    usual = _usual_widths(grid, widths, there, ego_s)
    straight = np.cumsum((0.0, *usual))
    at = pieces_at(grid, np.array(ego_s))
    straight += float(np.interp(ego_s, grid, right)) - straight[before[at]]
    bounded = slice(kept.start, kept.stop + 1)
    return Lanes(grid, bounds[:, bounded], straight[bounded], there[:, kept])


@dataclass(frozen=True, slots=True)
class _Strip:
    """Data shared by all lanes: route, lanelet borders along it, sample places, lane numbers."""

    recording: Recording
    way: Sequence[Lanelet]
    line: ReferenceLine
    borders: Floats
    grid: Floats
    own_number: NDArray[np.int_]


def borders_along(lanelets: Sequence[Lanelet], line: ReferenceLine) -> Floats:
    """The places along the line (m) at which the lanelets begin, and where the last one ends."""
    ends = np.array([lanelets[0].centre[0], *(lanelet.centre[-1] for lanelet in lanelets)])
    # A line that passes a place twice has several feet there, so search near the expected one
    about = np.cumsum([0.0, *map(lanelet_length, lanelets)])
    about *= line.length / about[-1] if about[-1] else 0.0
    places = line.coordinates_near(ends, about, np.full(len(ends), _ABOUT_M))[:, 0]
    places = np.where(np.isnan(places), about, places)
    borders: Floats = np.maximum.accumulate(np.clip(places, 0.0, line.length))
    borders[-1] = line.length
    return borders


def _usual_widths(
    grid: Floats, widths: Floats, there: NDArray[np.bool_], ego_s: float
) -> Iterator[float]:
    at = pieces_at(grid, np.array(ego_s))
    for width, own in zip(widths.T, there.T, strict=True):
        if own[at]:
            yield float(np.interp(ego_s, grid, width))
        else:
            yield float(np.median(width[:-1][own])) if own.any() else NARROWEST_LANE_M


def _by_number(
    strip: _Strip, by_rank: Sequence[tuple[Floats, NDArray[np.bool_]]]
) -> Iterator[tuple[Floats, NDArray[np.bool_]]]:
    """Widths and presence by lane, from those by rank beside the route's own lanelet."""
    # Rank 0 is the rightmost; if the route is one lane, ranks are lane numbers
    own = strip.own_number - strip.own_number.min()
    at = own[pieces_at(strip.borders, strip.grid)]
    for number in range(len(by_rank) + int(own.max())):
        width, present = np.full(len(strip.grid), np.nan), np.zeros(len(own), dtype=bool)
        for rank, (own_width, own_present) in enumerate(by_rank):
            width = np.where(at + rank == number, own_width, width)
            present = np.where(own + rank == number, own_present, present)
        known = ~np.isnan(width)
        if known.any():
            yield np.interp(strip.grid, strip.grid[known], width[known]), present
        else:
            yield np.full(len(width), _HAIR_M), present


def _side(
    strip: _Strip, inner: Floats, lanes: Iterable[tuple[_Beside, Floats]], *, left: bool
) -> list[tuple[Floats, NDArray[np.bool_]]]:
    """Widths and presence of the lanes on one side, given with their outer bounds."""
    columns = []
    for lanelets, bound in lanes:
        present = np.array([lanelet is not None for lanelet in lanelets])
        known = present[pieces_at(strip.borders, strip.grid)]
        width = np.maximum(bound - inner if left else inner - bound, _HAIR_M)
        if known.any():
            width = np.interp(strip.grid, strip.grid[known], width[known])
        inner = inner + width if left else inner - width
        columns.append((width, present))
    return columns


def _beside(strip: _Strip, *, left: bool) -> list[_Beside]:
    """The lanes on one side of the route, nearest first: per lanelet of it a lanelet or None."""
    rows = [lanes_beside(strip.recording, lanelet.id, left=left) for lanelet in strip.way]
    return [
        [strip.recording.lanelets[row[k]] if len(row) > k else None for row in rows]
        for k in range(max(map(len, rows)))
    ]


def _bounds(strip: _Strip, lanes: Sequence[tuple[_Beside, bool]]) -> list[Floats]:
    """The offsets of lanes' bounds on the grid: left where the flag is true, else right."""
    bounds_of = [
        [(k, lanelet.left if left else lanelet.right) for k, lanelet in enumerate(lane) if lanelet]
        for lane, left in lanes
    ]
    numbers, bounds = zip(*(own for lane in bounds_of for own in lane), strict=True)
    points, counts = densified_lines(bounds, _EVERY_M)
    # Project all places in one call, each near its lanelet's stretch
    piece = np.repeat(numbers, counts)
    start, end = strip.borders[piece], strip.borders[piece + 1]
    places = strip.line.coordinates_near(points, (start + end) / 2, (end - start) / 2 + _FAR_M)
    # Where the route changes lanes, bounds do not continue
    same = np.concatenate(([True], np.diff(strip.own_number) == 0, [True]))
    low, high = (np.where(goes_on, _MARGIN_M, 0.0) for goes_on in (same[piece], same[piece + 1]))
    kept = (places[:, 0] >= start - low) & (places[:, 0] <= end + high)
    ends = np.cumsum([0, *counts])[np.cumsum([0, *map(len, bounds_of)])].tolist()
    offsets = []
    for begins, stops in pairwise(ends):
        own = places[begins:stops][kept[begins:stops]]
        if not len(own):
            raise ValueError("a lane's bounds are nowhere beside its centre line")
        own = own[own[:, 0].argsort(kind="stable")]
        offsets.append(np.interp(strip.grid, own[:, 0], own[:, 1]))
    return offsets


def outline_bounds(
    outlines: JoinedOutlines,
    line: ReferenceLine,
    across: Callable[[Points], Points],
    expected: tuple[Floats, Floats] | None = None,
) -> tuple[Floats, Floats]:
    """The least and the greatest coordinates of each outline, one row each; at least one is needed.

    Columns: ``s``, ``d`` (m from the line), and what ``across`` computes from these two. NaN for
    outlines that are not beside the line. Corners are projected near the foot of the outline's
    middle, so that no body is torn apart where a road meets itself. ``expected``: for each outline
    the approximate ``s`` of its middle's foot, and how far from there the foot may be.
    """
    middles = (
        line.coordinates_near(outlines.middles, *expected)
        if expected
        else line.coordinates(outlines.middles)
    )
    parts = []
    for first in range(0, len(middles), _AT_ONCE):
        own = slice(first, first + _AT_ONCE)
        part, around = outlines.part(own), middles[own, 0]
        feet = line.coordinates_near(part.corners, around, outlines.reach[own], part.counts)
        feet[np.isnan(around).repeat(part.counts)] = np.nan
        parts.append(part.least_and_greatest(np.concatenate((feet.T, across(feet).T))))
    least, greatest = (np.concatenate(bounds) for bounds in zip(*parts, strict=True))
    return least, greatest


def kept_off_touched(low: Floats, high: Floats, straight: Floats) -> tuple[Floats, Floats]:
    """Extents across the lanes, cut off at the bound of a lane that they merely touch.

    A narrow body, such as a pedestrian's, is in the lane that contains more than half of it.
    """
    enough = np.minimum(TOUCHING_M, (high - low) / 2)
    first, last = pieces_at(straight, low), pieces_at(straight, high)
    left_of_first, right_of_last = straight[first + 1], straight[last]
    into_first, into_last = left_of_first - low, high - right_of_last
    touches_right = (into_first > 0) & (into_first <= enough)
    touches_left = (into_last > 0) & (into_last <= enough)
    kept = np.where(touches_right, left_of_first, low), np.where(touches_left, right_of_last, high)
    apart = kept[0] < kept[1]
    return np.where(apart, kept[0], low), np.where(apart, kept[1], high)


def crossings_along(
    recording: Recording,
    line: ReferenceLine,
    lanes: Lanes,
    start: float,
    end: float,
    *,
    meets_itself: bool = False,
) -> Iterator[tuple[float, float]]:
    """The stretches (``s``) that crosswalks cover on the lanes, within ``start`` and ``end``.

    A crosswalk has to lie across the line; one beside it belongs to another road, onto which a lane
    turns off. A road that turns round and comes back beside itself may meet one twice, far apart;
    one that ``meets_itself``, as on a ring, meets it on every round.
    """
    for lanelet in recording.lanelets.values():
        if "crosswalk" not in lanelet.types:
            continue
        outline = np.concatenate((lanelet.right, lanelet.left[::-1], lanelet.right[:1]))
        edge = densified(outline, _EDGE_EVERY_M)
        places = _on_every_round(line, edge) if meets_itself else line.coordinates(edge)
        left_of = lanes.from_bounds(places)
        on_road = np.sort(places[(left_of[:, 0] > 0) & (left_of[:, -1] < 0), 0])
        again = (np.diff(on_road) > _WIDEST_M).nonzero()[0] + 1
        for met in np.split(on_road, again) if len(on_road) else ():
            near = (places[:, 0] > met[0] - _WIDEST_M) & (places[:, 0] < met[-1] + _WIDEST_M)
            aside = places[near, 1]
            across = aside.min() < _BESIDE_LINE_M and aside.max() > -_BESIDE_LINE_M
            low, high = max(float(met[0]), start), min(float(met[-1]), end)
            if across and high - low >= _NARROWEST_M:
                yield low, high


def _on_every_round(line: ReferenceLine, places: Points) -> Points:
    """Frenet coordinates of places with their feet on each stretch of a line that has some."""
    middles = np.arange(_ABOUT_M / 2, line.length + _ABOUT_M, _ABOUT_M)
    around, reach = middles.repeat(len(places)), np.full(len(middles) * len(places), _ABOUT_M / 2)
    every = line.coordinates_near(np.tile(places, (len(middles), 1)), around, reach)
    return every[~np.isnan(every[:, 0])]

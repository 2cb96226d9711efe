"""The lanelets that vehicles may be on, state by state, and how well each explains them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import pi, radians

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.recording import Points
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_at

NEAR_M = 3.0
"""The greatest distance (m) of a vehicle from a lanelet that it is matched to."""

_AROUND_M = NEAR_M + 0.1
"""Places farther (m) than this from the rectangle around a lanelet are not near it."""

_HAIR_RAD, _HAIR_M = 1e-6, 1e-6
_FEW_CORNERS = 6

SIGMA_M = 1.0
SIGMA_RAD = radians(20)
"""Standard deviations of vehicles from the middle and the direction of their lanelet."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LaneCandidates:
    """The lanelets that states may be on.

    States are ordered by participant (``rows``), then time (``columns``). State k has the
    candidates from ``first[k]`` to before ``first[k + 1]``, in the order of the file. Each has its
    index in ``names``, its ``costs`` of distance and angle, and the place ``along`` it (m).
    """

    names: tuple[str, ...]
    rows: NDArray[intp]
    columns: NDArray[intp]
    first: NDArray[intp]
    lanes: NDArray[intp]
    costs: Floats
    along: Floats

    @cached_property
    def counts(self) -> NDArray[intp]:
        """The number of candidates of each state, at least one."""
        return self.first[1:] - self.first[:-1]


_NO_NUMBERS, _NO_VALUES = np.empty(0, dtype=intp), np.empty(0)
_NONE = LaneCandidates(
    names=(),
    rows=_NO_NUMBERS,
    columns=_NO_NUMBERS,
    first=np.zeros(1, dtype=intp),
    lanes=_NO_NUMBERS,
    costs=_NO_VALUES,
    along=_NO_VALUES,
)


def candidates(graph: LaneletGraph, tracks: Tracks) -> LaneCandidates:
    """The lanelets near each moving participant that lead its way."""
    lanes = graph.lanes
    moving = np.array([not body.standing for body in tracks.participants], dtype=bool)
    rows, columns = (tracks.present & moving[:, None]).nonzero()
    if not lanes or not len(rows):
        return _NONE
    x, y, headings = (values[rows, columns] for values in (tracks.x, tracks.y, tracks.heading))
    bounds = graph.bounds + np.array([-1.0, -1.0, 1.0, 1.0]) * _AROUND_M
    near: dict[int, NDArray[intp]] = {}
    for number in _around(bounds, x, y).tolist():
        left, low, right, high = bounds[number].tolist()
        own = ((x >= left) & (x <= right) & (y >= low) & (y <= high)).nonzero()[0]
        if len(own):
            own = own[leading_on(lanes[number].centre, headings[own])]
            own = own[graph.strip(number).near(x[own], y[own], NEAR_M)]
        if len(own):
            near[number] = own
    if not near:
        return _NONE
    at, numbers = np.concatenate(list(near.values())), _numbers(near.items())
    feet = [(lanes[k].centre, np.array((x[own], y[own])).T) for k, own in near.items()]
    along, away = feet_on(feet)
    bounds_of = np.cumsum([0, *map(len, near.values())]).tolist()
    directions = [
        directions_at(lanes[k], along[start:end])
        for k, (start, end) in zip(near, pairwise(bounds_of), strict=True)
    ]
    angle = np.abs(turn(np.concatenate(directions), headings[at]))
    fits = angle < pi / 2
    at, numbers, along = at[fits], numbers[fits], along[fits]
    costs = ((away[fits] / SIGMA_M) ** 2 + (angle[fits] / SIGMA_RAD) ** 2) / 2
    # By place, lanelets in the order of the file
    order = at.argsort(kind="stable")
    at = at[order]
    first = np.append(np.unique(at, return_index=True)[1], len(at))
    states = at[first[:-1]]
    names = tuple(lanelet.id for lanelet in lanes)
    return LaneCandidates(
        names=names,
        rows=rows[states],
        columns=columns[states],
        first=first,
        lanes=numbers[order],
        costs=costs[order],
        along=along[order],
    )


def _around(bounds: Floats, x: Floats, y: Floats) -> NDArray[intp]:
    """The numbers of the rectangles that meet the one around the places (at least one)."""
    left, low, right, high = bounds.T
    meets: Flags = (left <= x.max()) & (right >= x.min()) & (low <= y.max()) & (high >= y.min())
    return meets.nonzero()[0]


def leading_on(line: Points, headings: Floats) -> Flags:
    """Mask of headings (rad), including all less than a right angle off some part of a line."""
    steps = line[1:] - line[:-1]
    directions = np.arctan2(steps[:, 1], steps[:, 0])
    turned = turn(directions[0], directions)
    least, most = turned.min(), turned.max()
    off = np.abs(turn(directions[0] + (least + most) / 2, headings))
    leading: Flags = off < pi / 2 + (most - least) / 2 + _HAIR_RAD
    return leading


def _numbers(groups: Iterable[tuple[int, NDArray[intp]]]) -> NDArray[intp]:
    """The number of each group, repeated once per member."""
    numbers, members = zip(*groups, strict=True)
    return np.array(numbers, dtype=intp).repeat([len(own) for own in members])


def feet_on(lines: Sequence[tuple[Points, Points]]) -> tuple[Floats, Floats]:
    """The distances (m) along a line of its nearest points to places, and the places' from them.

    Each line comes with its places; results are laid end to end. Of equally near points the first
    one counts. Shapely's ``line_locate_point`` and ``distance`` give the same to the last digit,
    but try each piece of a line for each place.
    """
    starts = np.concatenate([line[:-1] for line, _ in lines])
    ends = np.concatenate([line[1:] for line, _ in lines])
    places = np.concatenate([own for _, own in lines])
    ux, uy = (ends - starts).T
    squares = ux * ux + uy * uy
    lengths = np.sqrt(squares)
    first, counts, before, begin = [], [], [], 0
    for line, own in lines:
        end = begin + len(line) - 1
        low, count = _pieces_near(line, own)
        first.append(low + begin)
        counts.append(count)
        before.append(np.concatenate(([0.0], lengths[begin:end].cumsum()[:-1])))
        begin = end
    n_pieces = np.concatenate(counts)
    bounds = n_pieces.cumsum() - n_pieces
    number = np.arange(len(places)).repeat(n_pieces)
    piece = np.arange(len(number)) + (np.concatenate(first) - bounds).repeat(n_pieces)
    x0, y0, ux, uy, square = np.array((*starts.T, ux, uy, squares))[:, piece]
    x, y = places.T[:, number]
    dx, dy = x - x0, y - y0
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (dx * ux + dy * uy) / square
        off = np.abs((dx * uy - dy * ux) / square) * lengths[piece]
    # NaN, from a piece without length, counts as before it
    is_before, is_beyond = ~(part > 0), part >= 1
    off[is_before] = np.sqrt(dx[is_before] ** 2 + dy[is_before] ** 2)
    dx, dy = places.T[:, number[is_beyond]] - ends.T[:, piece[is_beyond]]
    off[is_beyond] = np.sqrt(dx**2 + dy**2)
    least = np.minimum.reduceat(off, bounds)
    best = (off == least.repeat(n_pieces)).nonzero()[0]
    best = best[np.unique(number[best], return_index=True)[1]]
    part, length = part[best], lengths[piece[best]]
    on = np.where(part > 0, np.where(part > 1, length, part * length), 0.0)
    return np.concatenate(before)[piece[best]] + on, least


def _pieces_near(line: Points, places: Points) -> tuple[NDArray[intp], NDArray[intp]]:
    """The first piece of a line that may be nearest to each place, and the number of such pieces.

    Includes pieces that, seen along the chord, come as near as some corner does.
    """
    if len(line) <= _FEW_CORNERS:
        return np.zeros(len(places), dtype=intp), np.full(len(places), len(line) - 1)
    chord = line[-1] - line[0]
    chord = chord / (np.hypot(*chord) or 1.0)
    corners, own = line @ chord, places @ chord
    ends = np.maximum.accumulate(np.maximum(corners[:-1], corners[1:]))
    begins = np.minimum.accumulate(np.minimum(corners[:-1], corners[1:])[::-1])[::-1]
    corner = line[ends.searchsorted(own, "left")]
    reach = np.hypot(*(places - corner).T) + _HAIR_M
    first = ends.searchsorted(own - reach, "left")
    return first, begins.searchsorted(own + reach, "right") - first

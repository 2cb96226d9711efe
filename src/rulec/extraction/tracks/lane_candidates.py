"""The lanelets that vehicles may be on, moment by moment, and how well each explains them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, radians

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.recordings.recording import Lanelet, Recording, is_lane
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_at, lanelet_area

NEAR_M = 3.0
"""The farthest that a vehicle may be beside a lanelet that it is matched to."""

_AROUND_M = NEAR_M + 0.1
"""Who is not even so near to the rectangle around a lanelet is not near it."""

SIGMA_M = 1.0
SIGMA_RAD = radians(20)
"""Standard deviations of vehicles about the middle and the direction of their lanelet."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LaneCandidates:
    """The lanelets that states may be on.

    States by participant (``rows``) and then time (``columns``); state k has those from
    ``first[k]`` to before ``first[k + 1]``, in the order of the file. Each is a number in ``names``
    with the ``costs`` of its distance, and the place ``along`` it (m).
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
        """How many each state has, at least one."""
        return np.diff(self.first)


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


def candidates(recording: Recording, tracks: Tracks) -> LaneCandidates:
    """The lanelets near each moving participant that lead its way."""
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    moving = np.array([not body.standing for body in tracks.participants], dtype=bool)
    rows, columns = np.nonzero(tracks.present & moving[:, None])
    if not lanes or not len(rows):
        return _NONE
    x, y, headings = (values[rows, columns] for values in (tracks.x, tracks.y, tracks.heading))
    points = shapely.points(x, y)
    areas = [lanelet_area(lanelet) for lanelet in lanes]
    bounds = shapely.bounds(areas) + np.array([-1.0, -1.0, 1.0, 1.0]) * _AROUND_M
    found = []
    for lanelet, area, (left, low, right, high) in zip(lanes, areas, bounds.tolist(), strict=True):
        around = np.flatnonzero((x >= left) & (x <= right) & (y >= low) & (y <= high))
        around = around[_beside(lanelet, area, x[around], y[around])]
        shapely.prepare(area)
        near = around[shapely.dwithin(area, points[around], NEAR_M)]
        found.append(_candidates_on(lanelet, near, points[near], headings[near]))
    at, costs, along = (np.concatenate(parts) for parts in zip(*found, strict=True))
    numbers = np.repeat(np.arange(len(lanes)), [len(own) for own, _, _ in found])
    # By place, lanelets in the order of the file
    order = np.argsort(at, kind="stable")
    at = at[order]
    first = np.append(np.flatnonzero(np.diff(at, prepend=-1)), len(at))
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


def _beside(lanelet: Lanelet, area: shapely.Polygon, x: Floats, y: Floats) -> Flags:
    """Flags of places hardly farther to a lanelet's sides than its area; whoever is near is there.

    Of those in the rectangle around one that lies aslant most are not.
    """
    corners = shapely.get_coordinates(area)
    (ux, uy), (x0, y0) = lanelet.centre[-1] - lanelet.centre[0], lanelet.centre[0]
    length = np.hypot(ux, uy)
    if not length:
        return np.ones(len(x), dtype=bool)
    own = ((corners[:, 1] - y0) * ux - (corners[:, 0] - x0) * uy) / length
    away = ((y - y0) * ux - (x - x0) * uy) / length
    beside: Flags = (away >= own.min() - _AROUND_M) & (away <= own.max() + _AROUND_M)
    return beside


def _candidates_on(
    lanelet: Lanelet,
    near: NDArray[intp],
    points: NDArray[np.object_],
    headings: NDArray[np.float64],
) -> tuple[NDArray[intp], Floats, Floats]:
    """Those ``near`` a lanelet that may be on it, their costs, and their places along it (m)."""
    middle = shapely.LineString(lanelet.centre)
    along = shapely.line_locate_point(middle, points)
    angle = np.abs(turn(directions_at(lanelet, along), headings))
    fits = angle < pi / 2
    away = shapely.distance(middle, points[fits])
    costs = ((away / SIGMA_M) ** 2 + (angle[fits] / SIGMA_RAD) ** 2) / 2
    return near[fits], costs, along[fits]

"""The lanelets that vehicles may be on, moment by moment, and how well each explains them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, radians

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Floats, Tracks
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
    places = np.stack((tracks.x[rows, columns], tracks.y[rows, columns]), axis=1)
    points, headings = shapely.points(places), tracks.heading[rows, columns]
    areas = [lanelet_area(lanelet) for lanelet in lanes]
    low, high = np.split(shapely.bounds(areas), 2, axis=1)
    found = []
    for lanelet, area, *corners in zip(
        lanes, areas, low - _AROUND_M, high + _AROUND_M, strict=True
    ):
        around = np.flatnonzero(((places >= corners[0]) & (places <= corners[1])).all(axis=1))
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

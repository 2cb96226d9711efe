"""The lanelets that vehicles may be on, state by state, and how well each explains them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import pi, radians

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.tracks import Tracks
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_at

NEAR_M = 3.0
"""The greatest distance (m) of a vehicle from a lanelet that it is matched to."""

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
    points = shapely.points(x, y)
    tree = shapely.STRtree(points)
    numbers, at = tree.query(graph.areas, predicate="dwithin", distance=NEAR_M)
    if not len(at):
        return _NONE
    centres = np.array([shapely.LineString(lane.centre) for lane in lanes])
    along = shapely.line_locate_point(centres[numbers], points[at])
    own, begins = np.unique(numbers, return_index=True)
    parts = zip(own.tolist(), np.split(along, begins[1:]), strict=True)
    directions = np.concatenate([directions_at(lanes[number], part) for number, part in parts])
    angle = np.abs(turn(directions, headings[at]))
    fits = angle < pi / 2
    at, numbers, along, angle = at[fits], numbers[fits], along[fits], angle[fits]
    away = shapely.distance(centres[numbers], points[at])
    costs = ((away / SIGMA_M) ** 2 + (angle / SIGMA_RAD) ** 2) / 2
    # By place, lanelets in the order of the file
    order = np.lexsort((numbers, at))
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

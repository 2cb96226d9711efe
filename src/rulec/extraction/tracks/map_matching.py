"""Map matching: the lanelets that vehicles drove, by a hidden Markov model.

Newson, Krumm, "Hidden Markov map matching through noise and sparseness" (ACM SIGSPATIAL GIS 2009):
hidden states are the lanelets near a vehicle's middle, and of all paths the likeliest is found by
dynamic programming (Viterbi, "Error bounds for convolutional codes", 1967), so that where lanelets
overlap the whole drive decides. Costs are negative logarithms of likelihoods. *Emission*: normal in
the distance from a lanelet's middle, as there, and in the angle to it. Recorders are a thousand
times denser than their samples, which they thin out to one per two standard deviations; here a
state counts by how far the vehicle has moved, the line integral of Oran and Jaillet, "An HMM-based
map matching method with cumulative proximity-weight formulation" (ICCVE 2013), so that who stands
adds nothing. *Transition*: exponential in the difference of the way along lanelets and the way
moved; to a successor, or with a cost a lane to one beside. Where no path leads on, as when a
recording jumps or somebody leaves a lanelet sideways, the drive breaks for a high cost.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from math import hypot, inf, pi, radians
from typing import NamedTuple

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.tracks import Tracks
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

BETA_M = 2.0
"""The mean difference of the way along lanelets and the way moved."""

CHANGE_COST = 5.0
"""The cost of each lane that is changed."""

BREAK_COST = 50.0
"""The cost of going on where no lanelet leads to."""


class Candidate(NamedTuple):
    """A lanelet that a state may be on: the cost of its distance, and the place along it (m)."""

    cost: float
    along: float


Candidates = Mapping[int, Mapping[str, Candidate]]
"""Column -> lanelet -> candidate, of one participant."""


@dataclass(frozen=True, slots=True)
class MatchedStretch:
    """Consecutive states that one path along the map explains.

    In ``chain`` each lanelet succeeds the one before or lies beside it; ``places`` are the numbers
    of those of the states in ``columns``.
    """

    columns: tuple[int, ...]
    chain: tuple[str, ...]
    places: tuple[int, ...]


class MapMatching:
    """The matched lanelets of all participants that move."""

    def __init__(self, recording: Recording, tracks: Tracks, graph: LaneletGraph) -> None:
        self.recording = recording
        self._tracks = tracks
        self._graph = graph
        self._candidates = candidates(recording, tracks)
        self._found: dict[int, tuple[MatchedStretch, ...]] = {}

    def of(self, row: int) -> tuple[MatchedStretch, ...]:
        """The stretches of a participant, parted at gaps in its recording."""
        if row not in self._found:
            absent = np.cumsum(~self._tracks.present[row])
            own = self._candidates.get(row, {})
            places = np.stack((self._tracks.x[row], self._tracks.y[row]), axis=1)
            self._found[row] = tuple(
                stretch
                for _, columns in groupby(own, key=lambda column: int(absent[column]))
                for stretch in likeliest_path({k: own[k] for k in columns}, places, self._graph)
            )
        return self._found[row]

    @cached_property
    def lanelets(self) -> NDArray[intp]:
        """The numbers of lanelets, in the file's order, by participant and column; -1 for none."""
        numbers = {name: number for number, name in enumerate(self.recording.lanelets)}
        found = np.full(self._tracks.present.shape, -1, dtype=intp)
        for row in self._candidates:
            for stretch in self.of(row):
                found[row, stretch.columns] = [numbers[stretch.chain[k]] for k in stretch.places]
        return found


def candidates(recording: Recording, tracks: Tracks) -> dict[int, Candidates]:
    """The lanelets near each moving participant that lead its way, by row and column."""
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    moving = np.array([not body.standing for body in tracks.participants], dtype=bool)
    rows, columns = np.nonzero(tracks.present & moving[:, None])
    if not lanes or not len(rows):
        return {}
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
    names = np.repeat(np.arange(len(lanes)), [len(own) for own, _, _ in found])
    # By place, lanelets in the order of the file
    order = np.argsort(at, kind="stable")
    by_row: dict[int, dict[int, dict[str, Candidate]]] = {}
    for row, column, lane, cost, s in zip(
        *(x[order].tolist() for x in (rows[at], columns[at], names, costs, along)), strict=True
    ):
        own = by_row.setdefault(row, {}).setdefault(column, {})
        own[lanes[lane].id] = Candidate(cost, s)
    return {**by_row}


def _candidates_on(
    lanelet: Lanelet,
    near: NDArray[intp],
    points: NDArray[np.object_],
    headings: NDArray[np.float64],
) -> tuple[NDArray[intp], NDArray[np.float64], NDArray[np.float64]]:
    """Those ``near`` a lanelet that may be on it, their costs, and their places along it (m)."""
    middle = shapely.LineString(lanelet.centre)
    along = shapely.line_locate_point(middle, points)
    angle = np.abs(turn(directions_at(lanelet, along), headings))
    fits = angle < pi / 2
    away = shapely.distance(middle, points[fits])
    costs = ((away / SIGMA_M) ** 2 + (angle[fits] / SIGMA_RAD) ** 2) / 2
    return near[fits], costs, along[fits]


@dataclass(frozen=True, slots=True)
class _PathEnd:
    """The cheapest path to a lanelet: its cost, and the end before; no way on is a break."""

    cost: float
    lanelet: str
    before: _PathEnd | None
    way: tuple[str, ...] | None


def likeliest_path(
    found: Candidates, places: NDArray[np.float64], graph: LaneletGraph
) -> Iterator[MatchedStretch]:
    """The stretches of the cheapest path through the candidates, ``places`` by column."""
    ends: dict[str, _PathEnd] = {}
    earlier: Mapping[str, Candidate] = {}
    last = -1
    for column, options in found.items():
        moved = hypot(*(places[column] - places[last])) if ends else inf
        ends = {
            name: _step(ends, earlier, (name, option), moved, graph)
            for name, option in options.items()
        }
        earlier, last = options, column
    if ends:
        yield from _stretches(min(ends.values(), key=lambda end: (end.cost, end.lanelet)), found)


def _step(
    ends: Mapping[str, _PathEnd],
    earlier: Mapping[str, Candidate],
    to: tuple[str, Candidate],
    moved: float,
    graph: LaneletGraph,
) -> _PathEnd:
    """The cheapest path on to a candidate of the next state."""
    name, option = to
    best: _PathEnd | None = None
    least, way = inf, None
    for start, end in ends.items():
        cost = end.cost + BREAK_COST
        found = graph.way(start, name)
        own = None
        if found is not None:
            ahead = found.length + option.along - earlier[start].along
            # Who changes lanes moves sideways, too
            off = max(0.0, abs(ahead - moved) - (found.sideways if found.changes else 0.0))
            through = end.cost + off / BETA_M + CHANGE_COST * found.changes
            if through <= cost:
                cost, own = through, found.lanelets
        if cost < least:
            best, least, way = end, cost, own
    if best is None:
        return _PathEnd(option.cost, name, None, None)
    weight = min(1.0, moved / (2 * SIGMA_M))
    return _PathEnd(least + weight * option.cost, name, best, way)


def _stretches(end: _PathEnd, found: Candidates) -> Iterator[MatchedStretch]:
    path: list[_PathEnd] = []
    reached: _PathEnd | None = end
    while reached is not None:
        path.append(reached)
        reached = reached.before
    path.reverse()
    columns = list(found)
    starts = [k for k, one in enumerate(path) if one.way is None]
    for start, stop in zip(starts, [*starts[1:], len(path)], strict=True):
        part = path[start:stop]
        chain, at = [part[0].lanelet], [0]
        for one in part[1:]:
            chain += one.way or ()
            at.append(len(chain) - 1)
        yield MatchedStretch(tuple(columns[start:stop]), tuple(chain), tuple(at))

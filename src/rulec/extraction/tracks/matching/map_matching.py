"""Map matching: the lanelets that vehicles drove, by a hidden Markov model.

Newson, Krumm, "Hidden Markov map matching through noise and sparseness" (ACM SIGSPATIAL GIS 2009):
hidden states are the lanelets near a vehicle's middle, and the likeliest of all paths is found by
dynamic programming (Viterbi, "Error bounds for convolutional codes", 1967), so that where lanelets
overlap the whole drive decides. Costs are negative logarithms of likelihoods. *Emission*: normal in
the distance from a lanelet's middle line, as in the paper, and in the angle to it. Recordings are a
thousand times denser than the paper's samples, which it thins out to one per two standard
deviations; here a state is weighted by how far the vehicle has moved, the line integral of Oran and
Jaillet, "An HMM-based map matching method with cumulative proximity-weight formulation" (ICCVE
2013), so that standing vehicles add nothing. *Transition*: exponential in the difference between
the way along lanelets and the way moved; to a successor, or to a lane beside at a cost per lane.
Where no path leads on, as when a recording jumps or a vehicle leaves a lanelet sideways, the drive
breaks at a high cost.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import pi, radians

import numpy as np
import shapely
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.recording import Recording
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_at

BETA_M = 2.0
"""The mean difference (m) between the way along lanelets and the way moved."""

CHANGE_COST = 5.0
"""The cost of each lane change."""

BREAK_COST = 50.0
"""The cost of going on where no lanelet leads."""

_AT_ONCE = 1 << 19
"""Roughly the most transitions that are computed together."""


@dataclass(frozen=True, slots=True)
class MatchedStretch:
    """Consecutive states that one path along the map explains.

    In ``chain`` each lanelet succeeds the one before or lies beside it; ``places`` are the chain
    indices of the states in ``columns``.
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
        self._candidates = candidates(graph, tracks)

    @cached_property
    def _paths(self) -> tuple[NDArray[intp], NDArray[bool_]]:
        """The lane of each state, and the mask of states that begin a stretch."""
        lane_candidates = self._candidates
        at = lane_candidates.rows, lane_candidates.columns
        places = np.array((self._tracks.x[at], self._tracks.y[at])).T
        absent = (~self._tracks.present).cumsum(axis=1)[at]
        begins = np.ones(len(lane_candidates.rows), dtype=bool)
        begins[1:] = (lane_candidates.rows[1:] != lane_candidates.rows[:-1]) | (
            absent[1:] != absent[:-1]
        )
        return likeliest_paths(lane_candidates, places, begins, self._graph)

    def of(self, row: int) -> tuple[MatchedStretch, ...]:
        """The stretches of a participant, separated at gaps in its recording."""
        lanes, _ = self._paths
        starts, of_row = self._starts
        own = slice(of_row[row], of_row[row + 1])
        ends = starts[own.start + 1 : own.stop + 1]
        return tuple(self._stretch(*part, lanes) for part in zip(starts[own], ends, strict=True))

    @cached_property
    def _starts(self) -> tuple[list[int], list[int]]:
        """Where stretches begin and the last one ends; the number of each row's first one."""
        rows, (_, begins) = self._candidates.rows, self._paths
        starts = begins.nonzero()[0]
        of_row = rows[starts].searchsorted(np.arange(len(self._tracks.present) + 1))
        return [*starts.tolist(), len(rows)], of_row.tolist()

    def _stretch(self, start: int, end: int, lanes: NDArray[intp]) -> MatchedStretch:
        names, (every_column, changes) = self._candidates.names, self._columns_and_changes
        chain, begin = [names[lanes[start]]], start
        places: list[int] = []
        for change in changes[bisect_right(changes, start) : bisect_left(changes, end)]:
            places += [len(chain) - 1] * (change - begin)
            way = self._graph.ways(names[lanes[change - 1]]).get(names[lanes[change]])
            assert way is not None, "a stretch goes on only along ways"
            chain += way.lanelets
            begin = change
        places += [len(chain) - 1] * (end - begin)
        return MatchedStretch(tuple(every_column[start:end]), tuple(chain), tuple(places))

    @cached_property
    def _columns_and_changes(self) -> tuple[list[int], list[int]]:
        """The column of each state, and the states whose lane differs from the one before."""
        lanes, _ = self._paths
        changes = (lanes[1:] != lanes[:-1]).nonzero()[0] + 1
        return self._candidates.columns.tolist(), changes.tolist()

    @cached_property
    def lanelets(self) -> NDArray[intp]:
        """The numbers of lanelets, in the file's order, by participant and column; -1 for none."""
        numbers = {name: number for number, name in enumerate(self.recording.lanelets)}
        found = np.full(self._tracks.present.shape, -1, dtype=intp)
        own = np.array([numbers[name] for name in self._candidates.names], dtype=intp)
        lanes, _ = self._paths
        found[self._candidates.rows, self._candidates.columns] = own[lanes]
        return found


@dataclass(frozen=True, eq=False, slots=True)
class _Transitions:
    """Costs of reaching candidates (second axis) of states from the candidates before (third axis).

    ``off`` for the difference of ways, ``changes`` for lane changes, ``own`` for the candidate
    itself. Entries without a candidate cost infinity.
    """

    off: Floats
    changes: Floats
    own: Floats


def likeliest_paths(
    found: LaneCandidates, places: Floats, begins: NDArray[bool_], graph: LaneletGraph
) -> tuple[NDArray[intp], NDArray[bool_]]:
    """The lanes of the cheapest path through each run of states, and the mask of breaks.

    ``places`` (m) are those of the states; ``begins`` is the mask of the first states of runs,
    which are flagged in the result, too.
    """
    if not len(begins):
        return np.empty(0, dtype=intp), begins
    starts, width = begins.nonzero()[0], int(found.counts.max())
    lengths = np.diff(starts, append=len(begins))
    # All runs advance together step by step, the longest first: those that go on are the first rows
    longest = (-lengths).argsort(kind="stable")
    starts, lengths = starts[longest], lengths[longest]
    going = (-lengths).searchsorted(-np.arange(int(lengths[0])), "left").tolist()
    # States are ordered by step, so that the data of one step are contiguous
    bounds = np.cumsum([0, *going]).tolist()
    parts = list(map(slice, bounds[:-1], bounds[1:]))
    states = np.concatenate([starts[:count] + step for step, count in enumerate(going)])
    back = np.zeros((len(states), width), dtype=intp)
    broken = np.zeros((len(states), width), dtype=bool)
    reached = np.empty((len(states), width))
    reached[parts[0]] = _padded(found, starts, found.costs)
    rows = np.arange(0, len(starts) * width, width)
    candidate = (rows[:, None] + np.arange(width)) * width
    begin = 0
    for part, to in zip(parts[1:], _steps(found, places, (states, bounds), graph), strict=True):
        count = part.stop - part.start
        earlier = reached[begin : begin + count, None, :]
        through = earlier + to.off
        through += to.changes
        breaks = earlier + BREAK_COST
        least = np.minimum(through, breaks)
        chosen = least.argmin(axis=2, out=back[part]) + candidate[:count]
        broken[part] = (through > breaks).take(chosen)
        np.add(least.take(chosen), to.own, out=reached[part])
        begin = part.start
    last = np.array(bounds)[lengths - 1] + np.arange(len(starts))
    own = np.array(
        [
            # Equal costs are decided by name
            min((cost, found.names[found.lanes[first + k]], k) for k, cost in enumerate(costs))[2]
            for first, costs in _ends(found, states[last], reached[last])
        ]
    )
    ways = np.empty(len(states), dtype=intp)
    for part in reversed(parts):
        count = part.stop - part.start
        ways[part] = own[:count]
        own[:count] = back[part].take(rows[:count] + own[:count])
    lanes, parted = np.empty(len(begins), dtype=intp), begins.copy()
    lanes[states] = found.lanes[found.first[states] + ways]
    parted[states] |= broken.ravel()[np.arange(0, broken.size, width) + ways]
    return lanes, parted


def _ends(
    found: LaneCandidates, last: NDArray[intp], reached: Floats
) -> Iterator[tuple[int, list[float]]]:
    """For each run's last state its first candidate and the costs of all of its candidates."""
    counts = found.counts[last].tolist()
    for first, count, costs in zip(found.first[last].tolist(), counts, reached, strict=True):
        yield first, costs[:count].tolist()


def _steps(
    found: LaneCandidates,
    places: Floats,
    passed: tuple[NDArray[intp], list[int]],
    graph: LaneletGraph,
) -> Iterator[_Transitions]:
    """The transitions to the second state of each run, then those to the third, and so on.

    ``passed`` are the states in this order, from the first ones on, and where each step begins.
    """
    states, bounds = passed
    size = max(1, _AT_ONCE // int(found.counts.max()) ** 2)
    step = 1
    while step < len(bounds) - 1:
        # Whole steps, at least one
        begin = bounds[step]
        last = max(step + 1, bisect_right(bounds, begin + size) - 1)
        to = _transitions(found, places, states[begin : bounds[last]], graph)
        for part in map(slice, bounds[step:last], bounds[step + 1 : last + 1]):
            own = slice(part.start - begin, part.stop - begin)
            yield _Transitions(to.off[own], to.changes[own], to.own[own])
        step = last


def _padded(found: LaneCandidates, states: NDArray[intp], values: Floats) -> Floats:
    """The values of all candidates of some states, one row per state, padded with infinity."""
    number, counts = np.arange(int(found.counts.max())), found.counts[states][:, None]
    at = found.first[states][:, None] + np.minimum(number, counts - 1)
    return np.where(number < counts, values[at], np.inf)


def _transitions(
    found: LaneCandidates, places: Floats, states: NDArray[intp], graph: LaneletGraph
) -> _Transitions:
    dx, dy = (places[states] - places[states - 1]).T
    moved = np.sqrt(dx * dx + dy * dy)
    weight = np.zeros(len(found.rows))
    weight[states] = np.minimum(1.0, moved / (2 * SIGMA_M))
    own = _padded(found, states, weight.repeat(found.counts) * found.costs)
    # All pairs of a candidate and one before, end to end
    earlier = found.counts[states - 1]
    pairs = found.counts[states] * earlier
    row = np.arange(len(states)).repeat(pairs)
    number = np.arange(len(row)) - (pairs.cumsum() - pairs).repeat(pairs)
    end, start = np.divmod(number, earlier[row])
    to, since = found.first[states][row] + end, found.first[states - 1][row] + start
    count = len(found.names)
    codes = found.lanes[since] * count + found.lanes[to]
    different = np.unique(codes)
    starts, ends = (numbers.tolist() for numbers in np.divmod(different, count))
    ways_of = {start: graph.ways(found.names[start]) for start in set(starts)}
    pairs_of = zip(starts, ends, strict=True)
    ways = [ways_of[start].get(found.names[end]) for start, end in pairs_of]
    which = different.searchsorted(codes)
    length = np.array([np.inf if way is None else way.length for way in ways])[which]
    changed = np.array([0.0 if way is None else way.changes for way in ways])
    sideways = np.array([0.0 if way is None else way.sideways for way in ways])[which]
    ahead = length + found.along[to] - found.along[since]
    off = np.full((*own.shape, own.shape[1]), np.inf)
    changes = np.zeros(off.shape)
    # A vehicle that changes lanes also moves sideways
    off[row, end, start] = np.maximum(0.0, np.abs(ahead - moved[row]) - sideways) / BETA_M
    changes[row, end, start] = (CHANGE_COST * changed)[which]
    return _Transitions(off, changes, own)


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

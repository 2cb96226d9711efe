"""Map matching: the chain of lanelets of a vehicle's states.

A state matches the lanelets within ``NEAR_M`` that lead its way; each match has a cost. Lanelets
overlap in junctions, and ego changes lanes, so that the match of a single state says little. Of all
chains in which each lanelet leads to the next, the cheapest is chosen: a shortest path over the
moments by dynamic programming (Viterbi, "Error bounds for convolutional codes", 1967; for map
matching Newson, Krumm, "Hidden Markov map matching through noise and sparseness", GIS 2009), where
a lane beside a match costs more the farther away it is. Where no chain goes on, as when a recording
jumps, the drive is parted.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
import shapely

from rulec.extraction.tracks.tracks import Tracks
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_beside, is_lane, lanelet_area, lanes_beside

NEAR_M = 3.0
"""The farthest that a vehicle may be beside a lanelet that it is matched to."""

MOST_HOPS = 4
"""The number of lanelets that a vehicle passes at most between two of its states."""

_BESIDE_COST = 1.0
_HOP_COST = 0.05
_LANE_COST = 1.0
_LARGEST_ANGLE = pi / 2

MatchedLanelets = Mapping[int, Mapping[str, float]]
"""Column -> lanelet -> cost: 0 on it and along it, up to 1 for its angle, 1 to 2 more beside it."""


def match_to_map(recording: Recording, tracks: Tracks) -> dict[int, MatchedLanelets]:
    """The matches of each moving participant, by row and by column that has any."""
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    moving = np.array([not body.standing for body in tracks.participants], dtype=bool)
    rows, columns = np.nonzero(tracks.present & moving[:, None])
    if not lanes or not len(rows):
        return {}
    points = shapely.points(tracks.x[rows, columns], tracks.y[rows, columns])
    areas = [lanelet_area(lanelet) for lanelet in lanes]
    near, near_lanes = shapely.STRtree(areas).query(points, predicate="dwithin", distance=NEAR_M)
    matches: dict[int, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    for lane in np.unique(near_lanes):
        chosen = near[near_lanes == lane]
        directions = directions_beside(lanes[lane], points[chosen])
        headings = tracks.heading[rows[chosen], columns[chosen]]
        angle = np.abs(turn(directions, headings))
        outside = shapely.distance(areas[lane], points[chosen]) / NEAR_M
        costs = angle / _LARGEST_ANGLE + np.where(outside > 0, _BESIDE_COST + outside, 0.0)
        along = angle < _LARGEST_ANGLE
        for index, cost in zip(chosen[along], costs[along].tolist(), strict=True):
            matches[int(rows[index])][int(columns[index])][lanes[lane].id] = cost
    return {row: dict(sorted(by_column.items())) for row, by_column in matches.items()}


@dataclass(frozen=True, slots=True)
class RouteStretch:
    """Columns ``first`` to ``last`` inclusive of one chain of lanelets."""

    first: int
    last: int
    route: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _ChainEnd:
    """The cheapest chain to a lanelet: its cost, its last hops, and what is before them."""

    cost: float
    hops: tuple[str, ...]
    before: _ChainEnd | None


def driven_stretches(recording: Recording, matches: MatchedLanelets) -> Iterator[RouteStretch]:
    """The stretches of a drive, each along one road, in their order."""
    first = last = -1
    best: dict[str, _ChainEnd] = {}
    for column, matched in matches.items():
        costs = _costs_of_rows(recording, matched)
        onward = _onward(recording, best, costs)
        if not onward:
            if best:
                yield RouteStretch(first, last, _cheapest_route(best))
            first = column
            onward = {number: _ChainEnd(cost, (number,), None) for number, cost in costs.items()}
        best, last = onward, column
    if best:
        yield RouteStretch(first, last, _cheapest_route(best))


def _costs_of_rows(recording: Recording, matched: Mapping[str, float]) -> dict[str, float]:
    """The costs of the lanelets that match a state, neighbours included."""
    costs: dict[str, float] = {}
    for number, cost in matched.items():
        for left in (True, False):
            row = (number, *lanes_beside(recording, number, left=left))
            for lanes, lanelet in enumerate(row):
                beside_cost = cost + lanes * _LANE_COST
                costs[lanelet] = min(costs.get(lanelet, beside_cost), beside_cost)
    return costs


def _onward(
    recording: Recording, best: Mapping[str, _ChainEnd], costs: Mapping[str, float]
) -> dict[str, _ChainEnd]:
    """The cheapest chains on to a next state's lanelets, or none."""
    onward: dict[str, _ChainEnd] = {}
    for start, chain in best.items():
        for hops in _hops(recording, start, costs):
            end = hops[-1] if hops else start
            cost = chain.cost + costs[end] + _HOP_COST * len(hops)
            if end not in onward or cost < onward[end].cost:
                onward[end] = (
                    _ChainEnd(cost, hops, chain)
                    if hops
                    else _ChainEnd(cost, chain.hops, chain.before)
                )
    return onward


def _hops(
    recording: Recording, start: str, targets: Mapping[str, float]
) -> Iterator[tuple[str, ...]]:
    """The shortest chain of successors to each target; that to the start is empty."""
    if start in targets:
        yield ()
    reached = {start}
    chains: list[tuple[str, ...]] = [()]
    for _ in range(MOST_HOPS):
        longer = []
        for chain in chains:
            for number in recording.lanelets[chain[-1] if chain else start].successors:
                lanelet = recording.lanelets.get(number)
                if lanelet is None or number in reached or not is_lane(lanelet):
                    continue
                reached.add(number)
                longer.append((*chain, number))
                if number in targets:
                    yield (*chain, number)
        chains = longer


def _cheapest_route(best: Mapping[str, _ChainEnd]) -> tuple[str, ...]:
    chain: _ChainEnd | None = min(best.values(), key=lambda end: (end.cost, end.hops))
    parts: list[tuple[str, ...]] = []
    while chain is not None:
        parts.append(chain.hops)
        chain = chain.before
    return tuple(number for hops in reversed(parts) for number in hops)

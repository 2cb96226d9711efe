"""The road that a vehicle really drove: the chain of lanelets along which its states lie.

Lanelets overlap in junctions, and ego changes lanes, so that the lanelet of a single state says
little. Of all chains in which each lanelet leads to the next, the one is chosen that ego's states
are best on, a lane beside counting as worse the farther away it is (a shortest path over the
moments). Where no chain goes on, as when a recording jumps, the drive is parted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rulec.extraction.tracks.map_matching import MatchedLanelets
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.recorded.route import is_lane, lanes_beside

MOST_HOPS = 4
"""A vehicle passes at most so many lanelets between two of its states."""

_HOP_COST = 0.05
_LANE_COST = 1.0


@dataclass(frozen=True, slots=True)
class RouteStretch:
    """Ego drives along ``way`` from the first column to the last, both included."""

    first: int
    last: int
    way: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Path:
    """The best chain so far that ends in a lanelet: its cost, and its last hop."""

    cost: float
    hops: tuple[str, ...]
    before: _Path | None


def driven_stretches(recording: Recording, moments: MatchedLanelets) -> Iterator[RouteStretch]:
    """The pieces of a drive, each along one road, in their order."""
    first = last = -1
    best: dict[str, _Path] = {}
    for column, places in moments.items():
        wanted = _rows(recording, places)
        onward = _onward(recording, best, wanted)
        if not onward:
            if best:
                yield RouteStretch(first, last, _way(best))
            first = column
            onward = {number: _Path(cost, (number,), None) for number, cost in wanted.items()}
        best, last = onward, column
    if best:
        yield RouteStretch(first, last, _way(best))


def _rows(recording: Recording, places: Mapping[str, float]) -> dict[str, float]:
    """The lanelets that hold a state, and those beside them, with how badly they fit."""
    found: dict[str, float] = {}
    for number, cost in places.items():
        for left in (True, False):
            row = (number, *lanes_beside(recording, number, left=left))
            for lanes, one in enumerate(row):
                found[one] = min(
                    found.get(one, cost + lanes * _LANE_COST), cost + lanes * _LANE_COST
                )
    return found


def _onward(
    recording: Recording, best: Mapping[str, _Path], wanted: Mapping[str, float]
) -> dict[str, _Path]:
    found: dict[str, _Path] = {}
    for start, path in best.items():
        for hops in _chains(recording, start, wanted):
            end = hops[-1] if hops else start
            cost = path.cost + wanted[end] + _HOP_COST * len(hops)
            if end not in found or cost < found[end].cost:
                found[end] = (
                    _Path(cost, hops, path) if hops else _Path(cost, path.hops, path.before)
                )
    return found


def _chains(
    recording: Recording, start: str, wanted: Mapping[str, float]
) -> Iterator[tuple[str, ...]]:
    """The shortest chain of successors to each wanted lanelet; the empty one to the start."""
    if start in wanted:
        yield ()
    seen = {start}
    ends: list[tuple[str, ...]] = [()]
    for _ in range(MOST_HOPS):
        longer = []
        for chain in ends:
            for number in recording.lanelets[chain[-1] if chain else start].successors:
                lanelet = recording.lanelets.get(number)
                if lanelet is None or number in seen or not is_lane(lanelet):
                    continue
                seen.add(number)
                longer.append((*chain, number))
                if number in wanted:
                    yield (*chain, number)
        ends = longer


def _way(best: Mapping[str, _Path]) -> tuple[str, ...]:
    path: _Path | None = min(best.values(), key=lambda one: (one.cost, one.hops))
    found: list[tuple[str, ...]] = []
    while path is not None:
        found.append(path.hops)
        path = path.before
    return tuple(number for hops in reversed(found) for number in hops)

"""Whether vehicles from behind, on a lane that forks, come into ego's lane or another one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.computed_once import once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import zero_if_nan

_BEYOND_M = 15.0
"""This far behind a fork its lanes no longer overlap."""


@dataclass(frozen=True, slots=True)
class _Ways:
    """The lanes to which a lane leads, and whether a way leaves the road."""

    lanes: frozenset[int]
    leaves: bool

    @property
    def forks(self) -> bool:
        return self.leaves or len(self.lanes) > 1


def come_into_lane(context: DriveContext, rows: NDArray[intp], states: NDArray[intp]) -> Truth:
    """Which vehicles behind ego come into the lane of its middle.

    One per row and state; where ways part, decided by the vehicle's track, which may not suffice.
    Vehicles on the same lane do if it does not fork between the two; vehicles whose lane ends there
    do not, since they have to change lanes themselves.
    """
    theirs, egos = _pieces(context, rows, states)
    inside = (theirs < egos) | context.in_ego_lane[rows, states]
    return comes_from_before(context, rows, states) & inside


def comes_from_before(context: DriveContext, rows: NDArray[intp], states: NDArray[intp]) -> Truth:
    """``come_into_lane``, with those on the same piece of the road as ego coming, wherever."""
    sure, possible = np.ones((2, len(rows)), dtype=bool)
    theirs, egos = _pieces(context, rows, states)
    for number in (theirs < egos).nonzero()[0].tolist():
        pieces = int(theirs[number]), int(egos[number])
        found = _comes_by_its_way(context, int(rows[number]), int(states[number]), pieces)
        sure[number], possible[number] = found is True, found is not False
    return Truth(sure, possible)


def _pieces(
    context: DriveContext, rows: NDArray[intp], states: NDArray[intp]
) -> tuple[NDArray[intp], NDArray[intp]]:
    """The pieces of the road that vehicles are on, and ego."""
    s, own = context.extents.s[rows, states], context.ego_extents.s[0, states]
    return context.road.piece(zero_if_nan(s)), context.road.piece(zero_if_nan(own))


def _comes_by_its_way(
    context: DriveContext, row: int, state: int, pieces: tuple[int, int]
) -> bool | None:
    """Whether a vehicle in an earlier piece of the road than ego comes into its lane; or None."""
    extents, same = context.extents, bool(context.in_ego_lane[row, state])
    own, lane = int(context.ego_lane[state]), int(extents.lane[row, state])
    ways, fork = _ways(context, *pieces, lane)
    if not ways.lanes:
        return False
    if not ways.forks or (own not in ways.lanes and not same):
        return same
    later = slice(state, int(context.spans.end[state]))
    past = extents.s[row, later] >= float(context.road.borders[fork]) + _BEYOND_M
    on_road = context.relevant[row, later] & context.on_lanes[row, later]
    has_left = context.tracks.present[row, later] & context.elsewhere[row, later]
    decided = (past | has_left | ~on_road).nonzero()[0]
    if not len(decided):
        return None
    first = int(decided[0])
    if has_left[first]:
        return False
    return int(extents.lane[row, state + first]) == own if on_road[first] else None


def _ways(context: DriveContext, first: int, last: int, lane: int) -> tuple[_Ways, int]:
    """The ways of a lane from a piece of the road to a later one, and the piece where it forks."""
    onward, fork = _onward(context), last
    ways = _Ways(frozenset({lane}), leaves=False)
    for piece in range(first, last):
        found = [
            onward[piece].get(one, _Ways(frozenset({one}), leaves=False)) for one in ways.lanes
        ]
        lanes = frozenset().union(*(place.lanes for place in found))
        was, ways = ways, _Ways(lanes, ways.leaves or any(one.leaves for one in found))
        if ways.forks and not was.forks:
            fork = piece + 1
    return ways, fork


@once_a_road
def _onward(context: DriveContext) -> Sequence[Mapping[int, _Ways]]:
    """For each piece of the road, the lanes of the next piece to which each of its lanes leads."""
    known, found = context.recording.lanelets, []
    for row, beyond in pairwise(context.road.rows):
        numbers = {one.id: lane for lane, one in enumerate(beyond) if one is not None}
        ways = {}
        for lane, lanelet in enumerate(row):
            leads = [] if lanelet is None else [x for x in lanelet.successors if x in known]
            if lanelet is not None and not leads and beyond[lane] is None:
                ways[lane] = _Ways(frozenset(), leaves=False)
            if leads:
                lanes = frozenset(numbers[x] for x in leads if x in numbers)
                ways[lane] = _Ways(lanes, leaves=any(x not in numbers for x in leads))
        found.append(ways)
    return found

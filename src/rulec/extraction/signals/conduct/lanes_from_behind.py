"""Whether who comes from behind, on a lane that forks, comes into ego's lane or another one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_passes import once_a_road

_BEYOND_M = 15.0
"""So far behind where a lane has forked its ways lie over each other no more."""


@dataclass(frozen=True, slots=True)
class _Ways:
    """Where a lane leads farther on: to which lanes, and does a way leave the road?"""

    lanes: frozenset[int]
    leaves: bool

    @property
    def forks(self) -> bool:
        return self.leaves or len(self.lanes) > 1


def comes_into_lane(context: DriveContext, row: int, state: int) -> bool | None:
    """Does a vehicle behind ego come into the lane of ego's middle, by its track if ways part?

    None where its track does not tell. True on the same lane, where none forks between the two;
    False where it ends there: who comes from such a lane has to change lanes itself.
    """
    extents = context.extents
    own, lane = int(context.ego_lane[state]), int(extents.lane[row, state])
    places = np.array([extents.s[row, state], context.ego_extents.s[0, state]])
    theirs, egos = context.road.piece(np.nan_to_num(places)).tolist()
    same = bool(context.in_ego_lane[row, state])
    if theirs >= egos:
        return same
    ways, fork = _ways(context, theirs, egos, lane)
    if not ways.lanes:
        return False
    if not ways.forks or (own not in ways.lanes and not same):
        return same
    later = slice(state, int(context.spans.end[state]))
    past = extents.s[row, later] >= float(context.road.borders[fork]) + _BEYOND_M
    on_road = context.relevant[row, later] & context.on_lanes[row, later]
    has_left = context.tracks.present[row, later] & context.elsewhere[row, later]
    decided = np.flatnonzero(past | has_left | ~on_road)
    if not len(decided):
        return None
    first = int(decided[0])
    if has_left[first]:
        return False
    return int(extents.lane[row, state + first]) == own if on_road[first] else None


def _ways(context: DriveContext, first: int, last: int, lane: int) -> tuple[_Ways, int]:
    """Where a lane of a piece of the road leads by a later one, and the piece where it parts."""
    onward, fork = _onward(context), last
    ways = _Ways(frozenset({lane}), leaves=False)
    for piece in range(first, last):
        found = [
            onward[piece].get(one, _Ways(frozenset({one}), leaves=False)) for one in ways.lanes
        ]
        lanes = frozenset().union(*(one.lanes for one in found))
        was, ways = ways, _Ways(lanes, ways.leaves or any(one.leaves for one in found))
        if ways.forks and not was.forks:
            fork = piece + 1
    return ways, fork


@once_a_road
def _onward(context: DriveContext) -> Sequence[Mapping[int, _Ways]]:
    """For each piece of the road the lanes of the next one to which each of its lanes leads."""
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

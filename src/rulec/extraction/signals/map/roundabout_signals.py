"""Signals of roundabouts: being on one, entering one, and whether its signs are there."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.stop_lines import may_have_passed
from rulec.extraction.signals.signal_columns import SignalColumns, world_signals
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import runs_along
from rulec.trace.partly_known.partly_known_values import Truth

_ROUNDABOUT = frozenset({"ROUNDABOUT"})
_SIGNS: Mapping[str, frozenset[str]] = {
    "roundabout_signed": _ROUNDABOUT | {"YIELD"},
    "compulsory_roundabout": _ROUNDABOUT,
}
"""Word -> the signs before a ring that it stands for."""


@word("roundabout", "enters_roundabout", *_SIGNS)
def _rings(context: DriveContext) -> SignalColumns:
    road = context.road
    front, middle = context.ego_extents.s_max[0], context.ego_extents.s[0]
    inside, enters, unseen = np.zeros((3, context.states), dtype=bool)
    holds, holds_possibly = (
        {name: np.zeros(context.states, dtype=bool) for name in _SIGNS} for _ in range(2)
    )
    known = context.recording.complete | map_contents(context).signs
    for begins, end, _ in roundabouts(context):
        inside |= (middle > begins) & (middle < end)
        enters |= context.spans.enters(front > begins)
        unseen |= may_have_passed(context, begins, front)
        nears = (front > begins - context.thresholds.approach_m) & (middle < end)
        before = [
            row
            for row, (low, high) in zip(road.rows, pairwise(road.borders.tolist()), strict=True)
            if begins - context.thresholds.approach_m < high <= begins + 0.1 and low < begins
        ]
        there = [x for row in before for x in row if x is not None]
        for name, signs in _SIGNS.items():
            untold = any(signs & x.untold_signs for x in there) or signs.isdisjoint(known)
            has_sign = any(signs & x.signs for x in there)
            holds[name] |= nears & has_sign
            holds_possibly[name] |= nears & (has_sign or untold)
    told = {name: Truth(holds[name], holds_possibly[name]) for name in _SIGNS}
    entering = Truth.known(enters).unknown_at(unseen)
    return world_signals(roundabout=inside, enters_roundabout=entering, **told)


def without_junction(context: DriveContext) -> Flags:
    """Mask of states in which ego enters a ring where the map has no junction."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    enters = np.zeros(context.states, dtype=bool)
    for begins, _, at_junction in roundabouts(context):
        nears = (front > begins - context.thresholds.approach_m) & (rear <= begins)
        enters |= nears & (not at_junction)
    return enters


@once_a_road
def roundabouts(context: DriveContext) -> tuple[tuple[float, float, bool], ...]:
    """The intervals in which ego's road is on a ring, and whether it enters that by a junction.

    The junction before the ring is where ego drives into it.
    """
    ring, road = context.surroundings.ring(context.side), context.road
    on = [any(x is not None and x.id in ring for x in row) for row in road.rows]
    found = []
    for start, end in runs_along(road.borders, on):
        before = [low for low, high in road.junctions if low < start <= high + 1.0]
        found.append((before[0], end, True) if before else (start, end, False))
    return tuple(found)

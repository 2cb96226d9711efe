"""Signals of roundabouts: on one, into one, and whether its signs are there."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.driven_road import runs_along
from rulec.extraction.tracks.tracks import Flags

_SIGNS = frozenset({"YIELD", "ROUNDABOUT"})


def roundabout_signals(context: DriveContext) -> SignalColumns:
    """The signals of roundabouts on ego's road, which are rings of lanelets."""
    road = context.road
    front, middle = context.ego_extents.s_max[0], context.ego_extents.s[0]
    inside, enters = np.zeros((2, context.states), dtype=bool)
    signed, unknown = np.zeros((2, context.states), dtype=bool)
    lanelets = context.recording.lanelets.values()
    told = "YIELD" in context.recording.complete or any(_SIGNS & x.signs for x in lanelets)
    for begins, end, _ in _roundabouts(context):
        inside |= (middle > begins) & (middle < end)
        enters |= np.append(False, (front[1:] > begins) & (front[:-1] <= begins))
        nears = (front > begins - context.thresholds.approach_m) & (middle < end)
        before = [
            row
            for row, (low, high) in zip(road.rows, pairwise(road.borders.tolist()), strict=True)
            if begins - context.thresholds.approach_m < high <= begins + 0.1 and low < begins
        ]
        signs = any(x is not None and _SIGNS & x.signs for row in before for x in row)
        signed |= nears & signs
        unknown |= nears & (not told)
    world: dict[str, SignalColumn] = {
        "roundabout": inside,
        "enters_roundabout": enters,
        "roundabout_signed": signed,
    }
    not_told: dict[str, Flags] = {"roundabout_signed": unknown & ~signed}
    return SignalColumns(world, unknown=not_told)


def without_junction(context: DriveContext) -> Flags:
    """Flags of states in which ego enters a ring where the map has no junction."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    enters = np.zeros(context.states, dtype=bool)
    for begins, _, at_junction in _roundabouts(context):
        nears = (front > begins - context.thresholds.approach_m) & (rear <= begins)
        enters |= nears & (not at_junction)
    return enters


def _roundabouts(context: DriveContext) -> Iterator[tuple[float, float, bool]]:
    """From where to where ego's road is on a ring, and whether it gets there by a junction.

    The junction before the ring is where one drives into it.
    """
    ring, road = context.surroundings.ring(context.side), context.road
    on = [any(x is not None and x.id in ring for x in row) for row in road.rows]
    for start, end in runs_along(road.borders, on):
        before = [low for low, high in road.junctions if low < start <= high + 1.0]
        yield (before[0], end, True) if before else (start, end, False)

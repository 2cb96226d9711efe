"""Signals of roundabouts: on one, into one, and whether its signs are there."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.driven_road import runs_along
from rulec.extraction.tracks.tracks import Flags

_SIGNS = frozenset({"YIELD", "ROUNDABOUT"})


def roundabout_signals(context: DriveContext) -> SignalColumns:
    """The signals of roundabouts on ego's road, which are rings of lanelets."""
    ring, road = context.surroundings.ring(context.side), context.road
    on = [any(x is not None and x.id in ring for x in row) for row in road.rows]
    front, middle = context.ego_extents.s_max[0], context.ego_extents.s[0]
    inside, enters = np.zeros((2, context.states), dtype=bool)
    signed, unknown = np.zeros((2, context.states), dtype=bool)
    lanelets = context.recording.lanelets.values()
    told = "YIELD" in context.recording.complete or any(_SIGNS & x.signs for x in lanelets)
    for start, end in runs_along(road.borders, on):
        # The junction before the ring is where one drives into it
        begins = next((low for low, high in road.junctions if low < start <= high + 1.0), start)
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

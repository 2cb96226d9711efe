"""Signals of pedestrians at the crossing ahead, and of vehicles stopping there.

Intentions are not recorded. Who is on the crossing is on it, unless it walks away from
ego's lanes, which it has crossed then; who stands at the kerb beside it waits to cross; who walks
towards it is about to, if it will be there soon.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.map_signals import next_crossing
from rulec.extraction.signals.signal_columns import SignalColumns, named_values
from rulec.extraction.tracks.tracks import Flags, Floats

_USES = ("not_crossing", "waiting_to_cross", "about_to_cross", "entering_crossing", "on_crossing")


def crossing_signals(context: DriveContext) -> SignalColumns:
    """The signals of pedestrians, and of vehicles that stop for them."""
    uses = _crossing_uses(context)
    used = ((uses > 0) & context.relevant).any(axis=0)
    return SignalColumns(
        about={
            "crossing_use": named_values(uses, _USES),
            "stopped_for_pedestrian": _stopped(context) & used,
        },
        only={
            "crossing_use": context.tracks.of_type("pedestrian"),
            "stopped_for_pedestrian": context.tracks.of_type("vehicle"),
        },
    )


def _crossing_uses(context: DriveContext) -> NDArray[intp]:
    """Indices into ``_USES`` for all participants; they are meaningful for pedestrians only."""
    others, limits = context.extents, context.thresholds
    straight = context.road.lanes.straight
    start, end = next_crossing(context)
    # Room for who does not walk exactly between the marks
    beside = (others.s_max > start - limits.kerb_m) & (others.s_min < end + limits.kerb_m)
    to_road = np.maximum(np.maximum(straight[0] - others.w_max, others.w_min - straight[-1]), 0.0)
    walks = context.tracks.speed * KMH >= limits.standing_kmh
    towards = _towards(context)
    crossing = beside & context.tracks.on_crosswalk & context.tracks.on_lane
    on = crossing & (context.touched.any(axis=-1) | ~walks | (towards > 0))
    waits = beside & (to_road <= limits.kerb_m) & ~walks
    # Who walks along the pavement and drifts a little towards the road does not come to cross
    approaches = walks & (towards > np.abs(others.along))
    soon = beside & approaches & (to_road <= towards * limits.about_to_s)
    enters = soon & (to_road <= towards * limits.entering_s)
    return np.select([on, enters, soon, waits], [4, 3, 2, 1], 0)


def _towards(context: DriveContext) -> Floats:
    """The speed towards the middle of the road, across it (m/s)."""
    straight = context.road.lanes.straight
    left = context.extents.across
    return np.where(context.extents.w < (straight[0] + straight[-1]) / 2, left, -left)


def _stopped(context: DriveContext) -> Flags:
    """Flags of participants stopped on ego's lanes before the crossing ahead."""
    start, _ = next_crossing(context)
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    way = start - context.extents.s_max
    stopped: Flags = (
        stands & context.touched.any(axis=-1) & (way >= 0) & (way <= 2 * context.thresholds.zone_m)
    )
    return stopped

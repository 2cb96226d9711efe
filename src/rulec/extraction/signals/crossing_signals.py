"""What people on foot do at the pedestrian crossing before ego, and who has stopped for them.

Nobody has recorded what they intend. Who is on the crossing is on it, unless it walks away from
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


def crossing_signals(view: DriveContext) -> SignalColumns:
    """Words about those who walk, and about those who stop for them."""
    use = _crossing_uses(view)
    somebody = ((use > 0) & view.near).any(axis=0)
    return SignalColumns(
        about={
            "crossing_use": named_values(use, _USES),
            "stopped_for_pedestrian": _stopped(view) & somebody,
        },
        only={
            "crossing_use": view.people.of_kind("pedestrian"),
            "stopped_for_pedestrian": view.people.of_kind("vehicle"),
        },
    )


def _crossing_uses(view: DriveContext) -> NDArray[intp]:
    """The number of the use in ``_USES``, of everybody; it means something of who walks only."""
    others, limits = view.others, view.thresholds
    straight = view.road.lanes.straight
    start, end = next_crossing(view)
    # Room for who does not walk exactly between the marks
    beside = (others.s_max > start - limits.kerb_m) & (others.s_min < end + limits.kerb_m)
    to_road = np.maximum(np.maximum(straight[0] - others.w_max, others.w_min - straight[-1]), 0.0)
    walks = view.people.speed * KMH >= limits.standing_kmh
    towards = _towards(view)
    crossing = beside & view.on_crosswalk & view.in_the_road
    on = crossing & (view.touched.any(axis=-1) | ~walks | (towards > 0))
    waits = beside & (to_road <= limits.kerb_m) & ~walks
    # Who walks along the pavement and drifts a little towards the road does not come to cross
    comes = walks & (towards > np.abs(others.along))
    soon = beside & comes & (to_road <= towards * limits.about_to_s)
    enters = soon & (to_road <= towards * limits.entering_s)
    found: NDArray[intp] = np.select([on, enters, soon, waits], [4, 3, 2, 1], 0)
    return found


def _towards(view: DriveContext) -> Floats:
    """The speed towards the middle of the road, across it (m/s)."""
    straight = view.road.lanes.straight
    left = view.others.across
    towards: Floats = np.where(view.others.w < (straight[0] + straight[-1]) / 2, left, -left)
    return towards


def _stopped(view: DriveContext) -> Flags:
    """Who stands before the crossing that lies ahead of ego, near to it."""
    start, _ = next_crossing(view)
    stands = view.people.speed * KMH < view.thresholds.standing_kmh
    way = start - view.others.s_max
    found: Flags = (
        stands & view.touched.any(axis=-1) & (way >= 0) & (way <= 2 * view.thresholds.zone_m)
    )
    return found

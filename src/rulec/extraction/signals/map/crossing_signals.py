"""Signals of pedestrians at the crossing ahead, and of vehicles stopping there.

Intentions are not recorded. Who is on the crossing is on it, unless it walks away from
ego's lane, which it has crossed then; who stands at the kerb beside it waits to cross; who walks
towards it is about to, if it will be there soon.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.signal_columns import SignalColumns, latest, named_values
from rulec.extraction.tracks.tracks import Flags, Floats

_USES = ("not_crossing", "waiting_to_cross", "about_to_cross", "entering_crossing", "on_crossing")


def crossing_signals(context: DriveContext) -> SignalColumns:
    """The signals of pedestrians, and of vehicles that stop for them."""
    uses = _crossing_uses(context, next_crossing(context), context.tracks.on_crosswalk)
    aside = _crossing_uses(context, _side_road(context), context.tracks.on_lane)
    walkers = context.tracks.of_type("pedestrian")[:, None]
    used = ((uses > 0) & context.relevant & walkers).any(axis=0)
    too_late, unsure = _too_late(context, uses)
    own = np.where(_past_ego(context) | too_late, 0, uses)
    stopped = _stopped(context) & used
    return SignalColumns(
        about={
            "crossing_use": named_values(own, _USES),
            "stopped_for_pedestrian": stopped,
            "crosses_side_road": aside > 0,
        },
        only={
            "crossing_use": context.tracks.of_type("pedestrian"),
            "stopped_for_pedestrian": context.tracks.of_type("vehicle"),
            "crosses_side_road": context.tracks.of_type("pedestrian"),
        },
        unknown={
            "crossing_use": unsure & (own > 0),
            "stopped_for_pedestrian": _behind_another(context, stopped),
        },
    )


def _side_road(context: DriveContext) -> tuple[Floats, Floats]:
    """Begin and end of where pedestrians cross the road into which ego turns, or infinity."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    start, end = np.full((2, context.states), np.inf)
    for low, high in reversed(context.road.junctions):
        if turn_at(context, low, high) != "straight_on":
            nears = (front > low - context.thresholds.approach_m) & (rear < high)
            beyond = high + context.thresholds.side_road_m
            start, end = np.where(nears, high, start), np.where(nears, beyond, end)
    return start, end


def _crossing_uses(
    context: DriveContext, stretch: tuple[Floats, Floats], on_it: Flags
) -> NDArray[intp]:
    """Indices into ``_USES`` for all participants; they are meaningful for pedestrians only.

    ``stretch`` has begin and end of the crossing by state, ``on_it`` flags of who is where one
    crosses; where no crossing is drawn that is any place in the road.
    """
    start, end = stretch
    others, limits = context.extents, context.thresholds
    # Room for who does not walk exactly between the marks
    beside = (others.s_max > start - limits.kerb_m) & (others.s_min < end + limits.kerb_m)
    to_road = np.maximum(-others.left_of_max[..., 0], others.left_of_min[..., -1]).clip(0.0)
    walks = context.tracks.speed * KMH >= limits.standing_kmh
    towards = _towards(context)
    crossing = beside & on_it & context.tracks.on_lane
    on = crossing & (context.touched.any(axis=-1) | ~walks | (towards > 0))
    waits = beside & (to_road <= limits.kerb_m) & ~walks
    # Who walks along the pavement and drifts a little towards the road does not come to cross
    approaches = walks & (towards > np.abs(others.along))
    soon = beside & approaches & (to_road <= towards * limits.about_to_s)
    enters = soon & (to_road <= towards * limits.entering_s)
    return np.select([on, enters, soon, waits], [4, 3, 2, 1], 0)


def _too_late(context: DriveContext, uses: NDArray[intp]) -> tuple[Flags, Flags]:
    """Flags of who came to use the crossing when ego could not wait any more, and of who may have.

    Ego can where, braking at once, it stops before them or before the crossing. Who leaves off for
    no longer than ``away_s`` uses it all the time. Who does when first seen may have come just
    then; who is on the crossing then has been about to cross for ``about_to_s``. Where somebody
    walks shows late in a mean, by half its time.
    """
    limits, used = context.thresholds, uses > 0
    speed, front = np.maximum(context.ego_extents.along[0], 0.0), context.ego_extents.s_max[0]
    start, _ = next_crossing(context)
    longest = round(limits.away_s / context.recording.step_s)
    off = np.arange(context.states) - latest(used) > longest
    seen_before = latest(off & context.relevant) >= 0
    on_it = (uses == len(_USES) - 1) & ~seen_before
    earlier = np.where(on_it, limits.about_to_s, 0.0) + limits.smoothing_s / 2
    stop = speed**2 / (2 * limits.braking_mps2) - speed * earlier
    waits = front + stop <= np.maximum(start, context.extents.s_min)
    begins = latest(off | np.append(False, start[1:] != start[:-1]))
    late = used & (latest(used & waits) < np.maximum(begins, 0))
    return late & seen_before, late & ~seen_before


def _towards(context: DriveContext) -> Floats:
    """The speed towards the middle of the road, across it (m/s)."""
    left, left_of = context.extents.across, context.extents.left_of
    return np.where(left_of[..., 0] + left_of[..., -1] < 0, left, -left)


def _past_ego(context: DriveContext) -> Flags:
    """Flags of participants that have left ego's lane, and ego's body, and walk away from them.

    Who turns along the road then has left them behind too, until they walk back, for ``away_s``. Of
    ego's body counts the middle if it turns away from them: what reaches farther is its rear.
    """
    own, others, bound = context.ego_extents, context.extents, context.ego_lane
    low = np.where(own.across > 0, own.middle_from(bound), own.from_bound(bound)[0])
    high = np.where(own.across < 0, own.middle_from(bound + 1), own.from_bound(bound + 1)[1])
    on_left = others.from_bound(bound + 1)[0] > np.maximum(high, 0.0)
    on_right = others.from_bound(bound)[1] < np.minimum(low, 0.0)
    least = context.thresholds.standing_kmh / KMH
    beyond = np.where(on_left, 1.0, np.where(on_right, -1.0, 0.0))
    away = latest(beyond * others.across > least)
    back = latest((beyond == 0) | (beyond * others.across < -least))
    longest = round(context.thresholds.away_s / context.recording.step_s)
    past: Flags = (away > back) & (np.arange(context.states) - away <= longest)
    return past


def _behind_another(context: DriveContext, stopped: Flags) -> Flags:
    """Flags of those with another vehicle in their lane between them and the crossing.

    They may stop for that one.
    """
    start, _ = next_crossing(context)
    others, vehicles = context.extents, context.tracks.of_type("vehicle")[:, None]
    waits = np.zeros_like(stopped)
    for row in np.flatnonzero(stopped.any(axis=1)):
        ahead = vehicles & (others.s_min >= others.s_max[row]) & (others.s_min < start)
        same = (context.touched & context.touched[row]).any(axis=-1)
        waits[row] = stopped[row] & (ahead & same).any(axis=0)
    return waits


def _stopped(context: DriveContext) -> Flags:
    """Flags of participants stopped on ego's lanes before the crossing ahead."""
    start, _ = next_crossing(context)
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    way = start - context.extents.s_max
    stopped: Flags = (
        stands & context.touched.any(axis=-1) & (way >= 0) & (way <= 2 * context.thresholds.zone_m)
    )
    return stopped

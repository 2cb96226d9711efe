"""Signals of traffic flow around ego: queues, congestion, overtaking.

All of it counts the vehicles that go ego's way on its lanes, ego among them, not farther away than
``flow_reach_m``. Queues are those of lanes, and a lane's vehicles are those whose middle is in it.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats


def flow_signals(context: DriveContext) -> SignalColumns:
    """The signals of traffic as a whole."""
    limits = context.thresholds
    speeds, counts = _around(context)
    enough = counts >= limits.fewest
    congested = enough & (speeds < limits.congested_kmh)
    queues, queue_speeds = _queues(context)
    overtakes, overtaken = _overtaking(context)
    existing = context.existing_lanes
    dense = np.all(np.logical_or(queues, ~existing), axis=1) & np.any(existing, axis=1)
    return SignalColumns(
        {
            "congested": congested,
            "CONGESTED": congested,
            "walking_pace_flow": enough & (speeds < limits.walking_pace_kmh),
            "dense_all_lanes": dense,
            "far_lane_queue": _beside(context, queues & (queue_speeds < limits.slow_queue_kmh)),
            "overtaking": overtakes,
            # Where all lanes queue, one that is faster does not overtake (Vienna, Art. 11(6)(a))
            "being_overtaken": ~dense & overtaken,
        }
    )


def _close(context: DriveContext) -> Flags:
    reach = context.thresholds.flow_reach_m
    return context.going_along & (relations.gap(context) <= reach)


def _around(context: DriveContext) -> tuple[Floats, Floats]:
    close = _close(context)
    speeds = np.where(close, np.maximum(context.extents.along, 0.0), np.nan)
    with_own = np.concatenate((np.maximum(context.ego_extents.along, 0.0), speeds))
    return np.nanmedian(with_own, axis=0) * KMH, close.sum(axis=0) + 1


def _queues(context: DriveContext) -> tuple[Flags, Floats]:
    """Flags and median speeds (km/h) of queues, by state and lane.

    In a queue at least half of the gaps are short: up to ``queue_gap_m`` or ``queue_headway_s``.
    """
    limits = context.thresholds
    lanes = len(context.road.lanes.straight) - 1
    queue = np.zeros((context.states, lanes), dtype=bool)
    middle = np.full((context.states, lanes), np.nan)
    s_min = np.concatenate((context.ego_extents.s_min, context.extents.s_min))
    s_max = np.concatenate((context.ego_extents.s_max, context.extents.s_max))
    speed = np.maximum(np.concatenate((context.ego_extents.along, context.extents.along)), 0.0)
    own_lane = context.road.lane_of(np.concatenate((context.ego_extents.w, context.extents.w)))
    counted = np.concatenate((np.ones((1, context.states), dtype=bool), _close(context)))
    for lane in range(lanes):
        inside = counted & (own_lane == lane)
        enough = inside.sum(axis=0) >= limits.fewest
        for state in np.flatnonzero(enough):
            rows = np.flatnonzero(inside[:, state])
            rows = rows[np.argsort(s_min[rows, state])]
            gaps = s_min[rows[1:], state] - s_max[rows[:-1], state]
            allowed = np.maximum(
                limits.queue_gap_m, limits.queue_headway_s * speed[rows[:-1], state]
            )
            queue[state, lane] = np.mean(gaps <= allowed) >= 0.5
            middle[state, lane] = np.median(speed[rows, state]) * KMH
    return queue, middle


def _beside(context: DriveContext, lanes: Flags) -> Flags:
    lane = context.ego_lane + (1 if context.side == "right" else -1)
    inside = (lane >= 0) & (lane < lanes.shape[1])
    beside: Flags = inside & lanes[np.arange(context.states), np.clip(lane, 0, lanes.shape[1] - 1)]
    return beside


def _overtaking(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of ego overtaking a slower vehicle, and of a faster one overtaking ego.

    Who overtakes is at the far side, from shortly before it is beside the other; ego overtakes
    until it is just past.
    """
    limits = context.thresholds
    station, lateral = relations.station(context), relations.lateral(context)
    gap = relations.gap(context)
    sides = (relations.LEFT_OF, relations.RIGHT_OF)
    far, near = sides if context.side == "right" else sides[::-1]
    faster = context.ego_extents.along - context.extents.along
    ahead, beside = station == relations.IN_FRONT_OF, station == relations.BESIDE
    soon = (station == relations.BEHIND) & (gap <= faster * limits.catching_up_s)
    past = ahead & (gap <= context.ego_extents.along * limits.passed_s)
    closing = ahead & (gap <= -faster * limits.passed_s)
    overtakes = (faster > 0) & (lateral == far) & (soon | beside | past)
    overtaken = (faster < 0) & (lateral == near) & (closing | beside)
    return (
        (context.going_along & overtakes).any(axis=0),
        (context.going_along & overtaken).any(axis=0),
    )

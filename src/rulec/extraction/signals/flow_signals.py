"""What traffic around ego is like: queues, congestion, who overtakes whom.

All of it counts the vehicles that go ego's way on its lanes, ego among them, not farther away than
``flow_reach_m``. Queues are those of lanes, and a lane's vehicles are those whose middle is in it.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats


def flow_signals(view: DriveContext) -> SignalColumns:
    """Words about traffic as a whole."""
    limits = view.thresholds
    speeds, counts = _around(view)
    enough = counts >= limits.fewest
    congested = enough & (speeds < limits.congested_kmh)
    queues, queue_speeds = _queues(view)
    there = view.road.lanes_at(view.own.s[0])
    dense = np.all(np.logical_or(queues, ~there), axis=1) & np.any(there, axis=1)
    return SignalColumns(
        {
            "congested": congested,
            "CONGESTED": congested,
            "walking_pace_flow": enough & (speeds < limits.walking_pace_kmh),
            "dense_all_lanes": dense,
            "far_lane_queue": _beside(view, queues & (queue_speeds < limits.slow_queue_kmh)),
            "overtaking": _overtaking(view),
            # Where all lanes queue, one that is faster does not overtake (Vienna, Art. 11(6)(a))
            "being_overtaken": ~dense & _being_overtaken(view),
        }
    )


def _close(view: DriveContext) -> Flags:
    reach = view.thresholds.flow_reach_m
    return view.with_ego & (relations.gap(view.own, view.others) <= reach)


def _around(view: DriveContext) -> tuple[Floats, Floats]:
    """The median speed (km/h) of the vehicles around ego and itself, and how many they are."""
    close = _close(view)
    speeds = np.where(close, np.maximum(view.others.along, 0.0), np.nan)
    with_own = np.concatenate((np.maximum(view.own.along, 0.0), speeds))
    return np.nanmedian(with_own, axis=0) * KMH, close.sum(axis=0) + 1


def _queues(view: DriveContext) -> tuple[Flags, Floats]:
    """For every state and lane: is there a queue, and what is its median speed (km/h)?"""
    limits = view.thresholds
    lanes = len(view.road.lanes.straight) - 1
    queue = np.zeros((view.states, lanes), dtype=bool)
    middle = np.full((view.states, lanes), np.nan)
    s_min = np.concatenate((view.own.s_min, view.others.s_min))
    s_max = np.concatenate((view.own.s_max, view.others.s_max))
    speed = np.maximum(np.concatenate((view.own.along, view.others.along)), 0.0)
    own_lane = view.road.lane_of(np.concatenate((view.own.w, view.others.w)))
    there = np.concatenate((np.ones((1, view.states), dtype=bool), _close(view)))
    for lane in range(lanes):
        inside = there & (own_lane == lane)
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


def _beside(view: DriveContext, lanes: Flags) -> Flags:
    """Is it so on the lane at ego's far side?"""
    lane = view.lane + (1 if view.side == "right" else -1)
    inside = (lane >= 0) & (lane < lanes.shape[1])
    found: Flags = inside & lanes[np.arange(view.states), np.clip(lane, 0, lanes.shape[1] - 1)]
    return found


def _sides(view: DriveContext) -> tuple[Flags, Flags]:
    """Whom is ego on the far side of, and whom on the near side of?"""
    lateral = relations.lateral(view.own, view.others, view.touched, view.road)
    left, right = lateral == relations.LEFT_OF, lateral == relations.RIGHT_OF
    return (left, right) if view.side == "right" else (right, left)


def _overtaking(view: DriveContext) -> Flags:
    """Is ego beside a slower one on its far side, about to be, or just past it?"""
    limits = view.thresholds
    far, _ = _sides(view)
    station = relations.station(view.own, view.others)
    gap = relations.gap(view.own, view.others)
    faster = view.own.along - view.others.along
    soon = (station == relations.BEHIND) & (gap <= faster * limits.catching_up_s)
    beside = station == relations.BESIDE
    past = (station == relations.IN_FRONT_OF) & (gap <= view.own.along * limits.passed_s)
    slower = view.with_ego & (faster > 0)
    found: Flags = (slower & far & (soon | beside | past)).any(axis=0)
    return found


def _being_overtaken(view: DriveContext) -> Flags:
    """Is a faster one beside ego, with ego on its near side, or about to be?"""
    limits = view.thresholds
    _, near = _sides(view)
    station = relations.station(view.own, view.others)
    gap = relations.gap(view.own, view.others)
    faster = view.others.along - view.own.along
    soon = (station == relations.IN_FRONT_OF) & (gap <= faster * limits.passed_s)
    beside = station == relations.BESIDE
    found: Flags = (view.with_ego & (faster > 0) & near & (soon | beside)).any(axis=0)
    return found

"""Queues of vehicles that go ego's way, lane by lane, and which lanes tell of them.

Those count that are not farther away than ``flow_reach_m``, or than where ``fewest`` vehicles of a
queue at ego's speed have room. A lane's vehicles are those whose middle is in it.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.tracks.tracks import Flags, Floats

_BODY_M = 5.0
"""About how long a vehicle is."""

_HAIR_M = 0.01

_SIDE_LANE_M = 300.0
"""A lane that begins or ends no farther away is one to join or to leave by."""

_UNEVEN_M = 20.0
"""By so much maps cut their lanes off unevenly."""

_MOST = 0.5
"""More than this part of a queue's gaps are short."""

READINGS = range(3)
MEASURED, STRICT, LOOSE = READINGS
"""What counts as a short gap: as measured, whatever is wrong, and what some call a queue, too."""


def lanes_that_decide(context: DriveContext) -> Flags:
    """Flags of lanes (second axis) that go on, and on which a queue would show.

    A lane that is a short acceleration lane here, or of which the map ends soon, has no room for
    ``fewest`` vehicles at the largest distances of a queue.
    """
    room = _length_near(context, context.road.lanes.there, _reach(context))
    return (room >= _shortest_queue(context)[:, None] - _HAIR_M) & _goes_on(context)


def _length_near(context: DriveContext, where: Flags, reach_m: Floats | float) -> Floats:
    """How much (m) of each lane (second axis) is ``where``, up to so far from ego, by state."""
    s, own = context.road.lanes.s, context.ego_extents.s[0]
    sums = np.cumsum(where * np.diff(s)[:, None], axis=0)
    columns = np.concatenate((np.zeros((1, sums.shape[1])), sums)).T
    reach: Floats = np.broadcast_to(reach_m, own.shape)
    near, far = own - reach, own + reach
    return np.stack([np.interp(far, s, up) - np.interp(near, s, up) for up in columns], axis=1)


def _goes_on(context: DriveContext) -> Flags:
    """Flags of lanes (second axis) that neither begin nor end near ego while others go on.

    An acceleration lane does, and one between two ramps: who is on it is about to leave it.
    """
    lanes = context.road.lanes
    only_others = np.any(lanes.there, axis=1, keepdims=True) & ~lanes.there
    goes_on: Flags = _length_near(context, only_others, _SIDE_LANE_M) <= _UNEVEN_M
    return goes_on


def _shortest_queue(context: DriveContext) -> Floats:
    """How much (m) ``fewest`` vehicles take up at the largest distances of a queue, by state."""
    limits, speed = context.thresholds, context.ego_extents.along[0]
    gap = np.maximum(limits.queue_gap_m, limits.queue_headway_s * speed)
    length: Floats = limits.fewest * (gap + _BODY_M)
    return length


def longest_gaps(context: DriveContext, speed: Floats, speed_error: Floats) -> Floats:
    """The longest gap (m) in a queue behind which one drives at ``speed`` (m/s), by reading."""
    limits = context.thresholds
    wrong = limits.queue_headway_s * np.nan_to_num(speed_error)
    wrong = np.hypot(context.tolerances.place_m, wrong)
    longest, loose = (
        np.maximum(limits.queue_gap_m, headway_s * speed)
        for headway_s in (limits.queue_headway_s, limits.loose_headway_s)
    )
    return np.stack((longest, longest - wrong, loose + wrong))


def _reach(context: DriveContext) -> Floats:
    """How far (m) ahead and behind traffic is looked at, by state."""
    limits = context.thresholds
    far = np.minimum(_shortest_queue(context) / 2, limits.near_m)
    return np.maximum(limits.flow_reach_m, far)


def close_by(context: DriveContext) -> Flags:
    """Flags of vehicles that go ego's way and are part of the traffic around it."""
    return context.going_along & (relations.gap(context) <= _reach(context))


def queues_by_lane(context: DriveContext) -> tuple[tuple[Flags, ...], Floats]:
    """Flags and median speeds (km/h) of queues, by state and lane.

    In a queue more than half of the gaps are short. The flags are by what counts as short.
    """
    limits = context.thresholds
    lanes = context.existing_lanes.shape[1]
    queues = np.zeros((len(READINGS), context.states, lanes), dtype=bool)
    middle = np.full((context.states, lanes), np.nan)
    s_min, s_max, along, own_lane = (
        np.concatenate((getattr(context.ego_extents, name), getattr(context.extents, name)))
        for name in ("s_min", "s_max", "along", "lane")
    )
    speed = np.maximum(along, 0.0)
    error = np.concatenate((context.ego.speed_error, context.tracks.speed_error))
    longest = longest_gaps(context, speed, error)
    counted = np.concatenate((np.ones((1, context.states), dtype=bool), close_by(context)))
    for lane in range(lanes):
        inside = counted & (own_lane == lane)
        enough = inside.sum(axis=0) >= limits.fewest
        for state in np.flatnonzero(enough):
            rows = np.flatnonzero(inside[:, state])
            rows = rows[np.argsort(s_min[rows, state])]
            behind = rows[:-1]
            gaps = s_min[rows[1:], state] - s_max[behind, state]
            short = gaps <= longest[:, behind, state]
            queues[:, state, lane] = short.mean(axis=1) > _MOST
            middle[state, lane] = np.median(speed[rows, state]) * KMH
    return tuple(queues), middle

"""Signals of traffic flow around ego: queues, congestion, overtaking.

All of it counts the vehicles that go ego's way on its lanes, ego among them, not farther away than
``flow_reach_m``, or than where ``fewest`` vehicles of a queue at ego's speed have room. Queues are
those of lanes, and a lane's vehicles are those whose middle is in it.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats

_BODY_M = 5.0
"""About how long a vehicle is."""

_HAIR_M = 0.01


def flow_signals(context: DriveContext) -> SignalColumns:
    """The signals of traffic as a whole."""
    limits = context.thresholds
    speeds, counts = _around(context)
    enough = counts >= limits.fewest
    congested = enough & (speeds < limits.congested_kmh)
    queues, queue_speeds = _queues(context)
    overtakes, unsure, overtaken, open_end = _overtaking(context)
    decides = context.existing_lanes & (_seen(context) | queues)
    dense = np.all(queues | ~decides, axis=1) & np.any(decides, axis=1)
    # Whom nobody is ahead of goes as fast as it likes, unless that one is not recorded any more
    ahead = _ahead_in_lane(context)
    near = relations.gap(context) <= _longest_gap(context)
    cut_off = dense & ~ahead.any(axis=0) & ("light" not in context.recording.complete)
    dense &= (ahead & near).any(axis=0)
    # Lanes that move off beside each other do not overtake
    moot = cut_off | _sets_off(context)
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
        },
        unknown={
            "dense_all_lanes": ~np.any(decides, axis=1) | cut_off,
            "overtaking": unsure & ~overtakes,
            "being_overtaken": ~dense & np.where(overtaken, moot, open_end),
        },
    )


def _ahead_in_lane(context: DriveContext) -> Flags:
    """Flags of who is ahead of ego in its lane, as far as traffic reaches."""
    own_lane = context.road.lane_of(context.extents.w) == context.ego_lane
    ahead: Flags = _close(context) & (relations.station(context) == relations.BEHIND) & own_lane
    return ahead


def _sets_off(context: DriveContext) -> Flags:
    """Flags of states in which ego has stood up to ``setting_off_s`` ago."""
    limits, speed = context.thresholds, context.ego.speed[0]
    stands = speed * KMH < limits.standing_kmh
    steps = round(limits.setting_off_s / context.recording.step_s)
    stood = np.maximum.accumulate(np.where(stands, np.arange(context.states), -1 - steps))
    return np.arange(context.states) - stood <= steps


def _seen(context: DriveContext) -> Flags:
    """Flags of lanes (second axis) of which the map has so much that a queue on them would show.

    A lane that is a short acceleration lane here, or of which the map ends soon, has no room for
    ``fewest`` vehicles at the largest distances of a queue.
    """
    lanes, reach = context.road.lanes, _reach(context)
    places = np.stack([context.ego_extents.s[0] + way * reach for way in (-1, 1)], axis=-1)
    # How much there is of each lane from the road's beginning to each place
    sums = np.cumsum(lanes.there * np.diff(lanes.s)[:, None], axis=0)
    columns = np.concatenate((np.zeros((1, sums.shape[1])), sums)).T
    seen = np.stack(
        [np.diff(np.interp(places, lanes.s, column))[:, 0] for column in columns], axis=1
    )
    room: Flags = seen >= _shortest_queue(context)[:, None] - _HAIR_M
    return room


def _shortest_queue(context: DriveContext) -> Floats:
    """How much (m) ``fewest`` vehicles take up at the largest distances of a queue, by state."""
    length: Floats = context.thresholds.fewest * (_longest_gap(context) + _BODY_M)
    return length


def _longest_gap(context: DriveContext) -> Floats:
    """The longest gap (m) in a queue at ego's speed, by state."""
    limits = context.thresholds
    speed = context.ego_extents.along[0]
    gap: Floats = np.maximum(limits.queue_gap_m, limits.queue_headway_s * speed)
    return gap


def _reach(context: DriveContext) -> Floats:
    """How far (m) ahead and behind traffic is looked at, by state."""
    limits = context.thresholds
    far = np.minimum(_shortest_queue(context) / 2, limits.near_m)
    return np.maximum(limits.flow_reach_m, far)


def _close(context: DriveContext) -> Flags:
    return context.going_along & (relations.gap(context) <= _reach(context))


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


def _overtaking(context: DriveContext) -> tuple[Flags, Flags, Flags, Flags]:
    """Flags of ego overtaking a slower vehicle, perhaps so, and of a faster one overtaking ego.

    Who overtakes is at the far side, from shortly before it is beside the other; ego overtakes
    until it is just past. One that overtakes ego is on the next lane, clearly faster, and gets past
    within ``catching_up_s``. The last are flags of states after which it is lost from sight.
    """
    limits = context.thresholds
    station, lateral = relations.station(context), relations.lateral(context)
    gap = relations.gap(context)
    sides = (relations.LEFT_OF, relations.RIGHT_OF)
    far, near = sides if context.side == "right" else sides[::-1]
    faster = context.ego_extents.along - context.extents.along
    ahead, beside = station == relations.IN_FRONT_OF, station == relations.BESIDE
    surely, perhaps = (_ahead_and_past(context, more) for more in (0.0, 1.0))
    slower = (faster > 0) & (lateral == far) & context.driving_along
    closing = ahead & (gap <= -faster * limits.passed_s)
    clearly = -faster * KMH >= limits.clearly_faster_kmh
    comes = clearly & (lateral == near) & _on_next_lane(context) & (closing | beside)
    comes &= context.going_along
    gets_past, lost = _gets_past(context, station == relations.BEHIND)
    return (
        (slower & (surely | beside)).any(axis=0),
        (slower & perhaps).any(axis=0),
        (comes & gets_past).any(axis=0),
        (comes & lost).any(axis=0),
    )


def _ahead_and_past(context: DriveContext, tolerances: float) -> Flags:
    """Flags of participants that ego will be beside soon, or has just been, if it overtakes.

    With so many tolerances of places and speeds added to what is as far as that.
    """
    limits, known = context.thresholds, context.tolerances
    station, gap = relations.station(context), relations.gap(context)
    own, other = context.ego_extents.along, context.extents.along
    far_ahead = (own - other + 2 * tolerances * known.speed_mps) * limits.catching_up_s
    far_behind = (own + tolerances * known.speed_mps) * limits.passed_s
    reach = np.where(station == relations.BEHIND, far_ahead, far_behind)
    near: Flags = (gap <= reach + tolerances * known.place_m) & (station != relations.BESIDE)
    return near


def _on_next_lane(context: DriveContext) -> Flags:
    """Flags of participants that reach into the lane at ego's far side."""
    lane = context.ego_lane + (1 if context.side == "right" else -1)
    lanes = np.arange(context.touched.shape[-1])
    on: Flags = (context.touched & (lanes == lane[None, :, None])).any(axis=-1)
    return on


def _gets_past(context: DriveContext, past: Flags) -> tuple[Flags, Flags]:
    """Flags of participants that are past within ``catching_up_s``, and of those lost before."""
    horizon = round(context.thresholds.catching_up_s / context.recording.step_s)
    states = np.arange(context.states)
    seen = context.relevant
    never = len(states) + horizon
    next_past = np.minimum.accumulate(np.where(past & seen, states, never)[:, ::-1], axis=1)[
        :, ::-1
    ]
    absent = np.where(seen, len(states), states)
    next_absent = np.minimum.accumulate(absent[:, ::-1], axis=1)[:, ::-1]
    gets_past = next_past <= states + horizon
    return gets_past, ~gets_past & (next_absent <= states + horizon)

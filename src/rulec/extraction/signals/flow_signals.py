"""Signals of traffic flow around ego: queues, congestion, overtaking.

All of it counts the vehicles that go ego's way on its lanes, ego among them, as queues do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.queues import (
    WAYS,
    close_by,
    gap_error,
    lanes_that_decide,
    longest_gap,
    queues_by_lane,
)
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats

_SETS_OFF_MPS2 = 2.0
"""Vehicles gain speed about so hard when they set off."""


def flow_signals(context: DriveContext) -> SignalColumns:
    """The signals of traffic as a whole."""
    limits = context.thresholds
    speeds, counts = _around(context)
    enough = counts >= limits.fewest
    congested = enough & (speeds < limits.congested_kmh)
    queues, queue_speeds = queues_by_lane(context)
    overtakes, unsure, overtaken, open_end = _overtaking(context)
    dense, surely, not_told = _dense_lines(context, queues)
    queue, fewer, more = (
        _beside(context, lanes & (queue_speeds < limits.slow_queue_kmh)) for lanes in queues
    )
    # Lanes that move off beside each other do not overtake
    moot = _sets_off(context) | not_told
    return SignalColumns(
        {
            "congested": congested,
            "CONGESTED": congested,
            "walking_pace_flow": enough & (speeds < limits.walking_pace_kmh),
            "dense_all_lanes": dense,
            "far_lane_queue": queue,
            "overtaking": overtakes,
            # Where all lanes queue, one that is faster does not overtake (Vienna, Art. 11(6)(a))
            "being_overtaken": ~dense & overtaken,
        },
        unknown={
            "dense_all_lanes": not_told,
            "far_lane_queue": more & ~fewer,
            "overtaking": unsure & ~overtakes,
            "being_overtaken": ~surely & np.where(overtaken, moot, open_end),
        },
    )


def _dense_lines(context: DriveContext, queues: Sequence[Flags]) -> tuple[Flags, Flags, Flags]:
    """Flags of states with queues on all lanes, surely so, and of those where nobody knows."""
    counts = lanes_that_decide(context)
    decides = [context.existing_lanes & (counts | queue) for queue in queues]
    all_queue = [
        np.all(queue | ~deciding, axis=1) & np.any(deciding, axis=1)
        for queue, deciding in zip(queues, decides, strict=True)
    ]
    # Whom nobody is ahead of goes as fast as it likes, unless that one is not recorded any more
    ahead = _ahead_in_lane(context)
    cut_off = all_queue[-1] & ~ahead.any(axis=0) & ("light" not in context.recording.complete)
    gap, longest = relations.gap(context), longest_gap(context)
    wrong = gap_error(context, context.ego.speed_error[0])
    dense, surely, perhaps = (
        lines & (ahead & (gap <= longest + way * wrong)).any(axis=0)
        for lines, way in zip(all_queue, WAYS, strict=True)
    )
    # Nor is there a queue where the world ends, whose traffic is all recorded
    nobody_knows = ~np.any(decides[0], axis=1) & ("light" not in context.recording.complete)
    return dense, surely, perhaps & ~surely | cut_off | nobody_knows


def _ahead_in_lane(context: DriveContext) -> Flags:
    """Flags of who is ahead of ego in its lane, as far as traffic reaches."""
    own_lane = context.road.lane_of(context.extents.w) == context.ego_lane
    ahead: Flags = close_by(context) & (relations.station(context) == relations.BEHIND) & own_lane
    return ahead


def _sets_off(context: DriveContext) -> Flags:
    """Flags of states in which ego has, or may have, stood up to ``setting_off_s`` ago.

    Before its drive began it may have, if ``_SETS_OFF_MPS2`` has made it as fast as it is then, and
    not all traffic is recorded.
    """
    limits, speed, step_s = context.thresholds, context.ego.speed[0], context.recording.step_s
    stands = speed * KMH < limits.standing_kmh
    whole = "light" in context.recording.complete
    before = -np.inf if whole else -np.ceil(speed[0] / _SETS_OFF_MPS2 / step_s)
    stood = np.maximum.accumulate(np.where(stands, np.arange(context.states), before))
    sets_off: Flags = (np.arange(context.states) - stood) * step_s < limits.setting_off_s
    return sets_off


def _around(context: DriveContext) -> tuple[Floats, Floats]:
    close = close_by(context)
    speeds = np.where(close, np.maximum(context.extents.along, 0.0), np.nan)
    with_own = np.concatenate((np.maximum(context.ego_extents.along, 0.0), speeds))
    return np.nanmedian(with_own, axis=0) * KMH, close.sum(axis=0) + 1


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
    """Flags of participants that reach into the lane beside ego's at its far side.

    While ego is on a mark that is the lane that it moves into, and none beyond.
    """
    straight, own = context.road.lanes.straight, context.ego_extents
    low, high = own.w_min[0][:, None], own.w_max[0][:, None]
    inside = np.minimum(high, straight[1:]) - np.maximum(low, straight[:-1])
    lanes = np.arange(context.touched.shape[-1])
    used = (inside > context.thresholds.touching_m) | (lanes == context.ego_lane[:, None])
    if context.side == "right":
        lane = used.argmax(axis=1) + 1
    else:
        lane = len(lanes) - 2 - used[:, ::-1].argmax(axis=1)
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

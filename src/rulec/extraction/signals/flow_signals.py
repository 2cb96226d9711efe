"""Signals of traffic flow around ego: queues, congestion, overtaking.

All of it counts the vehicles that go ego's way on its lanes, ego among them, as queues do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.queues import (
    LOOSE,
    close_by,
    lanes_that_decide,
    longest_gaps,
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
    overtakes, unsure = _overtaking(context)
    overtaken, open_end = _overtaken(context)
    dense, surely, not_told = _dense_lines(context, queues)
    slow = [lanes & (queue_speeds < limits.slow_queue_kmh) for lanes in queues]
    queue, fewer, _ = (_beside(context, lanes) for lanes in slow)
    # Whether one farther out is the queue beside ego's lane depends on who is passed
    more = _at_far_side(context, slow[LOOSE])
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
    cut_off = all_queue[LOOSE] & ~ahead.any(axis=0) & ("light" not in context.recording.complete)
    gap, speed = relations.gap(context), context.ego_extents.along[0]
    longest = longest_gaps(context, speed, context.ego.speed_error[0])
    dense, surely, perhaps = (
        lines & (ahead & (gap <= most)).any(axis=0)
        for lines, most in zip(all_queue, longest, strict=True)
    )
    # Nor is there a queue where the world ends, whose traffic is all recorded
    nobody_knows = ~np.any(decides[0], axis=1) & ("light" not in context.recording.complete)
    return dense, surely, perhaps & ~surely | cut_off | nobody_knows


def _ahead_in_lane(context: DriveContext) -> Flags:
    """Flags of who is ahead of ego in its lane, as far as traffic reaches."""
    own_lane = context.extents.lane == context.ego_lane
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


def _at_far_side(context: DriveContext, lanes: Flags) -> Flags:
    """Whether a lane of those flagged lies at ego's far side, by state."""
    number, own = np.arange(lanes.shape[1]), context.ego_lane[:, None]
    far = number > own if context.side == "right" else number < own
    there: Flags = np.any(lanes & far, axis=1)
    return there


def _beside(context: DriveContext, lanes: Flags) -> Flags:
    lane = context.ego_lane + (1 if context.side == "right" else -1)
    inside = (lane >= 0) & (lane < lanes.shape[1])
    beside: Flags = inside & lanes[np.arange(context.states), np.clip(lane, 0, lanes.shape[1] - 1)]
    return beside


def _overtaking(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of ego overtaking a slower vehicle, and of it perhaps doing so.

    Who overtakes is at the far side, from shortly before it is beside the other until it is just
    past.
    """
    far, _ = _sides(context)
    beside = relations.station(context) == relations.BESIDE
    slower: Flags = context.extents.along < context.ego_extents.along
    slower &= (relations.lateral(context) == far) & context.driving_along
    surely: Flags = np.any(slower & (_ahead_and_past(context, 0.0) | beside), axis=0)
    perhaps: Flags = np.any(slower & _ahead_and_past(context, 1.0), axis=0)
    return surely, perhaps


def _overtaken(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of ego being overtaken, and of states after which nobody knows whether it was.

    Who overtakes ego is with its middle on the next lane at the far side, clearly faster, and gets
    past within ``catching_up_s``. Nobody knows of one that is lost from sight before, or that only
    reaches into that lane.
    """
    limits, station = context.thresholds, relations.station(context)
    _, near = _sides(context)
    faster_mps = context.extents.along - context.ego_extents.along
    ahead, beside = station == relations.IN_FRONT_OF, station == relations.BESIDE
    closing = ahead & (relations.gap(context) <= faster_mps * limits.passed_s)
    comes = (closing | beside) & (faster_mps * KMH >= limits.clearly_faster_kmh)
    comes &= (relations.lateral(context) == near) & context.going_along
    gets_past, lost = _gets_past(context, station == relations.BEHIND)
    next_lane = _next_lane(context)
    reaches, lanes = context.touched, np.arange(context.touched.shape[-1])
    reaches = (reaches & (lanes == next_lane[None, :, None])).any(axis=-1)
    inside = reaches & (context.extents.lane == next_lane)
    open_end = comes & (reaches & lost | reaches & ~inside & gets_past)
    return (comes & inside & gets_past).any(axis=0), open_end.any(axis=0)


def _sides(context: DriveContext) -> tuple[int, int]:
    """Ego's sides of one that it overtakes, and of one that overtakes it."""
    sides = (relations.LEFT_OF, relations.RIGHT_OF)
    return sides if context.side == "right" else sides[::-1]


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


def _next_lane(context: DriveContext) -> NDArray[intp]:
    """The lane beside ego's at its far side by state; there may be none of that number.

    While ego is on a mark that is the lane that it moves into, and none beyond.
    """
    lanes, inside = np.arange(context.touched.shape[-1]), context.ego_extents.inside[0]
    used = (inside > context.thresholds.touching_m) | (lanes == context.ego_lane[:, None])
    next_lane: NDArray[intp] = (
        used.argmax(axis=1) + 1
        if context.side == "right"
        else len(lanes) - 2 - used[:, ::-1].argmax(axis=1)
    )
    return next_lane


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

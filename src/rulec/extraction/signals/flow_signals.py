"""Signals of traffic flow around ego: queues and congestion.

All of them count the vehicles that go ego's way on its lanes, including ego, as queues do.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import travel_lanes_first
from rulec.extraction.signals.queues import (
    LOOSE,
    MEASURED,
    READINGS,
    STRICT,
    VehiclesAround,
    dense_lines,
    gap_in_lane,
    longest_gaps,
    queues_by_lane,
    vehicles_around,
)
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.words import word
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import medians_hold

TIMES_AS_FAST = 2.0
"""A lane flows if several vehicles on it are this many times as fast as slow traffic."""

_JAM_S = 10.0
"""Traffic that has been slow for less (s) may be so because a vehicle pulls in or turns off."""


@word("congested", "CONGESTED", "walking_pace_flow")
def _slow_traffic(context: DriveContext) -> SignalColumns:
    """Whether traffic is slow as a whole, with no lane flowing, nor all lanes except ego's.

    Vehicles that queue to leave, beside lanes that flow or are empty, are no jam of the road: slow
    vehicles have to be on at least half of its lanes. Unknown if, without those in junctions, they
    are on no more than half, since they may wait to turn there; if no vehicle is ahead of ego, as
    the others may be waiting for ego; if a cycle is, or all are in one line whose leader drives
    freely, as all may be behind that one; and for the first ``_JAM_S`` of slow traffic.
    """
    around, limits, states = vehicles_around(context), context.thresholds, context.states
    existing = travel_lanes_first(context)
    several = existing.sum(axis=0)
    enough = around.counts.sum(axis=0) >= limits.fewest

    def used_by(own: NDArray[intp]) -> NDArray[intp]:
        on_lanes = np.zeros(existing.size, dtype=bool)
        on_lanes[around.place.take(own)] = True
        used: NDArray[intp] = (on_lanes.reshape(existing.shape) & existing).sum(axis=0)
        return used

    def slow(below_kmh: float) -> tuple[Flags, Flags]:
        own = (around.speed * KMH_PER_MPS < below_kmh).nonzero()[0]
        called: Flags = enough & (2 * used_by(own) >= several)
        if not called.any():
            return called, called
        called &= _is_slow(context, around, called.take(around.state).nonzero()[0], below_kmh)
        aside = own[~_in_junctions(context, around, own)]
        return called, called & (several > 1) & (2 * used_by(aside) <= several)

    (congested, part), (walking, part_walks) = (
        slow(below) for below in (limits.congested_kmh, limits.walking_pace_kmh)
    )
    moot = np.zeros(states, dtype=bool)
    if congested.any():
        moot = np.isinf(gap_in_lane(context, relations.BEHIND)) | _comes_up(context, congested)
        moot |= _is_behind_cycle(context) | _is_behind_moving_bottleneck(context, congested)
    jam = Truth(congested & ~(part | moot), congested)
    walks = Truth(walking & ~(part_walks | moot), walking)
    return SignalColumns({"congested": jam, "CONGESTED": jam, "walking_pace_flow": walks})


def _in_junctions(context: DriveContext, around: VehiclesAround, chosen: NDArray[intp]) -> Flags:
    """Mask of the chosen vehicles that are in junctions of ego's road."""
    s_min, s_max = around.s_min.take(chosen), around.s_max.take(chosen)
    inside = np.zeros(len(chosen), dtype=bool)
    for start, end in context.road.junctions:
        inside |= (s_max > start) & (s_min < end)
    return inside


def _is_behind_cycle(context: DriveContext) -> Flags:
    """Mask of states in which a cycle is ahead in ego's lane, within ``flow_reach_m``."""
    rows = context.tracks.of_type("light_rider").nonzero()[0]
    in_lane = context.extents.lane[rows] == context.ego_lane
    ahead = context.relevant[rows] & (relations.station(context)[rows] == relations.BEHIND)
    near = relations.gap(context)[rows] <= context.thresholds.flow_reach_m
    found: Flags = (in_lane & ahead & near & context.on_lanes[rows]).any(axis=0)
    return found


def _is_behind_moving_bottleneck(context: DriveContext, slow: Flags) -> Flags:
    """Mask of ``slow`` states with all traffic in ego's lane, behind a leader that drives freely.

    A leader such as a tractor: the first of ego's line, with nobody close ahead of it.
    """
    own, others, around = context.ego_extents, context.extents, vehicles_around(context)
    found = np.zeros(context.states, dtype=bool)
    one_line = slow & (((around.counts > 0) & travel_lanes_first(context)).sum(axis=0) <= 1)
    if not one_line.any():
        return found
    ahead = context.driving_along & (others.lane == context.ego_lane)
    cells = Cells.at(ahead & (relations.station(context) == relations.BEHIND) & one_line)
    egos = one_line.nonzero()[0]

    def of_all(of_ego: NDArray[Any], of_others: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate((of_ego[0, egos], cells.of(of_others)))

    states = np.concatenate((egos, cells.columns))
    s_min, s_max, speed, speed_error = (
        of_all(own.s_min, others.s_min),
        of_all(own.s_max, others.s_max),
        of_all(own.along, others.along),
        of_all(context.ego.speed_error, context.tracks.speed_error),
    )
    order = np.lexsort((s_min, states))
    after = np.append(order[1:], order[0])
    gaps = np.where(states[after] == states[order], s_min[after] - s_max[order], np.inf)
    apart = gaps > longest_gaps(context, speed[order], speed_error[order])[LOOSE]
    leaders = order[apart]
    state, nearest = np.unique(states[leaders], return_index=True)
    found[state] = speed[leaders[nearest]] * KMH_PER_MPS >= context.thresholds.standing_kmh
    return found


def _comes_up(context: DriveContext, slow: Flags) -> Flags:
    """Mask of states less than ``_JAM_S`` after traffic was not slow, as far as that is recorded.

    Where all traffic is recorded, ego was in none before its drive began.
    """
    spans, before = context.spans, context.spans.latest(~slow)
    ago_s = (spans.columns - before) * context.recording.step_s
    told = (before >= spans.first) | ("arrivals" in context.recording.complete)
    comes_up: Flags = told & (ago_s < _JAM_S)
    return comes_up


def _is_slow(
    context: DriveContext, around: VehiclesAround, asked: NDArray[intp], below_kmh: float
) -> Flags:
    """Mask of states in which traffic is below ``below_kmh``, and nowhere ``TIMES_AS_FAST`` that.

    ``asked`` are the indices of all vehicles in the states to be tested. A lane with at most one
    vehicle does not count as flowing.
    """

    def are_below(limit_kmh: float, groups: NDArray[intp], own: NDArray[intp], count: int) -> Flags:
        return medians_hold(
            groups.take(own),
            around.speed.take(own),
            count,
            lambda mps: mps * KMH_PER_MPS < limit_kmh,
        )

    state, place, fast_kmh = around.state, around.place, TIMES_AS_FAST * below_kmh
    slow = are_below(below_kmh, state, asked, context.states)
    asked = asked[slow[state.take(asked)]]
    if not len(asked):
        return slow
    few = around.counts <= 1
    on_lanes = few | are_below(fast_kmh, place, asked, few.size).reshape(few.shape)
    aside = asked[around.lane.take(asked) != context.ego_lane[state.take(asked)]]
    alone = np.bincount(state.take(aside), minlength=context.states) <= 1
    beside = alone | are_below(fast_kmh, state, aside, context.states)
    return slow & on_lanes.all(axis=0) & beside


@word("dense_all_lanes")
def _dense_all_lanes(context: DriveContext) -> Truth:
    dense, _, not_told = dense_lines(context)
    return Truth.known(dense).unknown_at(not_told)


@word("far_lane_queue")
def _far_lane_queue(context: DriveContext) -> Truth:
    queues, are_slow = queues_by_lane(context)
    slow = queues & are_slow
    queue, fewer = (_beside(context, slow[reading]) for reading in (MEASURED, STRICT))
    # Whether a lane farther out is the queue beside ego's depends on the vehicle that is passed
    more = _at_far_side(context, slow[LOOSE])
    return Truth.known(queue).unknown_at(more & ~fewer)


@word("own_lane_queue")
def _own_lane_queue(context: DriveContext) -> Truth:
    """Whether ego's lane is a slow queue; unknown where errors or the definition decide."""
    queues, are_slow = queues_by_lane(context)
    slow = queues & are_slow
    queue, fewer, more = (
        slow[reading, context.ego_lane, context.spans.columns] for reading in READINGS
    )
    return Truth.known(queue).unknown_at(more & ~fewer)


def _at_far_side(context: DriveContext, lanes: Flags) -> Flags:
    """Whether one of the flagged lanes (first axis) lies at ego's far side, by state."""
    number, own = np.arange(len(lanes))[:, None], context.ego_lane
    far = number > own if context.side == "right" else number < own
    there: Flags = np.logical_or.reduce(lanes & far)
    return there


def _beside(context: DriveContext, lanes: Flags) -> Flags:
    lane = context.ego_lane + (1 if context.side == "right" else -1)
    inside = (lane >= 0) & (lane < len(lanes))
    lane = np.minimum(np.maximum(lane, 0), len(lanes) - 1)
    beside: Flags = inside & lanes[lane, context.spans.columns]
    return beside

"""The room beyond the junction or crossing that ego enters, or waits before."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.map.level_crossing_signals import level_crossings
from rulec.extraction.signals.measured_numbers import corner_ahead
from rulec.extraction.signals.signal_columns import Caused, ids_by_state
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import Stretches
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.partly_known.partly_known_values import Truth

ROOM_M = 1.0
"""Distance (m) that a standing vehicle leaves to the one ahead."""

_AT_PLACE_M = 10.0
"""Ego waits before a place if its front is at most this far (m) from it."""


@word("exit_clear")
def exit_clear(context: DriveContext) -> Caused:
    """Whether ego has room behind the place that it enters; and where that is unknown.

    There is none if a vehicle ahead, at walking pace at most while ego stands, leaves too little
    room behind the place, so that ego has to stand on it where others cross or join its way.
    Unknown where the recording ends before ego is through, where tolerances decide whether ego
    stands there, and for a vehicle ahead that always stands: ego may wait to drive round it. The
    place is the last one that ego has reached, and before any the next one.
    """
    places = _places(context)
    clear, doubtful = np.ones(context.states, dtype=bool), np.zeros(context.states, dtype=bool)
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    stands = ~context.ego_moves
    entered = _entered(front, rear, places, context.thresholds.approach_m)
    if not any((entered == number).any() for number in range(len(places))):
        nobody = np.zeros(context.relevant.shape, dtype=bool)
        return _room_beyond(context, Truth.known(clear), nobody)
    error = context.tolerances.place_m
    beyond = corner_ahead(context) + error
    ahead = _ahead_on_lane(context)
    still, nearest = _standing_rows(context, ahead), np.zeros_like(ahead)
    holds_up = context.tracks.speed * KMH_PER_MPS < context.thresholds.walking_pace_kmh
    for number, (start, end) in enumerate(places):
        nears, passed = entered == number, context.spans.any(rear >= end)
        place = _shared(context, start, end)
        stuck = (front - beyond > place) & (rear + beyond < end) & stands
        about_there = (front + error > place) & (rear - error < end) & stands
        if not (nears & (~passed | context.spans.any(about_there))).any():
            continue
        short, short_for_all, stops, all_stop = (
            _free_beyond(context, those, (start, end)) < front - rear + ROOM_M
            for those in (ahead & ~still, ahead, ahead & ~still & holds_up, ahead & holds_up)
        )
        # One that leaves too little room when ego comes leaves too little when ego stands
        takes = ahead & ~still & (context.extents.s_min - end < front - rear + ROOM_M)
        same = takes & _until(context, takes & (stuck & stops))
        blocked = nears & short & same.any(axis=0)
        clear &= ~blocked
        nearest |= blocked & (ahead & ~still)
        seems_stuck = _until(context, about_there & all_stop) | ~passed
        doubtful |= nears & short_for_all & ~blocked & seems_stuck
    where = np.where(nearest, context.extents.s_min, np.inf)
    nearest &= where == where.min(axis=0, initial=np.inf)
    return _room_beyond(context, Truth(clear & ~doubtful, clear), nearest)


def waits_for_room(context: DriveContext) -> Flags:
    """Mask of states in which ego, at walking pace at most, is before a place without room behind.

    Vehicles ahead in its lane, slower than that, leave less room there than ego needs. Whether they
    will move on does not matter: until then ego would stand where others cross.
    """
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    waits, pace = np.zeros(context.states, dtype=bool), context.thresholds.walking_pace_kmh
    is_slow = context.ego.speed[0] * KMH_PER_MPS < pace
    if not is_slow.any():
        return waits
    ahead = _ahead_on_lane(context) & (context.tracks.speed * KMH_PER_MPS < pace)
    for start, end in _places(context):
        before = is_slow & (front <= start) & (front > start - _AT_PLACE_M)
        if before.any():
            waits |= before & (_free_beyond(context, ahead, (start, end)) < front - rear + ROOM_M)
    return waits


def _places(context: DriveContext) -> Stretches:
    """Junctions, crossings and level crossings of ego's road."""
    return [*context.road.junctions, *context.road.crossings, *level_crossings(context)]


def _room_beyond(context: DriveContext, clear: Truth, nearest: Flags) -> Caused:
    return Caused(clear, ids_by_state(nearest, context.ids))


def _until(context: DriveContext, flags: Flags) -> Flags:
    """Mask of states at or before a state of the drive in which ``flags`` hold."""
    held: Flags = context.spans.next_state(flags) < context.spans.end
    return held


def _standing_rows(context: DriveContext, ahead: Flags) -> Flags:
    """Mask, one per row, of those ever ahead that stand for as long as they are recorded."""
    still, rows = np.zeros((len(ahead), 1), dtype=bool), ahead.any(axis=1).nonzero()[0]
    still[rows, 0] = context.stays[rows]
    return still


def _free_beyond(context: DriveContext, ahead: Flags, place: tuple[float, float]) -> Floats:
    """How much room (m) those ahead in ego's lane leave behind a place, by state."""
    others, (start, end) = context.extents, place
    room = np.where(ahead & (others.s_max > end), others.s_min - end, np.inf)
    inside = ahead & (others.s_max <= end) & (others.s_max > start)
    taken = np.where(inside, others.s_max - others.s_min + ROOM_M, 0.0)
    free: Floats = room.min(axis=0, initial=np.inf) - taken.sum(axis=0)
    return free


@once
def _ahead_on_lane(context: DriveContext) -> Flags:
    """Mask of vehicles that go ego's way ahead of it and reach into its lane."""
    ahead: Flags = (
        context.in_ego_lane & context.going_along & (relations.station(context) == relations.BEHIND)
    )
    return ahead & ~_left_aside(context, ahead)


def _left_aside(context: DriveContext, ahead: Flags) -> Flags:
    """Mask of those ahead that always stand and leave ego room to pass in its lane."""
    aside, still = np.zeros(ahead.shape, dtype=bool), _standing_rows(context, ahead).nonzero()[0]
    if len(still):
        others, own = context.extents.part(still, slice(None)), context.ego_extents
        left, _ = others.from_bound(context.ego_lane)
        _, right = others.from_bound(context.ego_lane + 1)
        room = own.d_max[0] - own.d_min[0] + 2 * context.thresholds.touching_m
        aside[still] = np.maximum(left, -right) >= room
    return aside


def _shared(context: DriveContext, start: float, end: float) -> float:
    """Where others first cross or join ego's way in a junction; for other places, their beginning.

    A map's junction often begins at its lanelets' ends, some metres before the other road.
    """
    road, passages = context.road, context.surroundings.passages
    if (start, end) not in road.junctions:
        return start
    for piece in ((road.borders[:-1] >= start) & (road.borders[:-1] < end)).nonzero()[0].tolist():
        edge = passages.first_meeting(road.lanelet(piece, road.own_lanes[piece]).id)
        if edge is not None:
            return float(road.borders[piece]) + edge
    return start


def _entered(front: Floats, rear: Floats, places: Stretches, reach: float) -> NDArray[intp]:
    """The number of the place that ego enters or is on, by state; -1 for none."""
    entered = np.full(len(front), -1)
    nearest = np.full(len(front), np.inf)
    for number, (start, _) in enumerate(places):
        ahead = (front <= start) & (front > start - reach) & (start < nearest)
        entered, nearest = np.where(ahead, number, entered), np.where(ahead, start, nearest)
    latest = np.full(len(front), -np.inf)
    for number, (start, end) in enumerate(places):
        on = (front > start) & (rear < end) & (start > latest)
        entered, latest = np.where(on, number, entered), np.where(on, start, latest)
    return entered

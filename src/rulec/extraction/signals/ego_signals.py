"""Signals of ego: its type, speed, lane, and place in the lane."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    about_the_middle,
    on_both_halves,
    oncoming_side,
    sides_beyond_far_edge,
)
from rulec.extraction.signals.ego_lanelets import room_beside, travel_lanes_at, travel_lanes_first
from rulec.extraction.signals.map.junction_signals import lies_askew_in_turn
from rulec.extraction.signals.measured_numbers import own_speed, speed_bounds
from rulec.extraction.signals.queues import lanes_that_go_on
from rulec.extraction.signals.signal_columns import (
    Measured,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.words import word
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.track import TrackOutlines
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import medians

_EGO_TYPES = {
    "truck": "ego_truck",
    "bus": "ego_bus",
    "motorcycle": "ego_motorcycle",
    "priorityVehicle": "ego_emergency_vehicle",
    "bicycle": "ego_cycle",
}
_LANES = ("kerb_lane", "middle_lane", "far_lane")
_MIDDLE = 1
_COUNTS = ("one_lane", "two_lanes", "three_or_more_lanes")
_NUMBERS = ("first_lane", "second_lane", "third_lane", "fourth_or_further_lane")
_HAIR_M = 0.001
_PLACES = ("centred", "at_near_edge", "at_far_edge")


@word("ego_type")
def _ego_type(context: DriveContext) -> Measured:
    types, spread = [body.type for body in context.ego.participants], context.spans.spread
    # Some files say no more about a vehicle than that it is one
    untold = spread([kind == "vehicle" for kind in types])
    return Measured(spread([_EGO_TYPES.get(kind, "ego_car") for kind in types]), untold)


@word("ego_length")
def _ego_length(context: DriveContext) -> Floats:
    """Ego's length, of its own rectangle if known: a turning body is longer along the road."""
    outlines = [body.outlines for body in context.ego.participants]
    own = [x.track.length if isinstance(x, TrackOutlines) else np.nan for x in outlines]
    length = np.array(own)
    if np.isnan(length).any():
        lengths = (context.ego_extents.s_max - context.ego_extents.s_min)[0]
        (told,) = (~np.isnan(lengths)).nonzero()
        median, _ = medians(context.spans.number[told], lengths[told], context.spans.n_drives)
        length = np.where(np.isnan(length), median, length)
    return rounded(context.spans.spread(length))


@word("speed")
def _speed(context: DriveContext) -> Measured:
    speed, _ = own_speed(context)
    return Measured(rounded(speed * KMH_PER_MPS), bounds=speed_bounds(context))


@word("acceleration")
def _acceleration(context: DriveContext) -> Measured:
    gained, wrong = context.ego.acceleration[0], context.ego.acceleration_error[0]
    return Measured(rounded(gained), bounds=rounded_outward(gained - wrong, gained + wrong))


@word("lane")
def _lane(context: DriveContext) -> Measured:
    lane, moves = _from_kerb(context, context.steady_lane), np.zeros(context.states, dtype=bool)
    for other in (context.ego_lane, context.steady_lane_from_beside):
        if (context.steady_lane != other).any():
            moves |= lane != _from_kerb(context, other)
    # Beside a lane that only joins or leaves, the kerb lane may as well be ego's
    at_side = (lane == _MIDDLE) & ~_nearer_goes_on(context)
    return Measured(lane, moves | at_side, texts=_LANES)


def _nearer_goes_on(context: DriveContext) -> Flags:
    """Mask of states in which a lane nearer to the kerb than ego's goes on."""
    lanes = travel_lanes_first(context)
    number, own = np.arange(len(lanes))[:, None], context.steady_lane
    nearer = number < own if context.side == "right" else number > own
    found: Flags = np.logical_or.reduce(lanes & lanes_that_go_on(context).T & nearer)
    return found


@word("lane_number")
def _lane_number(context: DriveContext) -> Measured:
    number, other, from_beside = (
        np.clip(_rank(context, lane), 0, len(_NUMBERS) - 1)
        for lane in (context.steady_lane, context.ego_lane, context.steady_lane_from_beside)
    )
    return Measured(number, (number != other) | (number != from_beside), texts=_NUMBERS)


@word("apart_from_far_lane")
def _apart_from_far_lane(context: DriveContext) -> Truth:
    apart, other, from_beside = (
        _from_far(context, lane) > 1
        for lane in (context.steady_lane, context.ego_lane, context.steady_lane_from_beside)
    )
    return Truth.known(apart).unknown_at((apart != other) | (apart != from_beside))


@word("lanes")
def _lane_count(context: DriveContext) -> Measured:
    """The number of lanes, the largest at ego's rear, middle and front.

    A vehicle beside ego where ways part is no longer on ego's road once ego's middle is past that
    place, and where a lane forks the lanes beside it may have no width for some metres.
    """
    own = context.ego_extents
    places = own.s_min[0], own.s[0], own.s_max[0]
    counts = [travel_lanes_at(context, at).sum(axis=1) for at in places]
    count = np.maximum.reduce(counts)
    numbers = np.minimum(np.maximum(count - 1, 0), 2)
    return Measured(numbers, texts=_COUNTS)


@word("lane_position")
def _lane_position(context: DriveContext) -> Measured:
    place = _place_in_lane(context)
    return Measured(place, texts=_PLACES)


def _from_kerb(context: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """Indices into ``_LANES`` of lanes by state: 0 at the kerb, 2 farthest from it, 1 between."""
    rank, count = _rank(context, lane), travel_lanes_first(context).sum(axis=0)
    return np.where(rank <= 0, 0, np.where(rank >= count - 1, 2, 1))


def _rank(context: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """The number of lanes between given lanes, by state, and the kerb."""
    lanes, states = travel_lanes_first(context), context.spans.columns
    right: NDArray[intp] = lanes.cumsum(axis=0)[lane, states] - lanes[lane, states]
    return right if context.side == "right" else lanes.sum(axis=0) - 1 - right


def _from_far(context: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """The number of lanes from given lanes, by state, to the one farthest from the kerb."""
    count: NDArray[intp] = travel_lanes_first(context).sum(axis=0)
    return count - 1 - _rank(context, lane)


@word("straddling")
def _straddling(context: DriveContext) -> Truth:
    """Whether ego is in two lanes; unknown where tolerances or the map decide, or ego turns off.

    A turning body swings over the lanes of the road that it enters. Ego also straddles on its way
    over the middle of the road, to the lanes of the other direction or back.
    """
    straddling, doubtful = np.zeros((2, context.states), dtype=bool)
    states = _near_a_bound(context).nonzero()[0]
    if len(states):
        straddling[states], doubtful[states] = _in_two_lanes(context, states)
        askew, spans = straddling & lies_askew_in_turn(context), context.spans
        if askew.any():
            # For as long as it lies across the mark without interruption before
            doubtful |= straddling & (spans.next_state(askew) < spans.next_state(~straddling))
    return Truth.known(straddling).unknown_at(doubtful) | _goes_over_the_middle(context)


def _goes_over_the_middle(context: DriveContext) -> Flags:
    """Mask of states in which ego is on both halves of a road, on its way to the other or back.

    Up to ``passed_s`` before or after it is on the other half, not while it keeps to the edge; and
    in the first state wholly on one half after its middle was on the other.
    """
    there = oncoming_side(context).sure
    if not there.any():
        return np.zeros(context.states, dtype=bool)
    spans, on_both = context.spans, on_both_halves(context)
    within = context.steps_in(context.thresholds.passed_s)
    stays, at = about_the_middle(context), spans.columns
    before, after = spans.latest(there), spans.next_state(there)
    goes = (after < spans.next_state(~stays)) & (after - at <= within)
    comes = (before > spans.latest(~stays)) & (at - before <= within)
    over: Flags = on_both & (goes | comes)
    low, high = (rows[0] for rows in sides_beyond_far_edge(context, context.ego_extents))
    least = context.thresholds.touching_m
    far, near = there & (low >= -least), high <= least
    over[1:] |= ~spans.begins_here[1:] & ((far[1:] & ~there[:-1]) | (near[1:] & there[:-1]))
    return over


def _in_two_lanes(context: DriveContext, states: NDArray[intp]) -> tuple[Flags, Flags]:
    """Masks, among ``states``, of being in two lanes and of tolerances deciding that."""
    place, offset = context.tolerances.place_m, context.map_offset_m
    shifts = [np.zeros(len(states)), *([offset[states]] if offset.any() else [])]
    tried = [(0.0, shifts[0]), *product((place, -place), shifts)]
    # The first axis is the number of the try
    by = -np.array([shift for _, shift in tried])[..., None]
    own = context.ego_extents
    bounds = {
        "left_of_min": own.left_of_min[0, states] + by,
        "left_of_max": own.left_of_max[0, states] + by,
    }
    least = context.thresholds.touching_m + np.array([less for less, _ in tried])
    inside = replace(own, **bounds).inside > least[:, None, None]
    both = (inside & context.existing_lanes[states]).sum(axis=-1) > 1
    return both[0], both.any(axis=0) & ~both.all(axis=0)


def _near_a_bound(context: DriveContext) -> Flags:
    """Mask of states in which ego may be in two lanes, given the errors of places and map."""
    own, loose = context.ego_extents, context.tolerances.place_m + np.abs(context.map_offset_m)
    across = np.minimum(-own.left_of_min[0], own.left_of_max[0])
    least = context.thresholds.touching_m - loose - _HAIR_M
    near: Flags = (across > least[:, None]).any(axis=1)
    return near


def _place_in_lane(context: DriveContext) -> NDArray[intp]:
    """Indices into ``_PLACES``: 0 centred, 1 near edge, 2 far edge."""
    near, far = room_beside(context)
    if context.side == "left":
        near, far = far, near
    # In a lane hardly wider than ego both edges are near, and ego keeps to neither
    edge = context.thresholds.at_edge_m
    kept = (np.minimum(near, far) < edge) & (np.abs(near - far) > edge)
    return np.where(kept, np.where(near < far, 1, 2), 0)

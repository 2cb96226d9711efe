"""Signals of ego: its type, speed, lane, and place in it."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.measured_numbers import own_speed, speed_bounds
from rulec.extraction.signals.signal_columns import SignalColumns, named_values, rounded
from rulec.extraction.tracks.tracks import Flags, Floats

_EGO_TYPES = {
    "truck": "ego_truck",
    "bus": "ego_bus",
    "motorcycle": "ego_motorcycle",
    "priorityVehicle": "ego_emergency_vehicle",
    "bicycle": "ego_cycle",
}
_LANES = ("kerb_lane", "middle_lane", "far_lane")
_COUNTS = ("one_lane", "two_lanes", "three_or_more_lanes")
_PLACES = ("centred", "at_near_edge", "at_far_edge")


def ego_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego alone."""
    limits = context.thresholds
    count, own = context.states, context.ego_extents
    (participant,) = context.ego.participants
    speed, error = own_speed(context)
    gained, wrong = context.ego.acceleration[0], context.ego.acceleration_error[0]
    existing, slow = context.existing_lanes, limits.stops_at_once_kmh / KMH
    straddling, unsure = _straddling(context)
    lane = _from_kerb(context, context.steady_lane)
    return SignalColumns(
        {
            "ego_type": np.full(count, _EGO_TYPES.get(participant.type, "ego_car")),
            "ego_length": rounded(np.full(count, np.nanmedian(own.s_max - own.s_min))),
            "speed": rounded(speed * KMH),
            "accelerating": gained > limits.accelerating_mps2,
            "braking_hard": gained < -limits.braking_hard_mps2,
            "can_stop_at_once": speed <= slow,
            "lane": named_values(lane, _LANES),
            "lanes": named_values(np.clip(existing.sum(axis=1) - 1, 0, 2), _COUNTS),
            "straddling": straddling,
            "lane_position": named_values(_place_in_lane(context), _PLACES),
        },
        unknown={
            "accelerating": abs(gained - limits.accelerating_mps2) < wrong,
            "braking_hard": abs(gained + limits.braking_hard_mps2) < wrong,
            "can_stop_at_once": abs(speed - slow) < error,
            "straddling": unsure,
            "lane": lane != _from_kerb(context, context.ego_lane),
            # A file may know of vehicles no more than that they are some
            "ego_type": np.full(count, participant.type == "vehicle"),
        },
        bounds={"speed": speed_bounds(context)},
    )


def _from_kerb(context: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """Indices into ``_LANES`` of lanes by state: 0 at the kerb, 2 farthest, 1 between."""
    existing = context.existing_lanes
    state = np.arange(len(lane))
    right: NDArray[intp] = np.cumsum(existing, axis=1)[state, lane] - existing[state, lane]
    count = existing.sum(axis=1)
    rank = right if context.side == "right" else count - 1 - right
    return np.where(rank <= 0, 0, np.where(rank >= count - 1, 2, 1))


def _straddling(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of ego in two lanes, and of states in which that cannot be told."""
    place = context.tolerances.place_m
    both = []
    unmoved = np.zeros(context.states)
    for less, shift in ((0.0, unmoved), *product((place, -place), (unmoved, context.map_offset_m))):
        inside = context.ego_extents.moved(-shift).inside[0]
        least = context.thresholds.touching_m + less
        both.append(((inside > least) & context.existing_lanes).sum(axis=1) > 1)
    return both[0], np.any(both, axis=0) & ~np.all(both, axis=0)


def room_beside(context: DriveContext) -> tuple[Floats, Floats]:
    """The room (m) in ego's lane to the right and to the left of it."""
    lane, own = context.steady_lane, context.ego_extents
    return own.from_bound(lane)[0][0], -own.from_bound(lane + 1)[1][0]


def _place_in_lane(context: DriveContext) -> NDArray[intp]:
    """Indices into ``_PLACES``: 0 centred, 1 near edge, 2 far edge."""
    near, far = room_beside(context)
    if context.side == "left":
        near, far = far, near
    # In a lane that is hardly wider than ego both edges are near, and neither is kept to
    edge = context.thresholds.at_edge_m
    kept = (np.minimum(near, far) < edge) & (np.abs(near - far) > edge)
    return np.where(kept, np.where(near < far, 1, 2), 0)

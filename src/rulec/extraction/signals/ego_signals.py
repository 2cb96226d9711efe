"""Signals of ego: its type, speed, lane, and place in it."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, zero_if_standing
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
    count = context.states
    (participant,) = context.ego.participants
    speed = rounded(zero_if_standing(context.ego.speed[0] * KMH, limits))
    gained = context.ego.acceleration[0]
    existing = context.road.lanes_at(context.ego_extents.s[0])
    lane = steady_lane(context, existing)
    return SignalColumns(
        {
            "ego_type": np.full(count, _EGO_TYPES.get(participant.type, "ego_car")),
            "ego_length": rounded(np.full(count, _length(context))),
            "speed": speed,
            "accelerating": gained > limits.accelerating_mps2,
            "braking_hard": gained < -limits.braking_hard_mps2,
            "can_stop_at_once": speed <= limits.stops_at_once_kmh,
            "lane": named_values(_from_kerb(context, lane, existing), _LANES),
            "lanes": named_values(np.clip(existing.sum(axis=1) - 1, 0, 2), _COUNTS),
            "straddling": _straddling(context, existing),
            "lane_position": named_values(_place_in_lane(context, lane), _PLACES),
        }
    )


def _length(context: DriveContext) -> float:
    """Ego's length along its road (m), the median over its states."""
    return float(np.nanmedian(context.ego_extents.s_max - context.ego_extents.s_min))


def steady_lane(context: DriveContext, existing: Flags) -> NDArray[intp]:
    """Ego's lane by its middle, with hysteresis.

    It is left only ``changed_m`` beyond its mark.
    """
    straight = context.road.lanes.straight
    lane = np.array(context.ego_lane)
    middle = context.ego_extents.w[0]
    for state in range(1, len(lane)):
        before = lane[state - 1]
        beyond = max(straight[before] - middle[state], middle[state] - straight[before + 1])
        if beyond < context.thresholds.changed_m and existing[state, before]:
            lane[state] = before
    return lane


def _from_kerb(context: DriveContext, lane: NDArray[intp], existing: Flags) -> NDArray[intp]:
    """Indices into ``_LANES``: 0 at the kerb, 2 farthest, 1 between."""
    state = np.arange(len(lane))
    right: NDArray[intp] = np.cumsum(existing, axis=1)[state, lane] - existing[state, lane]
    count = existing.sum(axis=1)
    rank = right if context.side == "right" else count - 1 - right
    from_kerb: NDArray[intp] = np.where(rank <= 0, 0, np.where(rank >= count - 1, 2, 1))
    return from_kerb


def _straddling(context: DriveContext, existing: Flags) -> Flags:
    """Flags of states in which ego reaches into two lanes."""
    straight = context.road.lanes.straight
    reach = context.thresholds.touching_m
    low, high = context.ego_extents.w_min[0][:, None], context.ego_extents.w_max[0][:, None]
    inside = np.minimum(high, straight[1:]) - np.maximum(low, straight[:-1])
    both: Flags = ((inside > reach) & existing).sum(axis=1) > 1
    return both


def _place_in_lane(context: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """Indices into ``_PLACES``: 0 centred, 1 near edge, 2 far edge."""
    straight = context.road.lanes.straight
    right: Floats = context.ego_extents.w_min[0] - straight[lane]
    left: Floats = straight[lane + 1] - context.ego_extents.w_max[0]
    near, far = (right, left) if context.side == "right" else (left, right)
    # In a lane that is hardly wider than ego both edges are near, and neither is kept to
    edge = context.thresholds.at_edge_m
    kept = (np.minimum(near, far) < edge) & (np.abs(near - far) > edge)
    places: NDArray[intp] = np.where(kept, np.where(near < far, 1, 2), 0)
    return places

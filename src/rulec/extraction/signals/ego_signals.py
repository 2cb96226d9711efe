"""What ego does: its speed, its lane, and how it keeps in it."""

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


def ego_signals(view: DriveContext) -> SignalColumns:
    """Words about ego alone."""
    limits = view.thresholds
    count = view.states
    (participant,) = view.ego.participants
    speed = rounded(zero_if_standing(view.ego.speed[0] * KMH, limits))
    gained = view.ego.acceleration[0]
    there = view.road.lanes_at(view.own.s[0])
    lane = steady_lane(view, there)
    return SignalColumns(
        {
            "ego_type": np.full(count, _EGO_TYPES.get(participant.type, "ego_car")),
            "ego_length": rounded(np.full(count, _length(view))),
            "speed": speed,
            "accelerating": gained > limits.accelerating_mps2,
            "braking_hard": gained < -limits.braking_hard_mps2,
            "can_stop_at_once": speed <= limits.stops_at_once_kmh,
            "lane": named_values(_from_kerb(view, lane, there), _LANES),
            "lanes": named_values(np.clip(there.sum(axis=1) - 1, 0, 2), _COUNTS),
            "straddling": _straddling(view, there),
            "lane_position": named_values(_place_in_lane(view, lane), _PLACES),
        }
    )


def _length(view: DriveContext) -> float:
    """How long ego is: the longest that it is along its road, which bends make a little longer."""
    return float(np.nanmedian(view.own.s_max - view.own.s_min))


def steady_lane(view: DriveContext, there: Flags) -> NDArray[intp]:
    """Ego's lane by its middle; one is left only when the middle is well beyond the mark."""
    straight = view.road.lanes.straight
    found = np.array(view.lane)
    middle = view.own.w[0]
    for state in range(1, len(found)):
        before = found[state - 1]
        beyond = max(straight[before] - middle[state], middle[state] - straight[before + 1])
        if beyond < view.thresholds.changed_m and there[state, before]:
            found[state] = before
    return found


def _from_kerb(view: DriveContext, lane: NDArray[intp], there: Flags) -> NDArray[intp]:
    """0 for the lane at the kerb, 2 for the one farthest from it, 1 for one between."""
    state = np.arange(len(lane))
    right: NDArray[intp] = np.cumsum(there, axis=1)[state, lane] - there[state, lane]
    count = there.sum(axis=1)
    rank = right if view.side == "right" else count - 1 - right
    found: NDArray[intp] = np.where(rank <= 0, 0, np.where(rank >= count - 1, 2, 1))
    return found


def _straddling(view: DriveContext, there: Flags) -> Flags:
    """Is ego in two lanes at once?"""
    straight = view.road.lanes.straight
    reach = view.thresholds.touching_m
    low, high = view.own.w_min[0][:, None], view.own.w_max[0][:, None]
    inside = np.minimum(high, straight[1:]) - np.maximum(low, straight[:-1])
    both: Flags = ((inside > reach) & there).sum(axis=1) > 1
    return both


def _place_in_lane(view: DriveContext, lane: NDArray[intp]) -> NDArray[intp]:
    """0 centred, 1 at the near edge, 2 at the far one."""
    straight = view.road.lanes.straight
    right: Floats = view.own.w_min[0] - straight[lane]
    left: Floats = straight[lane + 1] - view.own.w_max[0]
    near, far = (right, left) if view.side == "right" else (left, right)
    # In a lane that is hardly wider than ego both edges are near, and neither is kept to
    edge = view.thresholds.at_edge_m
    kept = (np.minimum(near, far) < edge) & (np.abs(near - far) > edge)
    found: NDArray[intp] = np.where(kept, np.where(near < far, 1, 2), 0)
    return found

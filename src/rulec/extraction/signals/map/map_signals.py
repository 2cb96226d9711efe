"""Signals of the map around ego: surface, limit, signs, crossings."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.map.junction_signals import stop_line
from rulec.extraction.signals.signal_columns import (
    SignalColumn,
    SignalColumns,
    rounded,
    rounded_outward,
)
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import Lanelet

NO_LIMIT_KMH = 1000.0
NO_CROSSING_M = 1000.0

_SIGNS = {
    "YIELD": ("give_way_sign", True),
    "STOP": ("stop_sign", True),
    "NO_OVERTAKING_START": ("no_overtaking_sign", False),
    "GREEN_ARROW": ("turn_on_red_sign", True),
    "NO_TURN_ON_RED": ("no_turn_on_red_sign", True),
}
"""Sign -> signal, and whether it is for the line at the lanelet's end."""


def map_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego's road, as far as the map knows them."""
    lanelets = _lanelets_at(context, context.ego_extents.s[0])
    to_crossing = distance_to_crossing(context)
    on = to_crossing <= 0
    world = {
        "surface": _surface(context, on),
        "distance_to_crossing": rounded(to_crossing),
        "crossing_zone": to_crossing <= context.thresholds.zone_m,
    }
    unknown: dict[str, Flags] = {}
    if any(lanelet.limit_mps is not None for lanelet in context.recording.lanelets.values()):
        world["limit"] = rounded(np.minimum(context.limit_mps * KMH, NO_LIMIT_KMH))
    for sign, (name, at_line) in _SIGNS.items():
        drawn = any(sign in lanelet.signs for lanelet in context.recording.lanelets.values())
        if drawn or sign in context.recording.complete:
            here = np.array([sign in lanelet.signs for lanelet in lanelets])
            world[name] = _holds_to_line(context, sign) if at_line else here
    place = context.tolerances.place_m
    nearer, farther = (_to_crossing(context, way * place) for way in (-1, 1))
    bounds = {"distance_to_crossing": rounded_outward(nearer, farther)}
    return SignalColumns(world, unknown=unknown, bounds=bounds)


def _holds_to_line(context: DriveContext, sign: str) -> Flags:
    """Flags of states in which a sign holds up to its line.

    By where ego's front was one state before, so that it still holds when ego crosses the line.
    """
    front = context.ego_extents.s_max[0]
    before, holds = np.append(front[:1], front[:-1]), np.zeros(context.states, dtype=bool)
    for piece, row in enumerate(context.road.rows):
        if any(lanelet is not None and sign in lanelet.signs for lanelet in row):
            begins = float(context.road.borders[piece])
            for lane in np.unique(context.ego_lane).tolist():
                if sign in context.road.lanelet(piece, lane).signs:
                    _, line = stop_line(context, piece, lane)
                    there = (before >= begins) & (before <= line)
                    holds |= there & (context.ego_lane == lane)
    return holds


def _lanelets_at(context: DriveContext, s: Floats) -> list[Lanelet]:
    """The lanelet of ego's lane at places, one for each state."""
    pieces = context.road.piece(s).tolist()
    lanes = context.ego_lane.tolist()
    return [context.road.lanelet(piece, lane) for piece, lane in zip(pieces, lanes, strict=True)]


def distance_to_crossing(context: DriveContext) -> Floats:
    """The distance (m) from ego's front to the next pedestrian crossing, 0 on it."""
    return _to_crossing(context, 0.0)


def _to_crossing(context: DriveContext, more_m: float) -> Floats:
    start, _ = next_crossing(context)
    distance: Floats = np.clip(start - context.ego_extents.s_max[0] + more_m, 0.0, NO_CROSSING_M)
    return distance


def next_crossing(context: DriveContext) -> tuple[Floats, Floats]:
    """Begin and end of ego's present or next pedestrian crossing by state, or infinity."""
    start, end = np.full((2, context.states), np.inf)
    for low, high in sorted(context.road.crossings, reverse=True):
        before = context.ego_extents.s_min[0] < high
        start, end = np.where(before, low, start), np.where(before, high, end)
    return start, end


def _surface(context: DriveContext, on_crossing: Flags) -> SignalColumn:
    middle = context.ego_extents.s[0]
    surfaces = np.full(context.states, "carriageway", dtype="<U14")
    for start, end in context.road.junctions:
        surfaces[(middle > start) & (middle < end)] = "junction"
    own = _lanelets_at(context, middle)
    surfaces[["busLane" in lanelet.types for lanelet in own]] = "bus_lane"
    surfaces[["shoulder" in lanelet.types for lanelet in own]] = "hard_shoulder"
    surfaces[["level_crossing" in lanelet.types for lanelet in own]] = "level_crossing"
    surfaces[on_crossing] = "crossing"
    return surfaces

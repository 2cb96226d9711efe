"""What the map says where ego is: surface, limits, the class of the road, signs, crossings."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns, rounded
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.scenario.recorded.recording import Lanelet

NO_LIMIT_KMH = 1000.0
NO_CROSSING_M = 1000.0

_SIGNS = {
    "YIELD": ("give_way_sign", True),
    "STOP": ("stop_sign", True),
    "NO_OVERTAKING_START": ("no_overtaking_sign", False),
}
"""Sign -> word, and whether it is for the line at the lanelet's end."""

_CLASSES = {"highway": "motorway", "interstate": "motorway", "country": "ordinary_road"}


def map_signals(view: DriveContext) -> SignalColumns:
    """Words about the road where ego is. What the map has no word about at all is not there."""
    lanelets = _lanelets_at(view, view.own.s[0])
    # Where ego's front was one state before, so that who crosses a line still has its sign
    front = view.own.s_max[0]
    left = _lanelets_at(view, np.append(front[:1], front[:-1]))
    to_crossing = distance_to_crossing(view)
    on = to_crossing <= 0
    world = {
        "surface": _surface(view, on),
        "distance_to_crossing": rounded(to_crossing),
        "crossing_zone": to_crossing <= view.thresholds.zone_m,
    }
    unknown: dict[str, Flags] = {}
    if any(one.limit_mps is not None for one in view.recording.lanelets.values()):
        limits = [NO_LIMIT_KMH if x.limit_mps is None else x.limit_mps * KMH for x in lanelets]
        world["limit"] = rounded(np.array(limits))
    classes = [next((_CLASSES[t] for t in x.types if t in _CLASSES), "") for x in lanelets]
    if any(classes):
        world["road_class"] = np.array(classes)
        unknown["road_class"] = world["road_class"] == ""
    for sign, (word, at_line) in _SIGNS.items():
        if any(sign in one.signs for one in view.recording.lanelets.values()):
            under = left if at_line else lanelets
            world[word] = np.array([sign in one.signs for one in under])
    return SignalColumns(world, unknown=unknown)


def _lanelets_at(view: DriveContext, s: Floats) -> list[Lanelet]:
    """The lanelet of ego's lane at places, one for each state."""
    pieces = view.road.piece(s).tolist()
    lanes = view.lane.tolist()
    return [view.road.lanelet(piece, lane) for piece, lane in zip(pieces, lanes, strict=True)]


def distance_to_crossing(view: DriveContext) -> Floats:
    """From ego's front to the next pedestrian crossing, 0 on it (m)."""
    start, _ = next_crossing(view)
    way: Floats = np.clip(start - view.own.s_max[0], 0.0, NO_CROSSING_M)
    return way


def next_crossing(view: DriveContext) -> tuple[Floats, Floats]:
    """Where the pedestrian crossing that ego is on, or the next one, begins and ends, by state.

    Infinite where there is none.
    """
    start, end = np.full((2, view.states), np.inf)
    for low, high in sorted(view.road.crossings, reverse=True):
        before = view.own.s_min[0] < high
        start, end = np.where(before, low, start), np.where(before, high, end)
    return start, end


def _surface(view: DriveContext, on_crossing: Flags) -> SignalColumn:
    """What ego is on; of crossings any part of it counts, of the rest its middle."""
    middle = view.own.s[0]
    found = np.full(view.states, "carriageway", dtype="<U11")
    for start, end in view.road.junctions:
        found[(middle > start) & (middle < end)] = "junction"
    found[["busLane" in one.types for one in _lanelets_at(view, middle)]] = "bus_lane"
    found[on_crossing] = "crossing"
    return found

"""What the map says where ego is: surface, limits, the class of the road, signs, crossings."""

from __future__ import annotations

import numpy as np

from rulec.drives.everyone import Flags, Values
from rulec.drives.view import KMH, View
from rulec.drives.words import Words, rounded

NO_LIMIT_KMH = 1000.0
NO_CROSSING_M = 1000.0

_SIGNS = {
    "YIELD": "give_way_sign",
    "STOP": "stop_sign",
    "NO_OVERTAKING_START": "no_overtaking_sign",
}
_CLASSES = {"highway": "motorway", "interstate": "motorway", "country": "ordinary_road"}


def map_words(view: View) -> Words:
    """Words about the road where ego is. What the map has no word about at all is not there."""
    lanelets = view.road.lanelets
    here = view.road.piece(view.own.s[0])
    to_crossing = way_to_crossing(view)
    on = to_crossing <= 0
    world = {
        "surface": np.where(on, "crossing", "carriageway"),
        "distance_to_crossing": rounded(to_crossing),
        "crossing_zone": to_crossing <= view.thresholds.crossing_zone_m,
    }
    unknown: dict[str, Flags] = {}
    if any(one.limit_mps is not None for one in view.recording.lanelets.values()):
        limits = [NO_LIMIT_KMH if x.limit_mps is None else x.limit_mps * KMH for x in lanelets]
        world["limit"] = rounded(np.array(limits))[here]
    classes = [next((_CLASSES[t] for t in x.types if t in _CLASSES), "") for x in lanelets]
    if any(classes):
        world["road_class"] = np.array(classes)[here]
        unknown["road_class"] = world["road_class"] == ""
    for sign, word in _SIGNS.items():
        if any(sign in one.signs for one in view.recording.lanelets.values()):
            world[word] = np.array([sign in one.signs for one in lanelets])[here]
    return Words(world, unknown=unknown)


def way_to_crossing(view: View) -> Values:
    """From ego's front to the next pedestrian crossing, 0 on it (m)."""
    front, rear = view.own.s_max[0], view.own.s_min[0]
    found = np.full(front.shape, NO_CROSSING_M)
    for start, end in view.road.crossings:
        found = np.where(rear < end, np.minimum(found, np.maximum(start - front, 0.0)), found)
    return found

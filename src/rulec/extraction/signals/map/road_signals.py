"""Signals of the road as a whole: where it leads through, its directions, its weather.

What a map leaves out is unknown unless its format would have it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.surroundings import Directions
from rulec.extraction.tracks.tracks import Flags
from rulec.recordings.recording import Lanelet

_Value = TypeVar("_Value")

_OUTSIDE = frozenset({"country", "rural", "highway", "interstate"})
_SETTINGS = _OUTSIDE | {"urban"}
_URBAN_KMH = 70.0
"""In built-up areas limits are hardly higher."""

_CLASSES = {"highway": "motorway", "interstate": "motorway", "country": "ordinary_road"}
_CLASSES |= {"ordinary": "ordinary_road"}

_LANE_KINDS = {
    "accessRamp": "entry_lane",
    "exitRamp": "exit_lane",
    "mainCarriageWay": "through_lane",
}


def road_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego's road, its surroundings and its weather."""
    world: dict[str, SignalColumn] = {}
    unknown: dict[str, Flags] = {}
    pieces = context.road.piece(context.ego_extents.s[0])
    lanes = context.ego_lane.tolist()
    own = [context.road.lanelet(*pair) for pair in zip(pieces.tolist(), lanes, strict=True)]
    is_town = _by_lanelet(own, _town(context))
    if any(_SETTINGS & lanelet.types for lanelet in context.recording.lanelets.values()):
        world["built_up"], unknown["built_up"] = _told(is_town)
    classes = [_class(lanelet, town) for lanelet, town in zip(own, is_town, strict=True)]
    if any(classes):
        world["road_class"] = np.array(classes)
        unknown["road_class"] = world["road_class"] == ""
    both = _by_lanelet(own, _directions(context))
    for number, name in enumerate(("one_way", "divided")):
        told = [pair[number] for pair in both]
        if any(value is not None for value in told):
            world[name], unknown[name] = _told(told)
    lanelets = context.recording.lanelets.values()
    if any(_LANE_KINDS.keys() & lanelet.types for lanelet in lanelets):
        kinds = [next((_LANE_KINDS[x] for x in _LANE_KINDS if x in at.types), "") for at in own]
        world["lane_kind"] = np.array(kinds)
        unknown["lane_kind"] = world["lane_kind"] == ""
    if any("tunnel" in lanelet.types for lanelet in lanelets):
        world["tunnel"] = np.array(["tunnel" in lanelet.types for lanelet in own])
    if "officer" in context.recording.complete:
        for name in ("told_to_stop", "told_to_go"):
            world[name] = np.zeros(context.states, dtype=bool)
    weather = context.recording.weather
    for name, value in (("wet", weather.wet), ("icy", weather.icy)):
        if value is not None:
            world[name] = np.full(context.states, value)
    if weather.visibility_m is not None:
        world["visibility"] = np.full(context.states, weather.visibility_m)
    return SignalColumns(world, unknown=unknown)


def _told(values: Sequence[bool | None]) -> tuple[Flags, Flags]:
    return np.array([bool(x) for x in values]), np.array([x is None for x in values])


def _class(lanelet: Lanelet, town: bool | None) -> str:
    """The class of a road, empty if unknown; in a built-up area it is an ordinary one."""
    told = next((_CLASSES[kind] for kind in _CLASSES if kind in lanelet.types), "")
    return told or ("ordinary_road" if town else "")


def _directions(context: DriveContext) -> Callable[[Lanelet], Directions]:
    """A function that says whether a lanelet's road is one-way, and divided.

    Across the island of a roundabout is not the other direction of a road.
    """
    ring = context.surroundings.ring(context.side)
    of_road = context.surroundings.directions
    return lambda lanelet: (True, False) if lanelet.id in ring else of_road(lanelet)


def _by_lanelet(own: Sequence[Lanelet], value: Callable[[Lanelet], _Value]) -> list[_Value]:
    known: dict[str, _Value] = {}
    for lanelet in own:
        if lanelet.id not in known:
            known[lanelet.id] = value(lanelet)
    return [known[lanelet.id] for lanelet in own]


def _town(context: DriveContext) -> Callable[[Lanelet], bool | None]:
    """A function that says of a lanelet whether it is in a built-up area, None if unknown.

    ``urban`` is what many maps call every road: it counts on a map that has junctions or
    crossings, and on which no limit of an urban lanelet contradicts it.
    """
    lanelets = context.recording.lanelets.values()
    settled = bool(context.surroundings.passages.junctions) or any(
        "crosswalk" in x.types for x in lanelets
    )
    fast = any(
        "urban" in x.types and round((x.limit_mps or 0.0) * KMH, 2) > _URBAN_KMH for x in lanelets
    )

    def town(lanelet: Lanelet) -> bool | None:
        types = lanelet.types
        if "intersection" in types and "urban" not in types:
            near = [context.recording.lanelets.get(x) for x in lanelet.predecessors]
            types = next((x.types for x in near if x is not None), types)
        if "urban" in types and not types & _OUTSIDE:
            return True if settled and not fast else None
        return False if types & _OUTSIDE and "urban" not in types else None

    return town

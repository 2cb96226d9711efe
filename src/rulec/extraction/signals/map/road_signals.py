"""Signals of the road as a whole: its surroundings, its directions, its weather.

What a map leaves out is unknown, unless its format would contain it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once_a_map
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import lanelets_at, map_contents, own_lanelets
from rulec.extraction.signals.signal_columns import Measured, SignalColumns, world_signals
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.surroundings import Directions
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import BROAD_LEFT, BROAD_RIGHT, RAMPS, Lanelet
from rulec.scenario.recorded.route import lanes_beside
from rulec.trace.partly_known.partly_known_values import Truth

_OUTSIDE = frozenset({"country", "rural", "highway", "interstate"})
_SETTINGS = _OUTSIDE | {"urban"}
_URBAN_KMH = 70.0
"""Speed limits in built-up areas are hardly higher."""

_CLASSES = {"highway": "motorway", "interstate": "motorway", "country": "ordinary_road"}
_CLASSES |= {"ordinary": "ordinary_road"}

_LANE_KINDS = {
    "accessRamp": "entry_lane",
    "exitRamp": "exit_lane",
    "mainCarriageWay": "through_lane",
}


@word("built_up")
def _built_up(context: DriveContext) -> Truth | None:
    if not _SETTINGS & map_contents(context).types:
        return None
    return own_lanelets(context).told(_town(context))


@word("road_class")
def _road_class(context: DriveContext) -> Measured | None:
    town, types = _town(context), _types_of_road(context)
    classes = own_lanelets(context).values(lambda at: _class(types(at), town(at)))
    told = context.spans.agreed([any(classes[columns]) for columns in context.spans.slices])
    return _where_told(classes) if told else None


def _where_told(values: list[str]) -> Measured:
    column = np.array(values)
    return Measured(column, column == "")


@word("one_way", "divided")
def _ways(context: DriveContext) -> SignalColumns:
    directions, spans = _directions(context), context.spans
    ways = {
        "one_way": own_lanelets(context).told(lambda at: directions(at)[0]),
        "divided": own_lanelets(context).told(lambda at: directions(at)[1]),
    }
    told = {
        name: holds
        for name, holds in ways.items()
        if spans.agreed((~spans.all(holds.unknown))[spans.begins].tolist())
    }
    return SignalColumns(told)


@word("lane_kind")
def _lane_kind(context: DriveContext) -> Measured | None:
    """The kind of the lane that ego has changed to last, consistent with `lane_change`.

    The lane of ego's middle differs a little earlier: then no vehicle would change from an entry
    lane. Main lanes beyond a broad line may leave the road farther ahead. What a separate ramp
    joins or has left is unknown: several lanes of it may be used like any others.
    """
    if not _LANE_KINDS.keys() & map_contents(context).types:
        return None
    recording, inward_left = context.recording, context.side == "right"
    broad = BROAD_LEFT if inward_left else BROAD_RIGHT

    def kind(at: Lanelet) -> str:
        told = next((_LANE_KINDS[x] for x in _LANE_KINDS if x in at.types), "")
        if told != "through_lane":
            beside = [
                x for left in (True, False) for x in lanes_beside(recording, at.id, left=left)
            ]
            return told if any(not recording.lanelets[x].types & RAMPS for x in beside) else ""
        inward = (at.id, *lanes_beside(recording, at.id, left=inward_left))
        return "" if any(broad in recording.lanelets[x].types for x in inward) else told

    kinds = lanelets_at(context, context.ego_extents.s[0], context.steady_lane).values(kind)
    return _where_told(kinds)


@word("tunnel")
def _tunnel(context: DriveContext) -> Flags | None:
    if "tunnel" not in map_contents(context).types:
        return None
    return own_lanelets(context).flags(lambda at: "tunnel" in at.types)


@word("told_to_stop", "told_to_go")
def _officers(context: DriveContext) -> SignalColumns:
    if "officer" not in context.recording.complete:
        return SignalColumns()
    nobody = np.zeros(context.states, dtype=bool)
    return world_signals(told_to_stop=nobody, told_to_go=nobody)


@word("wet", "icy", "visibility", "raining", "night")
def _weather(context: DriveContext) -> SignalColumns:
    weather = context.recording.weather
    told = {"wet": weather.wet, "icy": weather.icy, "visibility": weather.visibility_m}
    told |= {"raining": weather.raining, "night": weather.night}
    return world_signals(
        **{
            name: np.full(context.states, value)
            for name, value in told.items()
            if value is not None
        }
    )


def _class(types: frozenset[str], town: bool | None) -> str:
    """The class of a road, empty if unknown; in a built-up area it is an ordinary road."""
    told = next((_CLASSES[kind] for kind in _CLASSES if kind in types), "")
    return told or ("ordinary_road" if town else "")


def _types_of_road(context: DriveContext) -> Callable[[Lanelet], frozenset[str]]:
    """A function for the types of a lanelet; for a shoulder, those of the lane beside it."""
    known = context.recording.lanelets

    def types(lanelet: Lanelet) -> frozenset[str]:
        beside = (known.get(name or "") for name in (lanelet.left_of, lanelet.right_of))
        is_alone = "shoulder" in lanelet.types and not lanelet.types & _SETTINGS
        return next((x.types for x in beside if is_alone and x is not None), lanelet.types)

    return types


def _directions(context: DriveContext) -> Callable[[Lanelet], Directions]:
    """A function for whether a lanelet's road is one-way, and whether it is divided.

    The other side of a roundabout's island is not the other direction of a road.
    """
    ring = context.surroundings.ring(context.side)
    of_road = context.surroundings.directions
    return lambda lanelet: (True, False) if lanelet.id in ring else of_road(lanelet.id)


def _town(context: DriveContext) -> Callable[[Lanelet], bool | None]:
    """A function for whether a lanelet is in a built-up area, None if unknown.

    Many maps call every road ``urban``: this counts on a map that has junctions or crossings, and
    on which no limit of an urban lanelet contradicts it.
    """
    settled, fast = _settled(context), _has_fast_town(context)
    types_of_road = _types_of_road(context)

    def town(lanelet: Lanelet) -> bool | None:
        types = types_of_road(lanelet)
        if "intersection" in types and "urban" not in types:
            near = [context.recording.lanelets.get(x) for x in lanelet.predecessors]
            types = next((x.types for x in near if x is not None), types)
        if "urban" in types and not types & _OUTSIDE:
            return True if settled and not fast else None
        return False if types & _OUTSIDE and "urban" not in types else None

    return town


@once_a_map
def _settled(context: DriveContext) -> bool:
    """Whether the map has junctions or crossings."""
    junctions = context.surroundings.passages.junctions
    return bool(junctions) or "crosswalk" in map_contents(context).types


@once_a_map
def _has_fast_town(context: DriveContext) -> bool:
    """Whether some lanelet called urban has a limit that is too high for a built-up area."""
    return any(
        "urban" in x.types and round((x.limit_mps or 0.0) * KMH_PER_MPS, 2) > _URBAN_KMH
        for x in context.recording.lanelets.values()
    )

"""Signals of level crossings on ego's road, and of the rails beside it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from heapq import heappop, heappush

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once_a_map, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.stop_lines import may_have_passed
from rulec.extraction.signals.signal_columns import SignalColumns, world_signals
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import Stretches, reach_into, runs_along
from rulec.scenario.recorded.route import lanelet_length
from rulec.trace.partly_known.partly_known_values import Truth

_SIGNS_M = 300.0
"""Signs that warn of a level crossing are at most this far before it: beacons begin at 240 m."""


@word("level_crossing_zone", "enters_level_crossing", "guarded")
def _zones(context: DriveContext) -> SignalColumns:
    if not _tells_rails(context):
        return SignalColumns()
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    enters, unseen = np.zeros((2, context.states), dtype=bool)
    zone = reach_into(level_crossings(context), rear, front, context.thresholds.zone_m)
    for start, _ in level_crossings(context):
        enters |= context.spans.enters(front > start)
        unseen |= may_have_passed(context, start, front)
    # Those of a net have gates that close while a train comes
    entering = Truth.known(enters).unknown_at(unseen)
    return world_signals(level_crossing_zone=zone, enters_level_crossing=entering, guarded=zone)


@word("past_level_crossing_sign")
def _warned(context: DriveContext) -> Truth | None:
    """Whether ego is past the sign warning of a level crossing; unknown where there may be one.

    No map has these signs, but where no level crossing is ahead, none warns of it.
    """
    if not _tells_rails(context):
        return None
    near = _way_to_next(context, context.ego_extents.s_max[0]) <= _SIGNS_M
    return Truth(np.zeros_like(near), near)


def _way_to_next(context: DriveContext, places: Floats) -> Floats:
    """The least distance (m) from places of the road to a level crossing, infinity without one."""
    road, ways = context.road, _ways_to_next(context)
    pieces = road.piece(places)
    behind = np.array([_least(ways, (x.id for x in row if x is not None)) for row in road.rows])
    starts = road.borders[pieces]
    # Known at the beginning of each lanelet; within one it is less by the distance driven
    way: Floats = np.maximum(behind[pieces] - (places - starts), 0.0)
    return way


def _least(ways: Mapping[str, float], ids: Iterable[str]) -> float:
    return min((ways.get(name, np.inf) for name in ids), default=np.inf)


@once_a_map
def _ways_to_next(context: DriveContext) -> Mapping[str, float]:
    """The distance (m) from the start of lanelets to a level crossing that they lead to."""
    lanelets = context.recording.lanelets
    ways: dict[str, float] = {}
    waiting = [(0.0, x.id) for x in lanelets.values() if "level_crossing" in x.types]
    while waiting:
        way, name = heappop(waiting)
        if name in ways:
            continue
        ways[name] = way
        if way > _SIGNS_M:
            continue  # all that lead there are farther still
        for before in lanelets[name].predecessors:
            if before in lanelets and before not in ways:
                heappush(waiting, (way + lanelet_length(lanelets[before]), before))
    return ways


@word("tracks_at_kerb")
def _tracks_at_kerb(context: DriveContext) -> Flags | None:
    """Whether rails are beside the kerb lane, or in it, as rail vehicles there show."""
    if not _tells_rails(context):
        return None
    pieces = context.road.piece(context.ego_extents.s[0])
    first, end = context.lane_edges
    kerb = first if context.side == "right" else end - 1
    rails = context.tracks.of_type("rail_vehicle")
    runs = context.relevant[rails] & context.on_lanes[rails]
    runs &= abs(context.extents.turned[rails]) < 1.0
    in_it = (runs & (context.extents.lane[rails] == kerb)).any(axis=0)
    by_rails: Flags = _pieces_by_rails(context)[pieces] | in_it
    return by_rails


def _tells_rails(context: DriveContext) -> bool:
    return "rail" in context.recording.complete or bool(level_crossings(context))


@once_a_road
def level_crossings(context: DriveContext) -> Stretches:
    """The intervals (m) along ego's road in which there are level crossings."""
    rows = context.road.rows
    flags = [any("level_crossing" in x.types for x in row if x is not None) for row in rows]
    return list(runs_along(context.road.borders, flags))


@once_a_road
def _pieces_by_rails(context: DriveContext) -> Flags:
    """Mask of the pieces of the road with a lane for rail vehicles beside the kerb lane."""
    lanelets = context.recording.lanelets
    near = "right_of" if context.side == "right" else "left_of"
    flags = []
    for row in context.road.rows:
        there = [lanelet for lanelet in row if lanelet is not None]
        outer = there[0] if context.side == "right" else there[-1]
        beside = lanelets.get(getattr(outer, near) or "")
        flags.append(beside is not None and "rail" in beside.types)
    return np.array(flags)

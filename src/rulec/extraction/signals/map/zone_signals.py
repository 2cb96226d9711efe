"""Signals of what ego drives through: level crossings, pedestrian crossings, the room beyond."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_signals import room_beside
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.driven_road import runs_along
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import is_there
from rulec.scenario.recorded.lane_coordinates import crossings_along

_LIGHTS_AT_CROSSING_M = 30.0
"""A light whose line is so near before a pedestrian crossing directs it, too."""

_BEFORE_LINE_M = 10.0
"""On maps without stop lines crossings are up to so far before the ends of lanelets with lights."""

_ROOM_M = 1.0
Stretches = Sequence[tuple[float, float]]


def zone_signals(context: DriveContext) -> SignalColumns:
    """The signals of crossings and of the room behind what ego enters."""
    rails = _rail_stretches(context)
    world: dict[str, SignalColumn] = {}
    unknown: dict[str, Flags] = {}
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    if "rail" in context.recording.complete or rails:
        zone, enters = np.zeros((2, context.states), dtype=bool)
        for start, end in rails:
            zone |= (front >= start - context.thresholds.zone_m) & (rear < end)
            enters |= np.append(False, (front[1:] > start) & (front[:-1] <= start))
        # Those of a net have gates that close while a train comes
        world |= {"level_crossing_zone": zone, "enters_level_crossing": enters, "guarded": zone}
        world["tracks_at_kerb"] = _tracks_at_kerb(context)
    world["crossing_kind"], unknown["crossing_kind"] = _crossing_kinds(context)
    places = [*context.road.junctions, *context.road.crossings, *rails]
    world["exit_clear"], unknown["exit_clear"] = _exit_clear(context, places)
    stands = context.ego.speed[0] * KMH < context.thresholds.standing_kmh
    world["way_cleared"] = stands | _at_edge(context)
    return SignalColumns(world, unknown=unknown)


def _rail_stretches(context: DriveContext) -> Stretches:
    rows = context.road.rows
    flags = [any("level_crossing" in x.types for x in row if x is not None) for row in rows]
    return list(runs_along(context.road.borders, flags))


def _tracks_at_kerb(context: DriveContext) -> Flags:
    """Flags of states in which the lane beside ego's road at the kerb is for rail vehicles."""
    lanelets = context.recording.lanelets
    near = "right_of" if context.side == "right" else "left_of"
    flags = []
    for row in context.road.rows:
        there = [lanelet for lanelet in row if lanelet is not None]
        outer = there[0] if context.side == "right" else there[-1]
        beside = lanelets.get(getattr(outer, near) or "")
        flags.append(beside is not None and "rail" in beside.types)
    return np.array(flags)[context.road.piece(context.ego_extents.s[0])]


def _crossing_kinds(context: DriveContext) -> tuple[SignalColumn, Flags]:
    """The kind of the crossing ahead: ``directed_crossing`` by a light of its own or ego's.

    It is unknown where there may be a light that nobody saw.
    """
    road = context.road
    walkers = {
        name: lanelet
        for name, lanelet in context.recording.lanelets.items()
        if "crosswalk" in lanelet.types and (lanelet.lights or "directed" in lanelet.types)
    }
    only = replace(context.recording, lanelets=walkers)
    directed = [
        start for start, _ in crossings_along(only, road.line, road.lanes, 0.0, road.line.length)
    ]
    # A net says itself which crossings have lights
    told = "light" in context.recording.complete
    lit, perhaps = (() if told else _directed_stretches(context, there) for there in (True, False))
    kinds = {
        start: "directed_crossing"
        if any(abs(start - other) < 1.0 for other in directed)
        or any(low <= start <= high for low, high in lit)
        else "zebra"
        for start, _ in road.crossings
    }
    unsure = {
        start: kind == "zebra" and any(low <= start <= high for low, high in perhaps)
        for start, kind in kinds.items()
    }
    start, _ = next_crossing(context)
    at = start.tolist()
    return (
        np.array([kinds.get(place, "zebra") for place in at]),
        np.array([unsure.get(place, False) for place in at], dtype=bool),
    )


def _directed_stretches(context: DriveContext, there: bool) -> Stretches:
    """From where to where on ego's road its lights direct those who cross, too.

    From shortly before a light's line on, up to the roads behind the junction that it stands at.
    ``there``: of lights that are surely there, else of all others.
    """
    road, stretches = context.road, []
    for row, end in zip(road.rows, road.borders[1:].tolist(), strict=True):
        lit = [lanelet for lanelet in row if lanelet is not None and lanelet.lights]
        if lit and any(is_there(light) for lanelet in lit for light in lanelet.lights) == there:
            drawn = lit[0].stop_line
            place = np.nan
            if drawn is not None:
                place = float(road.line.coordinates(drawn.mean(axis=0)[None])[0, 0])
            near = abs(place - end) <= _LIGHTS_AT_CROSSING_M
            last = [
                high + context.thresholds.side_road_m
                for low, high in road.junctions
                if low <= end + _LIGHTS_AT_CROSSING_M and high > end
            ]
            begin = place if near else end - _BEFORE_LINE_M
            stretches.append((begin, max([end + _LIGHTS_AT_CROSSING_M, *last])))
    return stretches


def _at_edge(context: DriveContext) -> Flags:
    (right, left), edge = room_beside(context), context.thresholds.at_edge_m
    return (np.minimum(right, left) < edge) & (np.abs(right - left) > edge)


def _exit_clear(context: DriveContext, places: Stretches) -> tuple[Flags, Flags]:
    """Is there room for ego behind what it enters, and where is that unknown?

    There is none if the one ahead leaves too little behind the place where it is at that time, and
    it makes ego stand on it, where others cross or join its way. Where the recording ends before
    ego is through it is unknown. What ego enters is the last place that it has got to, and before
    any the next one.
    """
    clear, unknown = np.ones(context.states, dtype=bool), np.zeros(context.states, dtype=bool)
    own, size = context.ego_extents, context.ego_extents.s_max[0] - context.ego_extents.s_min[0]
    front, rear = own.s_max[0], own.s_min[0]
    stands = context.ego.speed[0] * KMH < context.thresholds.standing_kmh
    lanes = np.arange(context.touched.shape[-1])
    same = (context.touched & (lanes == context.ego_lane[None, :, None])).any(axis=-1)
    follows = same & context.going_along & (relations.station(context) == relations.BEHIND)
    entered = _entered(front, rear, places, context.thresholds.approach_m)
    for number, (start, end) in enumerate(places):
        if not (nears := entered == number).any():
            continue
        room = np.where(
            follows & (context.extents.s_max > end), context.extents.s_min - end, np.inf
        )
        inside = follows & (context.extents.s_max <= end) & (context.extents.s_max > start)
        taken = np.where(inside, context.extents.s_max - context.extents.s_min + _ROOM_M, 0.0)
        free = room.min(axis=0, initial=np.inf) - taken.sum(axis=0)
        short = free < size + _ROOM_M
        held = (front > _shared(context, start, end)) & (rear < end) & stands & short
        held_later = np.maximum.accumulate(held[::-1])[::-1]
        clear &= ~(nears & short & held_later)
        if not (rear >= end).any():
            unknown |= nears & short & ~held_later
    return clear, unknown & clear


def _shared(context: DriveContext, start: float, end: float) -> float:
    """Where others first cross or join ego's way in a junction; the beginning of any other place.

    A map's junction often begins at its lanelets' ends, some metres before the other road.
    """
    road, passages = context.road, context.surroundings.passages
    if (start, end) not in road.junctions:
        return start
    for piece in np.flatnonzero((road.borders[:-1] >= start) & (road.borders[:-1] < end)).tolist():
        edge = passages.first_meeting(road.lanelet(piece, road.own_lanes[piece]).id)
        if edge is not None:
            return float(road.borders[piece]) + edge
    return start


def _entered(front: Floats, rear: Floats, places: Stretches, reach: float) -> NDArray[intp]:
    """The number of the place that ego enters or is on, by state; -1 for none."""
    entered = np.full(len(front), -1)
    nearest = np.full(len(front), np.inf)
    for number, (start, _) in enumerate(places):
        ahead = (front <= start) & (front > start - reach) & (start < nearest)
        entered, nearest = np.where(ahead, number, entered), np.where(ahead, start, nearest)
    latest = np.full(len(front), -np.inf)
    for number, (start, end) in enumerate(places):
        on = (front > start) & (rear < end) & (start > latest)
        entered, latest = np.where(on, number, entered), np.where(on, start, latest)
    return entered

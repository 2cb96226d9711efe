"""Signals of what ego drives through: crossings, the road into which it turns, and room beyond."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext, once
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.level_crossing_signals import Stretches, level_crossings
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.map.stop_lines import drawn_lines
from rulec.extraction.signals.measured_numbers import corner_ahead
from rulec.extraction.signals.signal_columns import SignalColumns, ids_by_state
from rulec.extraction.signals.signal_passes import (
    SignalPasses,
    once_a_map,
    once_a_road,
)
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Recording, is_lane, is_there
from rulec.scenario.recorded.lane_coordinates import crossings_along
from rulec.scenario.recorded.route import lanelet_area

_LIGHTS_AT_CROSSING_M = 30.0
"""A light whose line is this near before a pedestrian crossing directs it, too."""

_BEFORE_LINE_M = 10.0
"""On maps without stop lines, crossings are up to this far before ends of lanelets with lights."""

ROOM_M = 1.0


def _crossing_kind(context: DriveContext) -> SignalColumns:
    """The kind of the crossing ahead: ``directed_crossing`` by a light of its own or ego's.

    Unknown where there may be an unobserved light.
    """
    (start, _), directed = next_crossing(context), np.zeros(context.states, dtype=bool)
    unknown = np.zeros(context.states, dtype=bool)
    for place, (lit, unsure) in crossings_lit(context).items():
        directed |= (start == place) & lit
        unknown |= (start == place) & unsure
    kinds = np.where(directed, "directed_crossing", "zebra")
    return SignalColumns({"crossing_kind": kinds}, unknown={"crossing_kind": unknown})


@once_a_road
def crossings_lit(context: DriveContext) -> dict[float, tuple[bool, bool]]:
    """Where each crossing of the road begins -> whether a light directs it, and whether one may."""
    # A net itself states which crossings have lights
    told = "light" in context.recording.complete
    own = _starts(context, _crossings_with_lights(context))
    shared = [] if told else _starts(context, _crossings_over_lit_lanes(context))
    lit, perhaps = (() if told else _directed_stretches(context, there) for there in (True, False))
    untold = () if told else _junctions_with_lights_untold(context)
    found = {}
    for start, _ in context.road.crossings:
        directed = any(abs(start - other) < 1.0 for other in own)
        directed |= any(low <= start <= high for low, high in lit)
        unsure = any(low <= start <= high for low, high in (*perhaps, *untold))
        unsure |= any(abs(start - other) < 1.0 for other in shared)
        found[start] = directed, unsure and not directed
    return found


def side_road(context: DriveContext) -> tuple[Floats, Floats]:
    """Begin and end of where pedestrians cross the road into which ego turns, or infinity.

    Many maps draw the crossing of that road in the junction, at its end.
    """
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    start, end = np.full((2, context.states), np.inf)
    for low, high in reversed(_turns(context)):
        nears = (front > low - context.thresholds.approach_m) & (rear < high)
        beyond = high + context.thresholds.side_road_m
        drawn = [a for a, b in context.road.crossings if low + high < a + b and a < high]
        start = np.where(nears, min([high, *drawn]), start)
        end = np.where(nears, beyond, end)
    return start, end


def _turns(context: DriveContext) -> list[tuple[float, float]]:
    """The stretches of ego's road in junctions at which it turns."""
    return [x for x in context.road.junctions if turn_at(context, *x) != "straight_on"]


def in_turn(context: DriveContext) -> Flags:
    """Mask of states in which ego has driven into a junction at which it turns, and is not out."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    inside = np.zeros(context.states, dtype=bool)
    for low, high in _turns(context):
        inside |= (front >= low) & (rear < high)
    return inside


def in_side_road(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of pedestrians on the lanes of ego's direction, not before it turns.

    Those who cross the road on which it comes, or wait to, do not cross the one into which it
    turns.
    """
    on_lanes = context.on_lanes[rows] & context.tracks.on_lane[rows]
    found: Flags = on_lanes & ~_on_crossings_before(context, rows)
    return found


def _starts(context: DriveContext, crossings: Recording) -> list[float]:
    """Where (m) the crossings of a recording begin on ego's road."""
    return [start for start, _ in _stretches(context, crossings)]


def _stretches(context: DriveContext, crossings: Recording) -> Stretches:
    """The stretches (m) of ego's road that the crossings of a recording cover."""
    road = context.road
    line, again = road.line, road.meets_itself
    return list(crossings_along(crossings, line, road.lanes, 0.0, line.length, meets_itself=again))


def _on_crossings_before(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of those on a crossing of the road on which ego comes to where it turns.

    Also up to ``at_edge_m`` from it, where they wait for it: on a corner, ways of those who turn
    may lie over that place. Not those who are on a crossing of the road into which it turns too.
    """
    before, beyond = _crossings_at_turns(context)
    tracks, found = context.tracks, np.zeros((len(rows), context.states), dtype=bool)
    cells = (context.relevant[rows] & tracks.on_lane[rows]).nonzero()
    if len(cells[0]) and not before.is_empty:
        middles = shapely.points(tracks.x[rows][cells], tracks.y[rows][cells])
        at_it = shapely.distance(before, middles) <= context.thresholds.at_edge_m
        found[cells] = at_it & ~shapely.intersects(beyond, middles)
    return found


@once_a_road
def _crossings_at_turns(context: DriveContext) -> tuple[shapely.Geometry, shapely.Geometry]:
    """The areas of crossings of ego's road before the middles of its turns, and beyond these."""
    reach = context.thresholds.side_road_m
    sides: tuple[list[shapely.Geometry], list[shapely.Geometry]] = ([], [])
    for name, lanelet in context.recording.lanelets.items():
        if "crosswalk" in lanelet.types:
            its = replace(context.recording, lanelets={name: lanelet})
            for begin, end in _stretches(context, its):
                for low, high in _turns(context):
                    if end > low - reach and begin < high + reach:
                        sides[begin + end > low + high].append(lanelet_area(lanelet))
    before, beyond = map(shapely.union_all, sides)
    return before, beyond


@once_a_map
def _crossings_with_lights(context: DriveContext) -> Recording:
    """The recording with only those pedestrian crossings that have lights of their own."""
    walkers = {
        name: lanelet
        for name, lanelet in context.recording.lanelets.items()
        if "crosswalk" in lanelet.types and (lanelet.lights or "directed" in lanelet.types)
    }
    return replace(context.recording, lanelets=walkers)


@once_a_map
def _crossings_over_lit_lanes(context: DriveContext) -> Recording:
    """The recording with only those pedestrian crossings over which lanes with lights lead."""
    lanelets = context.recording.lanelets
    walkers = {name: x for name, x in lanelets.items() if "crosswalk" in x.types}
    lit = [lanelet_area(x) for x in lanelets.values() if x.lights and is_lane(x)] if walkers else []
    lit += [
        way.area
        for junction in context.surroundings.passages.junctions
        for way in junction.ways
        if walkers and any(lanelets[x].lights for x in way.entries if x in lanelets)
    ]
    area = shapely.union_all(lit)
    over = {name: x for name, x in walkers.items() if area.intersects(lanelet_area(x))}
    return replace(context.recording, lanelets=over)


def _junctions_with_lights_untold(context: DriveContext) -> Stretches:
    """Intervals of ego's road with possible lights that its own lanes do not have.

    At junctions, including the crossings of the roads there: some formats contain no lights at all,
    others only those that were observed, so that lights for traffic from elsewhere mean that ego's
    way may have them, too.
    """
    reach, seen = context.thresholds.side_road_m, map_contents(context).lights
    known = context.recording.lanelets
    lit = [
        junction
        for junction in context.surroundings.passages.junctions
        if any(known[x].lights for way in junction.ways for x in way.entries if x in known)
    ]
    names = {name for junction in lit for way in junction.ways for name in way.names}
    return [
        (low - reach, high + reach)
        for low, high in context.road.junctions
        if not seen or names & _lanelets_between(context, low, high)
    ]


def _lanelets_between(context: DriveContext, low: float, high: float) -> set[str]:
    """The ids of the lanelets of ego's road that begin in between."""
    starts = context.road.borders.tolist()
    return {
        lanelet.id
        for row, start in zip(context.road.rows, starts, strict=False)
        if low - 0.1 <= start < high
        for lanelet in row
        if lanelet is not None
    }


def _directed_stretches(context: DriveContext, there: bool) -> Stretches:
    """The intervals of ego's road where its lights also direct pedestrians.

    From shortly before a light's line up to the roads behind the junction at which it stands.
    ``there``: for lights that surely exist, else for all others.
    """
    road, stretches = context.road, []
    for piece, row in enumerate(road.rows):
        end = float(road.borders[piece + 1])
        lit = [lanelet for lanelet in row if lanelet is not None and lanelet.lights]
        if lit and any(is_there(light) for lanelet in lit for light in lanelet.lights) == there:
            place = drawn_lines(context).get((piece, lit[0].id), np.nan)
            near = abs(place - end) <= _LIGHTS_AT_CROSSING_M
            last = [
                high + context.thresholds.side_road_m
                for low, high in road.junctions
                if low <= end + _LIGHTS_AT_CROSSING_M and high > end
            ]
            begin = place if near else end - _BEFORE_LINE_M
            stretches.append((begin, max([end + _LIGHTS_AT_CROSSING_M, *last])))
    return stretches


def _exit_clear(context: DriveContext) -> SignalColumns:
    """Whether ego has room behind the place that it enters; and where that is unknown.

    There is none if a vehicle ahead, at walking pace at most while ego stands, leaves too little
    room behind the place, so that ego has to stand on it where others cross or join its way.
    Unknown where the recording ends before ego is through, where tolerances decide whether ego
    stands there, and for a vehicle ahead that always stands: ego may wait to drive round it. The
    place is the last one that ego has reached, and before any the next one.
    """
    places = [*context.road.junctions, *context.road.crossings, *level_crossings(context)]
    clear, unknown = np.ones(context.states, dtype=bool), np.zeros(context.states, dtype=bool)
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    stands = context.ego.speed[0] * KMH_PER_MPS < context.thresholds.standing_kmh
    entered = _entered(front, rear, places, context.thresholds.approach_m)
    if not any((entered == number).any() for number in range(len(places))):
        nobody = np.zeros(context.relevant.shape, dtype=bool)
        return _room_beyond(context, clear, unknown, nobody)
    error = context.tolerances.place_m
    beyond = corner_ahead(context) + error
    ahead = _ahead_on_lane(context)
    still, nearest = _standing_rows(context, ahead), np.zeros_like(ahead)
    holds_up = context.tracks.speed * KMH_PER_MPS < context.thresholds.walking_pace_kmh
    for number, (start, end) in enumerate(places):
        nears, passed = entered == number, context.spans.any(rear >= end)
        place = _shared(context, start, end)
        stuck = (front - beyond > place) & (rear + beyond < end) & stands
        perhaps = (front + error > place) & (rear - error < end) & stands
        if not (nears & (~passed | context.spans.any(perhaps))).any():
            continue
        short, may_be_short, stops, may_stop = (
            _free_beyond(context, those, (start, end)) < front - rear + ROOM_M
            for those in (ahead & ~still, ahead, ahead & ~still & holds_up, ahead & holds_up)
        )
        # One that leaves too little room when ego comes leaves too little when ego stands
        takes = ahead & ~still & (context.extents.s_min - end < front - rear + ROOM_M)
        same = takes & _until(context, takes & (stuck & stops))
        blocked = nears & short & same.any(axis=0)
        clear &= ~blocked
        nearest |= blocked & (ahead & ~still)
        may_be = _until(context, perhaps & may_stop) | ~passed
        unknown |= nears & may_be_short & ~blocked & may_be
    where = np.where(nearest, context.extents.s_min, np.inf)
    nearest &= where == where.min(axis=0, initial=np.inf)
    return _room_beyond(context, clear, unknown, nearest)


def _room_beyond(
    context: DriveContext, clear: Flags, unknown: Flags, nearest: Flags
) -> SignalColumns:
    return SignalColumns(
        {"exit_clear": clear},
        unknown={"exit_clear": unknown & clear},
        whom={"exit_clear": ids_by_state(nearest, context.ids)},
    )


def _until(context: DriveContext, flags: Flags) -> Flags:
    """Mask of states at or before a state of the drive in which ``flags`` hold."""
    held: Flags = context.spans.next_state(flags) < context.spans.end
    return held


def _standing_rows(context: DriveContext, ahead: Flags) -> Flags:
    """Mask, one per row, of those ever ahead that stand for as long as they are recorded."""
    still, rows = np.zeros((len(ahead), 1), dtype=bool), ahead.any(axis=1).nonzero()[0]
    still[rows, 0] = context.stays[rows]
    return still


def _free_beyond(context: DriveContext, ahead: Flags, place: tuple[float, float]) -> Floats:
    """How much room (m) those ahead in ego's lane leave behind a place, by state."""
    others, (start, end) = context.extents, place
    room = np.where(ahead & (others.s_max > end), others.s_min - end, np.inf)
    inside = ahead & (others.s_max <= end) & (others.s_max > start)
    taken = np.where(inside, others.s_max - others.s_min + ROOM_M, 0.0)
    free: Floats = room.min(axis=0, initial=np.inf) - taken.sum(axis=0)
    return free


@once
def _ahead_on_lane(context: DriveContext) -> Flags:
    """Mask of vehicles that go ego's way ahead of it and reach into its lane."""
    ahead: Flags = (
        context.in_ego_lane & context.going_along & (relations.station(context) == relations.BEHIND)
    )
    return ahead & ~_left_aside(context, ahead)


def _left_aside(context: DriveContext, ahead: Flags) -> Flags:
    """Mask of those ahead that always stand and leave ego room to pass in its lane."""
    aside, still = np.zeros(ahead.shape, dtype=bool), _standing_rows(context, ahead).nonzero()[0]
    if len(still):
        others, own = context.extents.part(still, slice(None)), context.ego_extents
        left, _ = others.from_bound(context.ego_lane)
        _, right = others.from_bound(context.ego_lane + 1)
        room = own.d_max[0] - own.d_min[0] + 2 * context.thresholds.touching_m
        aside[still] = np.maximum(left, -right) >= room
    return aside


def _shared(context: DriveContext, start: float, end: float) -> float:
    """Where others first cross or join ego's way in a junction; for other places, their beginning.

    A map's junction often begins at its lanelets' ends, some metres before the other road.
    """
    road, passages = context.road, context.surroundings.passages
    if (start, end) not in road.junctions:
        return start
    for piece in ((road.borders[:-1] >= start) & (road.borders[:-1] < end)).nonzero()[0].tolist():
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


zone_signals = SignalPasses(
    {
        ("crossing_kind",): _crossing_kind,
        ("exit_clear",): _exit_clear,
    }
)
"""The signals of crossings and of the room behind what ego enters."""

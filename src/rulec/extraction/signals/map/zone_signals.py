"""Signals of what ego drives through: crossings, the road into which it turns, and room beyond."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once_a_map, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.map.stop_lines import drawn_lines
from rulec.extraction.signals.signal_columns import Measured
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import Stretches, reach_into
from rulec.recordings.recording import Recording, is_lane, is_there
from rulec.scenario.recorded.lane_coordinates import crossings_along
from rulec.scenario.recorded.route import lanelet_area

_LIGHTS_AT_CROSSING_M = 30.0
"""A light whose line is this near before a pedestrian crossing directs it, too."""

_BEFORE_LINE_M = 10.0
"""On maps without stop lines, crossings are up to this far before ends of lanelets with lights."""


@word("crossing_kind")
def _crossing_kind(context: DriveContext) -> Measured:
    """The kind of the crossing ahead: ``directed_crossing`` by a light of its own or ego's.

    Unknown where there may be an unobserved light.
    """
    (start, _), directed = next_crossing(context), np.zeros(context.states, dtype=bool)
    doubtful = np.zeros(context.states, dtype=bool)
    for place, (lit, unsure) in crossings_lit(context).items():
        directed |= (start == place) & lit
        doubtful |= (start == place) & unsure
    return Measured(np.where(directed, "directed_crossing", "zebra"), doubtful)


@once_a_road
def crossings_lit(context: DriveContext) -> dict[float, tuple[bool, bool]]:
    """Where each crossing of the road begins -> whether a light directs it, and whether one may."""
    # A net itself states which crossings have lights
    told = "light" in context.recording.complete
    own = _starts(context, _crossings_with_lights(context))
    shared = [] if told else _starts(context, _crossings_over_lit_lanes(context))
    lit, others = (() if told else _directed_stretches(context, there) for there in (True, False))
    untold = () if told else _junctions_with_lights_untold(context)
    found = {}
    for start, _ in context.road.crossings:
        directed = any(abs(start - other) < 1.0 for other in own)
        directed |= any(low <= start <= high for low, high in lit)
        unsure = any(low <= start <= high for low, high in (*others, *untold))
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
    return reach_into(_turns(context), context.ego_extents.s_min[0], context.ego_extents.s_max[0])


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
    names = frozenset().union(*(junction.names for junction in lit))
    return [
        (low - reach, high + reach)
        for low, high in context.road.junctions
        if not seen or names & context.road.ids_between(low, high)
    ]


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

"""Signals of the map around ego: surface, limit, signs, crossings."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_recording, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import (
    CYCLE_LANE,
    SHOULDER,
    beyond_edges,
    lanelets_at,
    map_contents,
    may_hold,
    own_lanelets,
)
from rulec.extraction.signals.map.line_signals import own_light
from rulec.extraction.signals.map.stop_lines import may_have_passed, stop_line
from rulec.extraction.signals.measured_numbers import corner_ahead, own_front, own_widths
from rulec.extraction.signals.settling import only_when
from rulec.extraction.signals.signal_columns import (
    Measured,
    SignalColumn,
    SignalColumns,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import next_along
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import (
    BUSES_ONLY,
    CROSSWALK,
    CYCLES_TOO,
    LEAST_SPEED_SIGN,
    STOP_SIGNS,
    TAXIS_TOO,
    Lanelet,
)
from rulec.scenario.recorded.route import lanelet_area
from rulec.trace.partly_known.partly_known_values import Truth

NO_LIMIT_KMH = 1000.0
NO_CROSSING_M = 1000.0

_SIGNS: Mapping[str, tuple[Set[str], bool]] = {
    "give_way_sign": ({"YIELD"}, True),
    "stop_sign": (STOP_SIGNS, True),
    "no_overtaking_sign": ({"NO_OVERTAKING_START"}, False),
    "turn_on_red_sign": ({"GREEN_ARROW"}, True),
    "no_turn_on_red_sign": ({"NO_TURN_ON_RED"}, True),
}
"""Signal -> its signs, and whether they apply to the line at the lanelet's end."""

_CORNERS = ((1, 1), (1, -1), (-1, -1), (-1, 1))
"""Corners of a body: factors ahead and to the left of its middle."""

_SIGN_REACH_M = 20.0
"""The junction whose ways a sign is about begins at most this far behind the sign's line."""

_HAIR_M = 0.01

_OVERRULED = ("give_way_sign", "stop_sign")
_AT_WORK = ("green_light", "amber_light", "red_light")
"""Signs that determine priority, and the states of lights that override them."""

_SURFACES = {
    "busLane": "bus_lane",
    CYCLE_LANE: "cycle_lane",
    SHOULDER: "hard_shoulder",
    "level_crossing": "level_crossing",
}
"""Type of a lanelet -> surface; later entries override earlier ones."""

_PLAIN = "carriageway"


@word("distance_to_crossing")
def _distance_to_crossing(context: DriveContext) -> Measured | None:
    if not crossings_told(context):
        return None
    distance, place = distance_to_crossing(context), context.tolerances.place_m
    nearer, farther = (_to_crossing(context, way * place) for way in (-1, 1))
    return Measured(rounded(distance), bounds=rounded_outward(nearer, farther))


@word("crossing_zone")
def _crossing_zone(context: DriveContext) -> Truth | None:
    if not crossings_told(context):
        return None
    distance, zone = distance_to_crossing(context), context.thresholds.zone_m
    near, doubtful = distance <= zone, abs(distance - zone) < context.tolerances.place_m
    doubtful = _in_doubt(context, near, doubtful)
    # If only ego's rear is left on a crossing, laws do not say whether it is still there
    _, end = next_crossing(context)
    half_step_m = np.maximum(context.ego_extents.along[0], 0.0) * context.recording.step_s / 2
    doubtful |= context.ego_extents.s_max[0] + half_step_m > end - context.tolerances.place_m
    return Truth.known(near).unknown_at(doubtful)


@word("limit")
def _limit(context: DriveContext) -> Measured | None:
    if not map_contents(context).limits:
        return None
    return Measured(
        rounded(np.minimum(context.limit_mps * KMH_PER_MPS, NO_LIMIT_KMH)), context.limit_untold
    )


@word("minimum_limit")
def _minimum_limit(context: DriveContext) -> Measured | None:
    if not map_contents(context).minima:
        return None
    least = own_lanelets(context).values(lambda at: at.minimum_mps or 0.0)
    return Measured(rounded(np.array(least) * KMH_PER_MPS), may_hold(context, {LEAST_SPEED_SIGN}))


@word(*_SIGNS)
def _signs(context: DriveContext) -> SignalColumns:
    known = map_contents(context).signs | context.recording.complete
    found: dict[str, Truth] = {}
    for name, (signs, at_line) in _SIGNS.items():
        if signs & known:
            if at_line:
                holds = _holds_to_line(context, signs, of_junction=name in _OVERRULED)
            else:
                holds = Truth.known(own_lanelets(context).flags(_has_sign(signs)))
            found[name] = holds.or_possibly(may_hold(context, signs))
            if name in _OVERRULED and map_contents(context).lights:
                light, _ = own_light(context)
                found[name] &= Truth(~np.isin(light, (*_AT_WORK, "")), ~np.isin(light, _AT_WORK))
    return SignalColumns(found)


def _has_sign(signs: Set[str]) -> Callable[[Lanelet], bool]:
    return lambda lanelet: bool(signs & lanelet.signs)


def _is_of(kind: str) -> Callable[[Lanelet], bool]:
    return lambda lanelet: kind in lanelet.types


def _holds_to_line(context: DriveContext, signs: Set[str], *, of_junction: bool) -> Truth:
    """Whether one of these signs holds, up to its line.

    Decided by the place of ego's front one state before, so that the sign still holds when ego
    crosses the line; unknown where ego may just have crossed it. A sign ``of_junction`` determines
    priority there: it holds until ego drives in, as some lines are a few metres before that.
    """
    before = context.spans.before(own_front(context))
    holds, unseen = np.zeros((2, context.states), dtype=bool)
    for piece, row in enumerate(context.road.rows):
        if any(lanelet is not None and signs & lanelet.signs for lanelet in row):
            begins = float(context.road.borders[piece])
            for lane in np.unique(context.ego_lane).tolist():
                if signs & context.road.lanelet(piece, lane).signs:
                    first, line = stop_line(context, piece, lane)
                    if of_junction:
                        line = max(line, _next_junction(context, first))
                    there = (before >= begins) & (before <= line)
                    holds |= there & (context.ego_lane == lane)
                    unseen |= may_have_passed(context, line) & (context.ego_lane == lane)
    return Truth(holds, holds | unseen)


def _next_junction(context: DriveContext, line: float) -> float:
    """Where the junction behind a line begins on ego's road; the line itself if none is near.

    A line within a junction, or at its end, belongs to that junction.
    """
    if any(low + _HAIR_M < line < high + _HAIR_M for low, high in context.road.junctions):
        return line
    behind = [low for low, _ in context.road.junctions if line <= low + _HAIR_M]
    return min((low for low in behind if low - line <= _SIGN_REACH_M), default=line)


def crossings_told(context: DriveContext) -> bool:
    """Whether the map would contain the pedestrian crossings that exist."""
    return CROSSWALK not in context.recording.lacks or CROSSWALK in map_contents(context).types


def distance_to_crossing(context: DriveContext) -> Floats:
    """The distance (m) from ego's front to the next pedestrian crossing, 0 on it."""
    return _to_crossing(context, 0.0)


def _to_crossing(context: DriveContext, more_m: float) -> Floats:
    start, _ = next_crossing(context)
    distance = start - context.ego_extents.s_max[0] + more_m
    within: Floats = np.minimum(np.maximum(distance, 0.0), NO_CROSSING_M)
    return within


@once
def next_crossing(context: DriveContext) -> tuple[Floats, Floats]:
    """Begin and end of ego's present or next pedestrian crossing by state, or infinity."""
    return next_along(context.road.crossings, context.ego_extents.s_min[0])


@word("surface")
def _surface(context: DriveContext) -> Measured:
    """What ego is on: a crossing if any part of it is on one, else the surface at its middle.

    That is of its road's lanes, or beside them of a hard shoulder which the map does not link to
    them. Unknown where tolerances decide, or where no more than a corner, turned to it, is on the
    crossing: the direction of a body is known less well than its place, and some sources turn
    standing vehicles.
    """
    if not (context.road.junctions or context.road.crossings or _kinds(context)):
        return Measured(np.full(context.states, _PLAIN))
    middle, place = context.ego_extents.s[0], context.tolerances.place_m
    surfaces = _below_middle(context, middle, context.ego_lane)
    others = [_below_middle(context, middle + way * place, context.ego_lane) for way in (-1, 1)]
    if (context.steady_lane != context.ego_lane).any():
        others.append(_below_middle(context, middle, context.steady_lane))
    doubtful = np.logical_or.reduce([other != surfaces for other in others])
    beside, near_its_edge = _on_shoulder_beside(context)
    surfaces[beside & (surfaces == _PLAIN)] = _SURFACES[SHOULDER]
    doubtful |= near_its_edge
    measured, crossing = _on_crossing(context)
    doubtful |= _may_share(context) & (surfaces == "bus_lane")
    surfaces[measured] = "crossing"
    doubtful = (doubtful | crossing.possible) & ~crossing.sure
    return Measured(surfaces, _in_doubt(context, surfaces, doubtful))


def _in_doubt(context: DriveContext, values: SignalColumn, doubtful: Flags) -> Flags:
    """Mask of doubtful states without those in which ego drives from one value to another.

    There only the moment is in doubt.
    """
    if not doubtful.any():
        return doubtful
    moves = context.ego_moves
    longest = context.steps_in(context.thresholds.passed_s)
    (passing,) = only_when(values[None], doubtful[None], moves[None], longest, context.spans)
    doubt: Flags = doubtful & ~passing
    return doubt


def _below_middle(context: DriveContext, middle: Floats, lane: NDArray[intp]) -> NDArray[np.str_]:
    """The surface at places along the road in given lanes, by state, without crossings."""
    surfaces = np.full(context.states, _PLAIN, dtype="<U14")
    for start, end in context.road.junctions:
        surfaces[(middle > start) & (middle < end)] = "junction"
    if kinds := _kinds(context):
        own = lanelets_at(context, middle, lane)
        cycles, taxis = _cycles_and_taxis(context)
        may = (cycles & own.flags(_is_of(CYCLES_TOO))) | (taxis & own.flags(_is_of(TAXIS_TOO)))
        for kind in kinds:
            surfaces[own.flags(_is_of(kind)) & ~may] = _SURFACES[kind]
    return surfaces


def _on_shoulder_beside(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of states with ego's middle beside its road's lanes, on a hard shoulder, and near it.

    Near is no farther from the lanes, or from the shoulder, than an edge is certain.
    """
    on_it, near = np.zeros((2, context.states), dtype=bool)
    shoulders = _shoulders_beside(context)
    if shoulders is None:
        return on_it, near
    beyond = np.maximum(*beyond_edges(context))
    (there,) = (beyond > 0.0).nonzero()
    if not len(there):
        return on_it, near
    error = context.tolerances.place_m + np.abs(context.map_offset_m)
    error = np.broadcast_to(np.maximum(context.thresholds.changed_m, error), on_it.shape)[there]
    places = shapely.points(context.ego.x[0, there], context.ego.y[0, there])
    away = shapely.distance(places, shoulders)
    on_it[there] = away == 0.0
    near[there] = np.where(away == 0.0, beyond[there] < error, away < error)
    return on_it, near


@once_a_road
def _shoulders_beside(context: DriveContext) -> shapely.Geometry | None:
    """The area of the map's hard shoulders that are no lanes of ego's road; None without any."""
    if SHOULDER not in map_contents(context).types:
        return None
    own = {x.id for row in context.road.rows for x in row if x is not None}
    lanelets = context.recording.lanelets.values()
    areas = [lanelet_area(x) for x in lanelets if SHOULDER in x.types and x.id not in own]
    if not areas:
        return None
    area = shapely.union_all(areas)
    shapely.prepare(area)
    return area


def _cycles_and_taxis(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of states in which ego is a cycle or a taxi, whom some lanes for buses are for, too."""
    taxis = [participant.type == "taxi" for participant in context.ego.participants]
    return context.spans.spread(context.ego.of_type("cyclist")), context.spans.spread(taxis)


def _may_share(context: DriveContext) -> Flags:
    """Mask of states in which ego is on a lane for buses and the map does not say whether it may.

    Many lanes for buses are for cycles or taxis as well, and few maps name their users.
    """
    if "busLane" not in _kinds(context):
        return np.zeros(context.states, dtype=bool)
    unnamed = own_lanelets(context).flags(
        lambda lanelet: "busLane" in lanelet.types and BUSES_ONLY not in lanelet.types
    )
    return unnamed & np.logical_or(*_cycles_and_taxis(context))


def _kinds(context: DriveContext) -> list[str]:
    """The types of lanelets on the map that are surfaces."""
    return [kind for kind in _SURFACES if kind in map_contents(context).types]


def _on_crossing(context: DriveContext) -> tuple[Flags, Truth]:
    """Where a part of ego is on a crossing: as measured, and as far as that is known.

    A slanting crossing begins farther along the road for one lane than for another: where its area
    is drawn, that decides.
    """
    own, place = context.ego_extents, context.tolerances.place_m
    front, rear = own.s_max[0], own.s_min[0]
    found = np.zeros((3, context.states), dtype=bool)
    for start, end in context.road.crossings:
        for flags, less in zip(found, (0.0, corner_ahead(context) + place, -place), strict=True):
            flags |= (front - less >= start) & (rear + less < end)
    measured, *halves = found & _meets_crossing(context, np.logical_or.reduce(found))
    return measured, Truth(*halves)


def _meets_crossing(context: DriveContext, states: Flags) -> Flags:
    """Mask of those states in which ego's body is on the area of a crossing, or may be."""
    found = np.zeros(context.states, dtype=bool)
    (there,) = states.nonzero()
    if not len(there):
        return found
    ego, widths = context.ego, own_widths(context)[there] / 2
    heading = ego.heading[0, there]
    lengths = context.spans.spread(context.own.passages.lengths[ego.rows])[there] / 2
    ahead = np.stack((np.cos(heading), np.sin(heading)), axis=-1)
    left = np.stack((-ahead[:, 1], ahead[:, 0]), axis=-1) * widths[:, None]
    ahead *= lengths[:, None]
    middle = np.stack((ego.x[0, there], ego.y[0, there]), axis=-1)
    corners = np.stack([middle + i * ahead + k * left for i, k in _CORNERS], axis=1)
    away = shapely.distance(shapely.polygons(corners), _crossing_areas(context))
    found[there] = away <= context.tolerances.place_m
    return found


@once_a_recording
def _crossing_areas(context: DriveContext) -> shapely.Geometry:
    """The area of all pedestrian crossings on the map."""
    lanelets = context.recording.lanelets.values()
    return shapely.union_all([lanelet_area(x) for x in lanelets if CROSSWALK in x.types])

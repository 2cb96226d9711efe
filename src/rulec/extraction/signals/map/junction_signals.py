"""Signals of junctions: entering, turning, crossing stop lines."""

from __future__ import annotations

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents, may_hold, own_lanelets
from rulec.extraction.signals.map.priority_signals import (
    approach,
    drive_by_drive,
    own_passages,
    passages_of,
)
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.map.stop_lines import (
    has_stop_sign,
    may_have_passed,
    may_pass,
    own_lines,
    passes,
)
from rulec.extraction.signals.measured_numbers import own_front
from rulec.extraction.signals.signal_columns import Measured, SignalColumns, world_signals
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import Stretches, reach_into
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import STOP_SIGNS, STRAIGHT_ON
from rulec.trace.partly_known.partly_known_values import Truth

_SLOWEST_MPS = 5.0
"""A vehicle that stands at the end of a drive is assumed to go on this fast."""

_ASKEW_RAD = np.radians(10.0)
"""A body lies this far askew in its lane only in a turn."""

_SWEEPS_M = 10.0
"""The middle of a longer body cuts the corner in a turn."""


@word("junction_zone")
def _junction_zone(context: DriveContext) -> Flags:
    return _at_junctions(context, context.road.junctions)


def _at_junctions(context: DriveContext, junctions: Stretches) -> Flags:
    """Mask of states in which ego is at a junction, given by intervals of its road."""
    own = context.ego_extents
    return reach_into(junctions, own.s_min[0], own.s_max[0], context.thresholds.zone_m)


@word("enters_junction")
def _enters_junction(context: DriveContext) -> Truth:
    enters, unseen = np.zeros((2, context.states), dtype=bool)
    for start, _ in context.road.junctions:
        enters |= passes(context, start)
        unseen |= may_have_passed(context, start)
    return Truth.known(enters).unknown_at(unseen)


@word("turn", "preparing_to_leave")
def _turns(context: DriveContext) -> SignalColumns:
    turn = np.full(context.states, "straight_on", dtype="<U11")
    bends = np.zeros(context.states, dtype=bool)
    for start, end in context.road.junctions:
        at_junction = _at_junctions(context, [(start, end)])
        turn[at_junction] = turn_at(context, start, end)
        bends |= at_junction & _bends_straight_on(context, start, end)
    bends &= turn != "straight_on"
    not_told = way_not_known(context) | bends
    limits = context.thresholds
    leaves = ((turn != "straight_on") & ~bends) | _on_exit(context)
    prepares = _within_preparation(context, leaves, limits.standing_kmh)
    # In a creeping queue it is unknown since when
    longer = _within_preparation(context, leaves | not_told, limits.walking_pace_kmh)
    preparing = Truth(prepares, prepares | longer | _may_turn_later(context))
    return world_signals(turn=Measured(turn, not_told), preparing_to_leave=preparing)


@word("all_way_stop")
@drive_by_drive
def _all_way_stop(context: DriveContext) -> SignalColumns:
    """Whether all roads to the junction that ego nears or is in have stop signs."""
    if not _tells_stop_signs(context):
        return SignalColumns()
    sure, possible = np.zeros((2, context.states), dtype=bool)
    for passage in own_passages(context):
        stop = context.surroundings.passages.junctions[passage.junction].all_have_to_stop
        sure[approach(context, passage)] = stop is True
        possible[approach(context, passage)] = stop is not False
    return SignalColumns({"all_way_stop": Truth(sure, possible)})


def _tells_stop_signs(context: DriveContext) -> bool:
    return bool(STOP_SIGNS & (context.recording.complete | map_contents(context).signs))


def _bends_straight_on(context: DriveContext, start: float, end: float) -> bool:
    """Whether a way that the map calls straight on turns ego's road at a junction: it may bend."""
    road, least = context.road, np.radians(context.thresholds.turned_deg)
    pieces = ((road.borders[:-1] >= start - 0.1) & (road.borders[:-1] < end)).nonzero()[0]
    for piece in pieces.tolist():
        way = road.rows[piece][road.own_lanes[piece]]
        if way is not None and STRAIGHT_ON in way.types:
            low, high = road.borders[piece : piece + 2].tolist()
            if abs(road.turned(low, high, aside_m=1.0)) > least:
                return True
    return False


def _on_exit(context: DriveContext) -> Flags:
    """Mask of states in which ego is on a lane that leaves the road."""
    return own_lanelets(context).flags(lambda lanelet: "exitRamp" in lanelet.types)


def way_not_known(context: DriveContext) -> Flags:
    """Mask of states at a junction where the drive does not show which way ego takes."""
    rear = context.ego_extents.s_min[0]
    not_known = np.zeros(context.states, dtype=bool)
    for start, end in context.road.junctions:
        at_junction = _at_junctions(context, [(start, end)])
        ends = context.spans.any(at_junction) & ~context.spans.any(rear >= end)
        for number, columns in context.spans.those(ends):
            parts = _ways_part(context, start, columns)
            if parts and not _on_known_way(context, (start, end), number):
                not_known[columns] |= at_junction[columns]
    return not_known


def at_unknown_way(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask of those of ``rows`` that are about a junction at which ego's way is not known."""
    found = np.zeros(context.relevant.shape, dtype=bool)
    found[rows] = context.relevant[rows] & way_not_known(context)
    cells = found.nonzero()
    about = np.zeros(len(cells[0]), dtype=bool)
    places = shapely.points(context.tracks.x[cells], context.tracks.y[cells])
    for junction in context.surroundings.passages.junctions:
        about |= shapely.dwithin(junction.area, places, context.thresholds.side_road_m)
    found[cells] = about
    return found


def _ways_part(context: DriveContext, start: float, columns: slice) -> bool:
    """Whether ways lead to different sides from the lane on which ego reaches a junction.

    Also if the only ways turn: an ego that has not driven in may have reached its destination. And
    if none begins there, as where the map misses a link: its road is then that of another lane.
    """
    piece = max(int(context.road.piece(np.array(start - 1e-6))), 0)
    near = int(np.abs(context.ego_extents.s_max[0, columns] - start).argmin())
    entry = context.road.lanelet(piece, int(context.ego_lane[columns][near]))
    ways = [
        way
        for junction in context.surroundings.passages.junctions
        for way in junction.ways
        if entry.id in way.entries
    ]
    turned = [0.0, *(way.turned for way in ways)]
    return not ways or bool(max(turned) - min(turned) > np.radians(context.thresholds.turned_deg))


def _on_known_way(context: DriveContext, stretch: tuple[float, float], number: int) -> bool:
    """Whether ego's passage of a junction on its road, in a drive, shows which way it takes."""
    passages, inside = context.own.passages, context.road.ids_between(*stretch)
    return any(
        passage.sure and inside & passages.way(passage).names
        for passage in passages_of(context, number)
    )


def _may_turn_later(context: DriveContext) -> Flags:
    """Mask of states so near the drive's end that ego may turn soon after it.

    Not if no junction is so near that ego would reach it at its last speed.
    """
    if not context.road.junctions:
        return np.zeros(context.states, dtype=bool)
    thresholds, last = context.thresholds, context.spans.end - 1
    front, speed = context.ego_extents.s_max[0, last], context.ego.speed[0, last]
    nearest = np.full(context.states, np.inf)
    for start, _ in context.road.junctions:
        way = start - thresholds.zone_m - front
        nearest = np.where(way > 0, np.minimum(nearest, way), nearest)
    soonest = nearest / np.maximum(speed, _SLOWEST_MPS)
    driven = _time_driven(context, thresholds.walking_pace_kmh)
    flags: Flags = driven[last] - driven + soonest <= thresholds.preparing_s
    return flags


def _within_preparation(context: DriveContext, flags: Flags, pace_kmh: float) -> Flags:
    """Mask of states with a flag now or within ``preparing_s``: ego's actions show its intentions.

    While ego is slower than ``pace_kmh`` it waits for its turn, and the time does not count.
    """
    if not flags.any():
        return flags
    due, driven = context.spans.next_state(flags), _time_driven(context, pace_kmh)
    left = driven[np.minimum(due, context.states - 1)] - driven
    most = context.thresholds.preparing_s + context.recording.step_s / 2
    within: Flags = (due < context.spans.end) & (left <= most)
    return within


def _time_driven(context: DriveContext, pace_kmh: float) -> Floats:
    """How long (s) ego has driven at ``pace_kmh`` or faster up to each state."""
    drives = context.ego.speed[0] * KMH_PER_MPS >= pace_kmh
    driven: Floats = (drives.cumsum() - drives) * context.recording.step_s
    return driven


@word("crosses_stop_line")
def _crosses_stop_line(context: DriveContext) -> Truth | None:
    """Whether ego crosses the line of a lanelet with a stop sign; unknown where it perhaps does.

    Perhaps if its drive ends while it moves between the places where the line may be, or begins
    just beyond the line, or where errors of places decide, as when it stands at the line.
    """
    if not _tells_stop_signs(context):
        return None
    crosses, unseen = np.zeros((2, context.states), dtype=bool)
    front, ends = own_front(context), context.spans.columns == context.spans.end - 1
    for _, _, on_lane, first, last in own_lines(context, has_stop_sign):
        unsure = (may_pass(context, last) | may_have_passed(context, last)) & on_lane
        crosses |= passes(context, last) & on_lane & ~unsure
        on_it = (first < front) & (front <= last) & on_lane
        unseen |= unsure | (ends & on_it & context.ego_moves)
    unseen |= context.ego_moves & may_hold(context, STOP_SIGNS)
    return Truth(crosses, crosses | unseen)


@once
def lies_askew_in_turn(context: DriveContext) -> Flags:
    """Mask of states in which ego's body, partly in a junction where it turns, is still askew.

    Also where it drives onto a roundabout, or leaves it. The middle of a long body is off its lane
    there, even if the body lies along the lane.
    """
    (front,), (rear,) = context.ego_extents.s_max, context.ego_extents.s_min
    turns = np.zeros(context.states, dtype=bool)
    for start, end in context.road.junctions:
        if abs(context.road.turned(start, end, aside_m=1.0)) > 2 * _ASKEW_RAD:
            turns |= (front > start) & (rear < end)
    askew = np.abs(context.ego_extents.turned[0]) > _ASKEW_RAD
    swings: Flags = turns & (askew | (front - rear > _SWEEPS_M))
    return swings


def turn_at(context: DriveContext, start: float, end: float) -> str:
    """Where ego's road goes at a junction from ``start`` to ``end``.

    Driving onto a roundabout, or along it, follows its bend: a turn is where ego leaves it.
    """
    if any(low - 0.1 <= start and end <= high + 0.1 for low, high, _ in roundabouts(context)):
        return "straight_on"
    turned = np.degrees(context.road.turned(start, end, aside_m=1.0))
    if abs(turned) <= context.thresholds.turned_deg:
        return "straight_on"
    if abs(turned) >= 180.0 - context.thresholds.turned_deg:
        return "turn_round"
    return "turn_near" if (turned < 0) == (context.side == "right") else "turn_far"

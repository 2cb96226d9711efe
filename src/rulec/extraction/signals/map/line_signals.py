"""Signals of what is ahead of ego: a line at which it may have to stop, its light, a junction."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents, own_lanelets
from rulec.extraction.signals.map.junction_signals import way_not_known
from rulec.extraction.signals.map.stop_lines import (
    around_crossing,
    has_line,
    lines_on_road,
    may_have_passed,
    may_pass,
    may_stop_beyond,
    own_lines,
    passes,
    stop_line,
    unseen_steps,
)
from rulec.extraction.signals.measured_numbers import LONGEST_S, own_front, own_speed
from rulec.extraction.signals.signal_columns import (
    Measured,
    SignalColumn,
    SignalColumns,
    rounded,
    rounded_outward,
    world_signals,
)
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.driven_road import DrivenRoad, next_along
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import STOP_SIGNS, Light, ObservedLight, Recording
from rulec.trace.partly_known.partly_known_values import Truth

_NO_JUNCTION_M = 1000.0

_AMBER = "amber_light"

COLOURS = {
    "red": "red_light",
    "redYellow": "red_light",
    "yellow": _AMBER,
    "green": "green_light",
    "inactive": "no_light",
}


@word("distance_to_stop_line", "time_to_stop_line")
def _to_line(context: DriveContext) -> SignalColumns:
    """The distance to the line, and the time that ego takes to reach it."""
    if not _tells_lines(context):
        return SignalColumns()
    way, (near, far) = _way_to_line(context)
    (speed, error), drives = own_speed(context), context.ego_moves
    ahead = far > 0

    def seconds(distance: Floats, at_mps: Floats) -> Floats:
        goes = drives & (at_mps > 0)
        taken = np.minimum(distance / np.where(goes, at_mps, 1.0), LONGEST_S)
        return np.where(ahead, np.where(goes, taken, LONGEST_S), 0.0)

    times = seconds(near, speed + error), seconds(far, speed - error)
    return world_signals(
        distance_to_stop_line=Measured(rounded(way), bounds=rounded_outward(near, far)),
        time_to_stop_line=Measured(rounded(seconds(way, speed)), bounds=rounded_outward(*times)),
    )


def _tells_lines(context: DriveContext) -> bool:
    known = map_contents(context)
    complete = {"light", "STOP"} <= context.recording.complete
    return complete or known.lights or bool(STOP_SIGNS & known.signs)


@once
def _way_to_line(context: DriveContext) -> tuple[Floats, tuple[Floats, Floats]]:
    """The distance (m) to the next line of ego's lane, 0 without one, and its bounds.

    Where the map has no line, it is at the nearest of the places where it may be.
    """
    front, place = own_front(context), context.tolerances.place_m
    touching = context.thresholds.touching_m
    way, near, far = np.zeros((3, context.states))
    for _, _, on_lane, first, last in own_lines(context, has_line):
        ahead = on_lane & (front <= last) & (front > first - context.thresholds.near_m)
        way[ahead] = np.maximum(first - front, 0.0)[ahead]
        near[ahead] = np.maximum(first - front - place, 0.0)[ahead]
        far[ahead] = np.maximum(last - touching - front + place, 0.0)[ahead]
    if STOP_SIGNS & map_contents(context).untold_signs:
        own = own_lanelets(context)
        may = own.flags(lambda lanelet: bool(STOP_SIGNS & lanelet.untold_signs))
        near[may] = 0.0
        far[may] = np.maximum(far, context.road.borders[-1] - front)[may]
    return way, (near, far)


@word("distance_to_junction")
def _to_junction(context: DriveContext) -> Measured:
    begin, _ = next_along(context.road.junctions, context.ego_extents.s_min[0])
    way, place = begin - context.ego_extents.s_max[0], context.tolerances.place_m
    to, *bounds = (np.clip(way + more, 0.0, _NO_JUNCTION_M) for more in (0.0, -place, place))
    return Measured(rounded(to), bounds=rounded_outward(bounds[0], bounds[1]))


@word("light", "crosses_light_line")
def _traffic_lights(context: DriveContext) -> SignalColumns:
    # Lights stand only where ways cross: without such a place there are none
    nowhere = not context.surroundings.passages.junctions and not context.road.crossings
    complete = "light" in context.recording.complete
    if not (nowhere or complete or map_contents(context).lights):
        return SignalColumns()
    front = own_front(context)
    light, crosses = own_light(context)
    unseen = front + context.thresholds.light_reach_m > context.road.borders[-1]
    untold = (light == "") | (unseen & nowhere & (not complete))
    return world_signals(
        light=Measured(light, untold),
        crosses_light_line=crosses,
    )


@once
def own_light(context: DriveContext) -> tuple[SignalColumn, Truth]:
    """The light for ego (empty if unknown), and whether ego crosses its line.

    In the state in which ego crosses the line, the light is still the one that it crosses. Unknown:
    where ego may have crossed it (``may_pass``, ``may_stop_beyond``, ``may_have_passed``), and for
    amber lights crossed at a place where it is unknown whether ego approached slowly enough to stop
    at once.
    """
    front = own_front(context)
    colours = np.full(context.states, "no_light", dtype="<U11")
    crosses, doubtful = np.zeros((2, context.states), dtype=bool)
    slow = context.ego.speed[0] * KMH_PER_MPS <= context.thresholds.stops_at_once_kmh
    for piece, lane, on_lane, first, last in own_lines(context, lambda at: at.lights):
        lights = lights_of(context.recording, context.road, piece, lane)
        if not lights:
            continue
        by_way = by_lane = light_shown(context, piece, lane)
        unseen = may_have_passed(context, last) & on_lane
        unsure = unseen | (may_pass(context, last) & on_lane)
        crossed = passes(context, last) & ~unsure
        doubtful |= unsure | (may_stop_beyond(context, (first, last)) & on_lane)
        ahead = ((front <= last) | unsure) & (front > first - context.thresholds.light_reach_m)
        while_crossing = around_crossing(context, front, (first, last))
        every = context.road.lanelet(piece, lane).lights
        several = way_not_known(context) if len(every) > len(lights) else crosses & False
        if several.any():
            by_lane = colours_at(every, context.steps)
        decided = (ahead | crossed) & on_lane
        shows = np.where(several, by_lane, by_way)
        colours = np.where(decided & ~crossed & ~unseen, shows, colours)
        for state in (decided & (crossed | unseen)).nonzero()[0].tolist():
            own = every if several[state] else lights
            around = while_crossing(state) if crossed[state] else None
            moments = around or (state,)
            shown = set((by_lane if several[state] else by_way)[[*moments]].tolist())
            if crossed[state] and around is None:
                shown.add("")
            if unseen[state]:
                shown |= _colours_unseen(context, own, state)
            crosses[state] |= crossed[state]
            colours[state] = shown.pop() if len(shown) == 1 else ""
            at_place = slow[[*moments]]
            amber = colours[state] == _AMBER and last - first > context.thresholds.touching_m
            doubtful[state] |= crossed[state] and amber and at_place.any() and not at_place.all()
    for state in _between_lights(context, colours, crosses):
        crosses[state], colours[state] = True, ""
    return colours, Truth.known(crosses).unknown_at(doubtful)


def _colours_unseen(
    context: DriveContext, lights: tuple[Light | ObservedLight, ...], state: int
) -> set[str]:
    """What lights showed in the time of the recording since ego was last seen before a state."""
    steps = int(unseen_steps(context)[context.spans.number[state]])
    until = int(context.steps[state])
    since = max(until - steps, context.surroundings.tracks.first)
    return set(colours_at(lights, np.arange(since, until)).tolist())


def _between_lights(context: DriveContext, colours: SignalColumn, crosses: Flags) -> list[int]:
    """The states in which ego crosses the lines of two lanes whose lights differ.

    It reaches into the other lane, or has come from it since the state before: it is unknown which
    light it passes. ``colours`` are those of its own lane where it ``crosses`` that lane's line.
    """
    own, lane, reach = context.ego_extents, context.ego_lane, context.thresholds.touching_m
    came_from = np.where(context.spans.columns > context.spans.first, np.roll(lane, 1), lane)
    found = set[int]()
    for piece, row in enumerate(context.road.rows):
        lit = [
            lane
            for own_piece, lane, lanelet in lines_on_road(context)
            if own_piece == piece
            and row[lane] is not None
            and lanelet.lights
            and lights_of(context.recording, context.road, piece, lane)
        ]
        for k in lit if len(row) > row.count(None) + 1 else ():
            inside = (own.left_of_max[0, :, k] > reach) & (own.left_of_min[0, :, k + 1] < -reach)
            beside = (inside | context.spans.before(inside) | (came_from == k)) & (lane != k)
            if not beside.any():
                continue
            line = stop_line(context, piece, k)
            moments = around_crossing(context, own_front(context), line)
            colour = light_shown(context, piece, k)
            for state in (beside & passes(context, line[1])).nonzero()[0].tolist():
                shown = set(colour[[*(moments(state) or ())]].tolist()) or {""}
                # Ego's own lane has no line there, or ego came from beside to the one farther on
                past = int(lane[state]) not in lit or came_from[state] == k
                differs = past and not shown <= {"green_light", "no_light"}
                if shown != {colours[state]} if crosses[state] else differs:
                    found.add(state)
    return sorted(found)


def lights_of(
    recording: Recording, road: DrivenRoad, piece: int, lane: int
) -> tuple[Light | ObservedLight, ...]:
    """The lights for the way on of a lane, as far as the map distinguishes them.

    A way without lights, beside others with lights, passes by them, if the map has all lights.
    """
    lanelet = road.lanelet(piece, lane)
    if lanelet.lights_to and piece + 1 < len(road.rows):
        onward = road.lanelet(piece + 1, lane).id
        if onward in lanelet.lights_to:
            return (lanelet.lights_to[onward],)
        if "light" in recording.complete and onward in lanelet.successors:
            return ()
    return lanelet.lights


@once
def light_shown(context: DriveContext, piece: int, lane: int) -> NDArray[np.str_]:
    """What the lights for the way on of a lane show, by state."""
    return colours_at(lights_of(context.recording, context.road, piece, lane), context.steps)


def colours_at(lights: tuple[Light | ObservedLight, ...], steps: NDArray[intp]) -> NDArray[np.str_]:
    """What lights show at some time steps; empty where it is unknown or differs."""
    shown = [_colours_of(light, steps) for light in lights] or [np.full(len(steps), "")]
    alike = np.logical_and.reduce([colours == shown[0] for colours in shown])
    return np.where(alike, shown[0], "")


def _colours_of(light: Light | ObservedLight, steps: NDArray[intp]) -> NDArray[np.str_]:
    if isinstance(light, ObservedLight):
        shown = [light.colour_at(step) for step in steps.tolist()]
        return np.array([COLOURS.get(colour, "") for colour in shown], dtype=np.str_)
    colours, durations = zip(*light.phases, strict=True)
    ends = np.cumsum(durations)
    phases = ends.searchsorted((steps - light.begin) % ends[-1], "right")
    shows: NDArray[np.str_] = np.array([COLOURS.get(colour, "") for colour in colours])[phases]
    return shows

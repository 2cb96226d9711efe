"""Signals of junctions and traffic lights: entering, turning, crossing stop lines."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.extraction.tracks.tracks import Flags, Floats

_COLOURS = {
    "red": "red_light",
    "redYellow": "red_light",
    "yellow": "amber_light",
    "green": "green_light",
    "inactive": "no_light",
}


def junction_signals(context: DriveContext) -> SignalColumns:
    """The signals of junctions on ego's road, their lights and signs."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    zone = np.zeros(context.states, dtype=bool)
    enters = np.zeros(context.states, dtype=bool)
    turn = np.full(context.states, "straight_on", dtype="<U11")
    for start, end in context.road.junctions:
        at_junction = (front >= start - context.thresholds.zone_m) & (rear < end)
        zone |= at_junction
        enters |= _passes(front, start)
        turn[at_junction] = _turn(context, start, end)
    world: dict[str, SignalColumn] = {
        "junction_zone": zone,
        "enters_junction": enters,
        "turn": turn,
        "preparing_to_leave": _within_preparation(turn != "straight_on", context),
    }
    unknown: dict[str, Flags] = {}
    if any("STOP" in lanelet.signs for lanelet in context.recording.lanelets.values()):
        world["crosses_stop_line"] = _crosses_stop_line(context, front)
    if any(lanelet.lights for lanelet in context.recording.lanelets.values()):
        world["light"], world["crosses_light_line"] = _lights(context, front)
        unknown["light"] = world["light"] == ""
    return SignalColumns(world, unknown=unknown)


def _within_preparation(flags: Flags, context: DriveContext) -> Flags:
    """Flags that hold now or within ``preparing_s``: intentions are read off what ego did."""
    states = round(context.thresholds.preparing_s / context.recording.step_s)
    ahead = np.append(np.cumsum(flags[::-1])[::-1], 0)
    until = np.minimum(np.arange(context.states) + states + 1, context.states)
    return ahead[:-1] > ahead[until]


def _passes(front: Floats, line: float) -> Flags:
    beyond = front > line
    return np.append(False, beyond[1:] & ~beyond[:-1])


def _crosses_stop_line(context: DriveContext, front: Floats) -> Flags:
    """Flags of ego leaving a lanelet with a stop sign, at whose end the line is."""
    crosses = np.zeros(context.states, dtype=bool)
    lanes = context.ego_lane.tolist()
    for piece, end in enumerate(context.road.borders[1:].tolist()):
        for state in np.flatnonzero(_passes(front, end)).tolist():
            crosses[state] |= "STOP" in context.road.lanelet(piece, lanes[state]).signs
    return crosses


def _turn(context: DriveContext, start: float, end: float) -> str:
    line = context.road.line
    turned = np.degrees(line.heading_at(end + 1.0) - line.heading_at(start - 1.0))
    turned = (turned + 180.0) % 360.0 - 180.0
    if abs(turned) <= context.thresholds.turned_deg:
        return "straight_on"
    if abs(turned) >= 180.0 - context.thresholds.turned_deg:
        return "turn_round"
    return "turn_near" if (turned < 0) == (context.side == "right") else "turn_far"


def _lights(context: DriveContext, front: Floats) -> tuple[SignalColumn, Flags]:
    """The light for ego, empty for several colours, and flags of ego crossing its line.

    A light is for who is on its lanelet, at whose end the line is. In the state in which ego
    crosses the line the light is still the one that it crosses.
    """
    colours = np.full(context.states, "no_light", dtype="<U11")
    crosses = np.zeros(context.states, dtype=bool)
    lanes = context.ego_lane.tolist()
    for piece in range(len(context.road.rows) - 1, -1, -1):
        line = float(context.road.borders[piece + 1])
        passes = _passes(front, line)
        ahead = (front <= line) & (front > line - context.thresholds.light_reach_m)
        for state in np.flatnonzero(ahead | passes).tolist():
            lights = context.road.lanelet(piece, lanes[state]).lights
            if lights:
                step = context.first_step + state
                shown = {_COLOURS.get(light.colour_at(step), "") for light in lights}
                colours[state] = shown.pop() if len(shown) == 1 else ""
                crosses[state] |= passes[state]
    return colours, crosses

"""What ego does at junctions and lights: entering, turning, crossing stop lines."""

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


def junction_signals(view: DriveContext) -> SignalColumns:
    """Words about junctions on ego's road, and about the lights and signs before them."""
    front, rear = view.own.s_max[0], view.own.s_min[0]
    zone = np.zeros(view.states, dtype=bool)
    enters = np.zeros(view.states, dtype=bool)
    turn = np.full(view.states, "straight_on", dtype="<U11")
    for start, end in view.road.junctions:
        here = (front >= start - view.thresholds.zone_m) & (rear < end)
        zone |= here
        enters |= _passes(front, start)
        turn[here] = _turn(view, start, end)
    world: dict[str, SignalColumn] = {
        "junction_zone": zone,
        "enters_junction": enters,
        "turn": turn,
        "preparing_to_leave": _soon(turn != "straight_on", view),
    }
    unknown: dict[str, Flags] = {}
    if any("STOP" in one.signs for one in view.recording.lanelets.values()):
        world["crosses_stop_line"] = _crosses_stop_line(view, front)
    if any(one.lights for one in view.recording.lanelets.values()):
        world["light"], world["crosses_light_line"] = _lights(view, front)
        unknown["light"] = world["light"] == ""
    return SignalColumns(world, unknown=unknown)


def _soon(happens: Flags, view: DriveContext) -> Flags:
    """Is it so, or will it be soon? What ego is about to do is known from what it did."""
    states = round(view.thresholds.preparing_s / view.recording.step_s)
    ahead = np.append(np.cumsum(happens[::-1])[::-1], 0)
    until = np.minimum(np.arange(view.states) + states + 1, view.states)
    soon: Flags = ahead[:-1] > ahead[until]
    return soon


def _passes(front: Floats, line: float) -> Flags:
    """The state in which ego's front is beyond a line for the first time."""
    beyond = front > line
    return np.append(False, beyond[1:] & ~beyond[:-1])


def _crosses_stop_line(view: DriveContext, front: Floats) -> Flags:
    """Where ego leaves a lanelet with a stop sign: its line is at the end."""
    found = np.zeros(view.states, dtype=bool)
    for piece, end in enumerate(view.road.borders[1:].tolist()):
        for state in np.flatnonzero(_passes(front, end)).tolist():
            found[state] |= "STOP" in view.road.lanelet(piece, int(view.lane[state])).signs
    return found


def _turn(view: DriveContext, start: float, end: float) -> str:
    """Where ego's road goes at a junction."""
    line = view.road.line
    turned = np.degrees(line.heading_at(end + 1.0) - line.heading_at(start - 1.0))
    turned = (turned + 180.0) % 360.0 - 180.0
    if abs(turned) <= view.thresholds.turned_deg:
        return "straight_on"
    if abs(turned) >= 180.0 - view.thresholds.turned_deg:
        return "turn_round"
    return "turn_near" if (turned < 0) == (view.side == "right") else "turn_far"


def _lights(view: DriveContext, front: Floats) -> tuple[SignalColumn, Flags]:
    """The light that is for ego, empty if it shows several colours, and where its line is crossed.

    A light is for who is on its lanelet, at whose end the line is. In the state in which ego
    crosses the line the light is still the one that it crosses.
    """
    colours = np.full(view.states, "no_light", dtype="<U11")
    crosses = np.zeros(view.states, dtype=bool)
    lanes = view.lane.tolist()
    for piece in range(len(view.road.rows) - 1, -1, -1):
        line = float(view.road.borders[piece + 1])
        passes = _passes(front, line)
        ahead = (front <= line) & (front > line - view.thresholds.light_reach_m)
        for state in np.flatnonzero(ahead | passes).tolist():
            lights = view.road.lanelet(piece, lanes[state]).lights
            if lights:
                step = view.first_step + state
                shown = {_COLOURS.get(one.colour_at(step), "") for one in lights}
                colours[state] = shown.pop() if len(shown) == 1 else ""
                crosses[state] |= passes[state]
    return colours, crosses

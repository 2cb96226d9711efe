"""Traffic lights of a SUMO net whose programmes are known."""

from __future__ import annotations

from collections.abc import Mapping

from rulec.scenario.recorded.recording import Light
from rulec.scenario.sumo.net import SignalProgramme, SumoNet

COLOURS: Mapping[str, str] = {
    "r": "red",
    "s": "red",
    "u": "redYellow",
    "y": "yellow",
    "Y": "yellow",
    "g": "green",
    "G": "green",
    "o": "inactive",
    "O": "inactive",
}
"""SUMO's letters, and CommonRoad's words; ``s`` is red with an arrow that lets turn right."""


def lane_lights(net: SumoNet, step_s: float) -> dict[str, list[Light]]:
    """Lane -> the lights at its end, one for each way on.

    Only ways on with a light of their own count.

    A light that reacts to traffic, or has several programmes, has none that the net could tell.
    """
    lights: dict[str, list[Light]] = {}
    for connection in net.connections:
        programmes = net.programmes.get(connection.light, [])
        if len(programmes) != 1 or programmes[0] is None:
            continue
        light = _light(programmes[0], connection.link, step_s)
        known = lights.setdefault(connection.start, [])
        if light is not None and light not in known:
            known.append(light)
    return lights


def unknown_lights(net: SumoNet) -> list[str]:
    """The lights whose programme is not known."""
    return [name for name, known in net.programmes.items() if len(known) > 1 or None in known]


def _light(programme: SignalProgramme, link: int, step_s: float) -> Light | None:
    phases: list[tuple[str, int]] = []
    ends, done = 0.0, 0
    for duration, letters in programme.phases:
        if not 0 <= link < len(letters):
            return None
        ends += duration
        steps = round(ends / step_s) - done
        done += steps
        colour = COLOURS.get(letters[link], "inactive")
        if phases and phases[-1][0] == colour:
            phases[-1] = colour, phases[-1][1] + steps
        elif steps:
            phases.append((colour, steps))
    return Light(round(programme.begin / step_s), tuple(phases)) if phases else None

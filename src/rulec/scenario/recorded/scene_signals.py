"""Signals that the map supplies: signs, traffic lights, the number of lanes.

The words are those of the vocabulary ``road``. What the file does not say is not made up: such a
signal is missing, and the rulebook's own default holds.
"""

from __future__ import annotations

from collections.abc import Sequence

from rulec.scenario.recorded.recording import Lanelet
from rulec.scenario.scenario_model import SignalValue

LIGHT_FOR_S = 10.0
"""A light counts if all of ego's show one colour for so long from time 0 on."""

LANELETS_TO_A_LIGHT = 2
"""Ego's light is that of its own lanelet, or else of the next one."""

_SIGNS = {
    "YIELD": "give_way_sign",
    "STOP": "stop_sign",
    "NO_OVERTAKING_START": "no_overtaking_sign",
}
_COLOURS = {"red": "red_light", "yellow": "amber_light", "green": "green_light"}
_MOTORWAYS = {"highway", "interstate"}
_COUNTS = {1: "one_lane", 2: "two_lanes"}
_KMH = 3.6


def map_signals(
    ahead: Sequence[Lanelet], lanes: int, step_s: float, step: int
) -> dict[str, tuple[SignalValue, str]]:
    """Signal -> value, and where it comes from.

    ``ahead`` are the lanelets of ego's road from its own on, ``lanes`` how many there are beside
    each other, ``step`` the one at which time 0 is.
    """
    own = ahead[0]
    signals: dict[str, tuple[SignalValue, str]] = {}
    here = f"lanelet {own.id}"
    if own.limit_mps is not None:
        signals["limit"] = round(own.limit_mps * _KMH, 2), f"the limit of {here}"
    for sign, signal in _SIGNS.items():
        if sign in own.signs:
            signals[signal] = True, f"the sign of {here}"
    if own.types & _MOTORWAYS:
        signals["road_class"] = "motorway", f"the type of {here}"
    count = _COUNTS.get(lanes, "three_or_more_lanes")
    signals["lanes"] = count, f"{lanes} at ego's place that lead its way"
    lit = next((lanelet for lanelet in ahead[:LANELETS_TO_A_LIGHT] if lanelet.lights), None)
    if lit is not None:
        steps = range(step, step + round(LIGHT_FOR_S / step_s) + 1)
        shown = {light.colour_at(k) for light in lit.lights for k in steps}
        if len(shown) == 1 and (colour := shown.pop()) in _COLOURS:
            signals["light"] = _COLOURS[colour], f"the traffic lights of lanelet {lit.id}"
    return signals

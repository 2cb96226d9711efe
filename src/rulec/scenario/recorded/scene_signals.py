"""Signals of a scene: signs, traffic lights and lanes of the map, and congestion.

The words are those of the vocabulary ``road``. What the file does not say is not made up: such a
signal is missing, and the rulebook's own default holds. No file states congestion, though: traffic
is congested where the median speed of the vehicles on ego's road that go ego's way is below a
threshold. Speeds are those at which they cover the road from time 0 on, for a second if the
recording goes on so long: in some recordings the speed that is written down is another one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from statistics import median

from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.recorded.recording import Lanelet
from rulec.scenario.scenario_model import Obstacle, SignalValue

FEWEST = 3
"""So many vehicles it takes for traffic to be congested."""

_FOR_S = 1.0

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


def congested(obstacles: Iterable[Obstacle], road: Box, below_kmh: float) -> tuple[bool, str]:
    """The decision if traffic is congested, and its reason."""
    speeds = [
        speed * _KMH
        for obstacle in obstacles
        if "vehicle" in (obstacle.type, *obstacle.broader)
        and (speed := _speed(obstacle, road)) is not None
    ]
    if len(speeds) < FEWEST:
        few = f"it takes {FEWEST} vehicles that go ego's way on its road, here {len(speeds)}"
        return False, few
    middle = median(speeds)
    relation = "below" if middle < below_kmh else "not below"
    compared = f"{middle:.1f} km/h, {relation} {below_kmh:g} km/h"
    return middle < below_kmh, f"the median speed of {len(speeds)} vehicles is {compared}"


def _speed(obstacle: Obstacle, road: Box) -> float | None:
    """The speed along the road (m/s); None off the road, or for oncoming traffic."""
    now = swept(obstacle, 0.0, 0.0)
    then = swept(obstacle, _FOR_S, _FOR_S)
    if now is None or then is None or not now.overlaps(road):
        return None
    speed = now.shift_to(then)[0] / _FOR_S
    # Who stands may drift backwards by what the recording is inexact
    return max(speed, 0.0) if speed > -1.0 else None

"""Congestion, found from the speeds of vehicles: no CommonRoad file states it.

Traffic is congested where the median speed of the vehicles on ego's road that go ego's way is below
a threshold. Speeds are those at which they cover the road from time 0 on, for a second if the
recording goes on so long: in some recordings the speed that is written down is another one.
"""

from __future__ import annotations

from collections.abc import Iterable
from statistics import median

from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.scenario_model import Obstacle

FEWEST = 3
"""So many vehicles it takes for traffic to be congested."""

_FOR_S = 1.0
_KMH = 3.6


def congested(obstacles: Iterable[Obstacle], road: Box, below_kmh: float) -> tuple[bool, str]:
    """The decision if traffic is congested, and its reason."""
    speeds = [
        speed * _KMH
        for obstacle in obstacles
        if "vehicle" in (obstacle.type, *obstacle.broader)
        and (speed := _speed(obstacle, road)) is not None
    ]
    if len(speeds) < FEWEST:
        return (
            False,
            f"it takes {FEWEST} vehicles that go ego's way on its road, here {len(speeds)}",
        )
    middle = median(speeds)
    relation = "below" if middle < below_kmh else "not below"
    compared = f"{middle:.1f} km/h, {relation} {below_kmh:g} km/h"
    return middle < below_kmh, f"the median speed of {len(speeds)} vehicles is {compared}"


def _speed(obstacle: Obstacle, road: Box) -> float | None:
    """The speed along the road (m/s), or None.

    It is None off the road, or for oncoming traffic.
    """
    now = swept(obstacle, 0.0, 0.0)
    then = swept(obstacle, _FOR_S, _FOR_S)
    if now is None or then is None or not now.overlaps(road):
        return None
    speed = (then.s_min + then.s_max - now.s_min - now.s_max) / 2 / _FOR_S
    # Who stands may drift backwards by what the recording is inexact
    return max(speed, 0.0) if speed > -1.0 else None

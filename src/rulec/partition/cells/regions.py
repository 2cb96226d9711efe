"""Regions around one obstacle and their names.

An obstacle's rectangle, as wide as the extent demands, divides the road in three both ways. A
region table names the nine parts, row by row from right to left, each row in the direction of
``s``; ``o`` is the obstacle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from rulec.partition.cells.roadway import Roadway
from rulec.scenario import Box, Obstacle
from rulec.scenario.motion import facing
from rulec.scenario.paper_words import LATERALS, PAPER_TABLES, STATIONS

PartitionName = Literal["paper", "fine"]

ExtentName = Literal["lane", "clearance", "body"]
"""The assumed width of an obstacle: the lanes that it touches, these without the part of one in
which ego can pass beside it, or what it sweeps."""

OCCUPIED = ord("o")

_FINE = b"0123o5678"

STATION_OF: Mapping[int, str] = MappingProxyType(
    {code: STATIONS[i % 3] for i, code in enumerate(_FINE) if code != OCCUPIED}
)
"""The station (along the road) that a code of the fine partition means."""

LATERAL_OF: Mapping[int, str] = MappingProxyType(
    {code: LATERALS[i // 3] for i, code in enumerate(_FINE) if code != OCCUPIED}
)
"""The lateral relation (across the road) that a code of the fine partition means."""


@dataclass(frozen=True, slots=True)
class Region:
    """The rectangle of an obstacle, with the codes of the parts around it."""

    obstacle: int
    extent: Box
    table: bytes


def region_of(
    *,
    obstacle: Obstacle,
    index: int,
    body: Box,
    interval: tuple[float, float],
    partition: PartitionName,
    roadway: Roadway,
    extent: ExtentName,
    wide: Box,
) -> Region | None:
    """Region of an obstacle that sweeps ``body``; None off the road.

    ``wide`` is the body widened by the room that ego's centre needs on either side.
    """
    lanes = roadway.lanes_touched(body)
    if lanes is None:
        return None
    if extent == "clearance":
        lanes = roadway.without_clear_part(lanes, body, wide)
    taken = wide if extent == "body" else Box(body.s_min, body.s_max, *lanes)
    if partition == "fine":
        return Region(index, taken, _FINE)
    direction = facing(obstacle, *interval) if obstacle.walks else "along"
    if direction in ("left", "right"):
        crossing = Box(*roadway.crossing_touched(body), body.d_min, body.d_max)
        taken = wide if extent == "body" else crossing
    return Region(index, taken, PAPER_TABLES[direction])

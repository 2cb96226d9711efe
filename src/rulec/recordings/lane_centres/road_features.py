"""Roads as the data of motion forecasting have them: lanes as lines, and what is beside them.

After Waymo's map (https://waymo.com/open/data/motion/, ``map.proto``), which others follow.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import LaneMark, Points
from rulec.value_display import short_repr

Places3d = NDArray[float64]
"""Places: one row each, x, y and z (m); z may be NaN."""


@dataclass(frozen=True, slots=True)
class BoundaryPart:
    """Between two points of a lane's centre, by number, a line or edge is its boundary."""

    start: int
    end: int
    line: str
    mark: LaneMark | None


@dataclass(frozen=True, slots=True)
class NeighbourPart:
    """Between two points of a lane's centre another one is beside it, from where to where."""

    lane: str
    start: int
    end: int
    other_start: int
    other_end: int


@dataclass(frozen=True, slots=True, kw_only=True)
class LaneSide:
    """What is on one side of a lane."""

    boundaries: tuple[BoundaryPart, ...] = ()
    neighbours: tuple[NeighbourPart, ...] = ()


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CentreLane:
    """A lane by its centre.

    ``types`` are those of lanelets. ``follows`` and ``leads_to`` are the lanes before and after it.
    ``area`` is its outline where the file has one.
    """

    __repr__ = short_repr

    id: str
    centre: Places3d
    types: frozenset[str] = frozenset()
    limit_mps: float | None = None
    follows: tuple[str, ...] = ()
    leads_to: tuple[str, ...] = ()
    left: LaneSide = LaneSide()
    right: LaneSide = LaneSide()
    area: Points | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RoadFeatures:
    """All of a road: lanes, lines and edges, and crosswalks by id; where lights and signs are."""

    __repr__ = short_repr

    lanes: dict[str, CentreLane] = field(default_factory=dict)
    lines: dict[str, Points] = field(default_factory=dict)
    crosswalks: dict[str, Points] = field(default_factory=dict)
    stop_lanes: set[str] = field(default_factory=set)
    lights: dict[str, dict[int, str]] = field(default_factory=dict)

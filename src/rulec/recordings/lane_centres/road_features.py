"""Roads as motion forecasting data give them: lanes as lines, with what lies beside them.

The model is Waymo's map (https://waymo.com/open/data/motion/, ``map.proto``), which others follow.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import LaneMark, Points
from rulec.value_display import short_repr

Places3d = NDArray[float64]
"""Places, one row each: x, y and z (m); z may be NaN."""


@dataclass(frozen=True, slots=True)
class BoundaryPart:
    """A line or edge that bounds a lane between two points of its centre line, by index."""

    start: int
    end: int
    line: str
    mark: LaneMark | None


@dataclass(frozen=True, slots=True)
class NeighbourPart:
    """A neighbour between two points of a lane's centre line, with its own range of points."""

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
    """A lane given by its centre line.

    ``types`` are those of lanelets. ``follows`` and ``leads_to`` are the lanes before and after it.
    ``area`` is its outline, if the file contains one.
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
    """A road: lanes, lines, edges and crosswalks by id, and the positions of lights and signs."""

    __repr__ = short_repr

    lanes: dict[str, CentreLane] = field(default_factory=dict)
    lines: dict[str, Points] = field(default_factory=dict)
    crosswalks: dict[str, Points] = field(default_factory=dict)
    stop_lanes: set[str] = field(default_factory=set)
    lights: dict[str, dict[int, str]] = field(default_factory=dict)

"""A drive as a moving scene: road, lights, outlines of everybody, violations.

Places are metres in the recording's own frame, x to the right and y up, from ``origin``; a state is
a moment of the drive, from 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.monitoring.explain.margins import number_with_error
from rulec.recordings.recording import Points
from rulec.report.pictures.trace_ribbon import Ribbon
from rulec.rulebook.rulebook_model import Strength
from rulec.vocabulary.partial_values import Interval

Surface = Literal["lane", "crossing", "footway"]
MarkKind = Literal["solid", "broken", "unsaid"]


@dataclass(frozen=True, slots=True, eq=False)
class RoadArea:
    """A lanelet's area, with what is told of it where one points."""

    ring: Points
    surface: Surface
    tip: str


@dataclass(frozen=True, slots=True, eq=False)
class RoadMark:
    """A bound of lanes; ``unsaid`` is one of whose mark the map says nothing."""

    line: Points
    kind: MarkKind


@dataclass(frozen=True, slots=True, eq=False)
class SceneLight:
    """A light above its line, with its colours as (first state, colour)."""

    line: Points
    colours: tuple[tuple[int, str], ...]

    def colour_at(self, state: int) -> str:
        """Its colour in a state."""
        return next(colour for first, colour in reversed(self.colours) if first <= state)


@dataclass(frozen=True, slots=True)
class SceneSign:
    """A sign beside the road: what stands on it, and its name."""

    place: tuple[float, float]
    text: str
    name: str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Body:
    """A participant with its poses from state ``first`` on.

    ``poses`` are x, y and heading (rad) by state, NaN where it is not there or out of sight;
    ``shapes`` its outlines in its own frame, ``shape`` which of them it has; ``speeds`` km/h.
    """

    id: str
    type: str
    first: int
    poses: NDArray[float64]
    speeds: NDArray[float64]
    shapes: tuple[Points, ...]
    shape: NDArray[intp]

    def size(self) -> float:
        """Length times width of its first shape (m²)."""
        return float(np.ptp(self.shapes[0], axis=0).prod())

    def row(self, state: int) -> int | None:
        """The row of a state; None if it is not there."""
        row = state - self.first
        there = 0 <= row < len(self.poses) and not np.isnan(self.poses[row, 0])
        return row if there else None

    def outline(self, state: int) -> Points | None:
        """The corners of its body in a state; None if it is not there."""
        row = self.row(state)
        if row is None:
            return None
        x, y, heading = self.poses[row]
        cos, sin = np.cos(heading), np.sin(heading)
        shape = self.shapes[self.shape[row]]
        outline: Points = shape @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
        return outline


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SceneViolation:
    """A violation at the ``state`` that decides it, the last if only the end does.

    ``short`` names the rule's strength, its article and the objects; ``against`` are these by the
    ids of their participants. ``measured`` says by how much, a line for each comparison,
    ``deciding_values`` what else decides then; ``read`` is what the rule reads of these objects,
    ``decides`` which rows of it, and ``narrowly`` by row and state how narrowly a signal was
    decided, where it is known.
    ``links`` are, by state, the nearest points of ego and the other one (x, y, x, y), NaN where one
    of them is missing; ``gaps`` the rulebook's own gap (m) to it, None where it has none.
    """

    rule: str
    strength: Strength
    state: int
    time_s: float
    title: str
    short: str
    says: str
    against: tuple[str, ...]
    measured: tuple[str, ...]
    deciding_values: tuple[str, ...]
    read: Ribbon
    decides: frozenset[str]
    narrowly: Mapping[str, tuple[str, ...]]
    links: NDArray[float64]
    gaps: tuple[float | Interval | None, ...]

    def gap_text(self, state: int) -> str:
        """The distance to the other one in a state, empty if there is none."""
        ax, ay, bx, by = self.links[state].tolist()
        gap = self.gaps[state]
        if np.isnan(ax):
            return ""
        if isinstance(gap, Interval):
            return f"{number_with_error(gap.middle, gap.error, 1)} m"
        # Beside each other bodies have no gap along the road; what is drawn is measured then.
        return f"{gap or np.hypot(bx - ax, by - ay):.1f} m"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveScene:
    """What is to be seen of a drive in ``states`` states; ``bodies`` begin with ego."""

    title: str
    notes: tuple[str, ...]
    ego: str
    start_s: float
    step_s: float
    states: int
    areas: tuple[RoadArea, ...]
    marks: tuple[RoadMark, ...]
    lights: tuple[SceneLight, ...]
    signs: tuple[SceneSign, ...]
    bodies: tuple[Body, ...]
    violations: tuple[SceneViolation, ...]

    def time_s(self, state: int) -> float:
        """The recording's time (s) of a state."""
        return round(self.start_s + state * self.step_s, 9)

    def nearest_state(self, time_s: float) -> int:
        """The state whose time is nearest."""
        return round(min(max((time_s - self.start_s) / self.step_s, 0), self.states - 1))

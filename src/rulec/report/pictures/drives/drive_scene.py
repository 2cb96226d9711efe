"""A drive as a moving scene: road, lights, outlines of all participants, violations.

Positions are in m in the recording's frame, x to the right and y up, relative to ``origin``; a
state is a moment of the drive, counted from 0.
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
    """A lanelet's area, with a tip for the pointer."""

    ring: Points
    surface: Surface
    tip: str


@dataclass(frozen=True, slots=True, eq=False)
class RoadMark:
    """A boundary of lanes; ``unsaid`` if the map does not specify its marking."""

    line: Points
    kind: MarkKind


@dataclass(frozen=True, slots=True, eq=False)
class SceneLight:
    """A light at its stop line, with its colours as (first state, colour)."""

    line: Points
    colours: tuple[tuple[int, str], ...]

    def colour_at(self, state: int) -> str:
        """The colour in a state."""
        return next(colour for first, colour in reversed(self.colours) if first <= state)


@dataclass(frozen=True, slots=True)
class SceneSign:
    """A sign beside the road: its position, its text and its name."""

    place: tuple[float, float]
    text: str
    name: str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Body:
    """A participant with its poses from state ``first`` on.

    ``poses`` are x, y (m) and heading (rad) by state, NaN where it is absent or out of sight;
    ``shapes`` its outlines in its own frame, ``shape`` their index by state; ``speeds`` km/h.
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
        """The row of a state in ``poses``; None if the participant is absent."""
        row = state - self.first
        there = 0 <= row < len(self.poses) and not np.isnan(self.poses[row, 0])
        return row if there else None

    def outline(self, state: int) -> Points | None:
        """The corners of its outline in a state; None if it is absent."""
        row = self.row(state)
        if row is None:
            return None
        x, y, heading = self.poses[row]
        cos, sin = np.cos(heading), np.sin(heading)
        shape = self.shapes[self.shape[row]]
        outline: Points = shape @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
        return outline


_ASIDE_M = 0.5
"""A line that is longer than the gap along the road by more (m) leads to the side."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SceneViolation:
    """A violation at the ``state`` that decides it; the last state if only the end decides.

    ``short`` has the rule's strength, its article and the objects; ``against`` are the ids of these
    objects' participants. ``measured`` has a line for each comparison with its time and its margin,
    ``deciding_values`` the other values that decide; ``read`` is the ribbon of what the rule reads
    about the objects, ``decides`` the rows of it that decide, and ``narrowly`` maps a row to the
    margin of its signal by state, where known.
    ``links`` are, by state, the nearest points of ego and the other participant (x, y, x, y), NaN
    where one is absent; ``gaps`` is the rulebook's gap (m) to it, None where there is none.
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
        """The distance to the other participant in a state; empty if there is none."""
        ax, ay, bx, by = self.links[state].tolist()
        gap = self.gaps[state]
        if np.isnan(ax):
            return ""
        # Bodies beside each other have no gap along the road, and that of bodies on different
        # lanes says little of what is drawn; then the distance drawn is shown.
        drawn = float(np.hypot(bx - ax, by - ay))
        longest = gap.high if isinstance(gap, Interval) else gap
        if not longest or drawn > longest + _ASIDE_M:
            return f"{drawn:.1f} m"
        if isinstance(gap, Interval):
            return f"{number_with_error(gap.middle, gap.error, 1)} m"
        return f"{gap:.1f} m"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveScene:
    """The visible content of a drive in ``states`` states; the first of ``bodies`` is ego."""

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
        """The time of a state in the recording (s)."""
        return round(self.start_s + state * self.step_s, 9)

    def nearest_state(self, time_s: float) -> int:
        """The state nearest to a time."""
        return round(min(max((time_s - self.start_s) / self.step_s, 0), self.states - 1))

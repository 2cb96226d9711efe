"""A drive as a moving scene: road, lights, outlines of all participants, violations.

Positions are in m in the recording's frame, x to the right and y up, relative to ``origin``; a
state is a moment of the drive, counted from 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.monitoring.explain.margins import number_with_error
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Lanelet, LaneMark, Points, Recording
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


MAP_REACH_M = 150.0
"""A lanelet farther from ego's path (m) is not drawn."""

_FOOTWAYS = frozenset({"sidewalk", "bicycleLane"})
_MARKS: dict[LaneMark | None, MarkKind] = {
    "solid": "solid",
    "double_solid": "solid",
    "broken": "broken",
    None: "unsaid",
}
_SIGN_TEXTS = {
    "STOP": "STOP",
    "YIELD": "▽",
    "PRIORITY": "◇",
    "NO_OVERTAKING_START": "NO PASSING",
    "RIGHT_BEFORE_LEFT": "×",
}
_SAME_MARK_M = 0.2


def lanelets_near(recording: Recording, path: Points) -> list[Lanelet]:
    """The lanelets near a path; crosswalks come last, to be drawn over the others."""
    low, high = path.min(axis=0) - MAP_REACH_M, path.max(axis=0) + MAP_REACH_M
    near = [
        lanelet
        for lanelet in recording.lanelets.values()
        if _meets(lanelet, low, high) and _distance(lanelet, path) <= MAP_REACH_M
    ]
    return sorted(near, key=lambda lanelet: _surface(lanelet) == "crossing")


def _meets(lanelet: Lanelet, low: NDArray[float64], high: NDArray[float64]) -> bool:
    bounds = np.concatenate([lanelet.left, lanelet.right])
    return bool((bounds.max(axis=0) >= low).all() and (bounds.min(axis=0) <= high).all())


def _distance(lanelet: Lanelet, path: Points) -> float:
    """The smallest distance (m) of a sample of the path's points to a lanelet's centre line."""
    start, along = lanelet.centre[:-1], np.diff(lanelet.centre, axis=0)
    length = np.maximum((along**2).sum(axis=1), 1e-9)
    from_start = path[:: max(1, len(path) // 200), None, :] - start
    part = np.clip((from_start * along).sum(axis=2) / length, 0, 1)
    return float(np.hypot(*np.moveaxis(from_start - part[..., None] * along, 2, 0)).min())


def road_areas(lanelets: Iterable[Lanelet], origin: Points) -> Iterator[RoadArea]:
    """The area of each lanelet."""
    for lanelet in lanelets:
        kinds = ", ".join(sorted(lanelet.types))
        limit = lanelet.limit_mps
        speed = "" if limit is None else f", limit {limit * KMH_PER_MPS:.0f} km/h"
        ring = np.concatenate([lanelet.left, lanelet.right[::-1]]) - origin
        tip = f"lanelet {lanelet.id}{f', {kinds}' if kinds else ''}{speed}"
        yield RoadArea(ring, _surface(lanelet), tip)


def _surface(lanelet: Lanelet) -> Surface:
    if "crosswalk" in lanelet.types:
        return "crossing"
    return "footway" if lanelet.types & _FOOTWAYS else "lane"


def road_marks(lanelets: Sequence[Lanelet], origin: Points) -> Iterator[RoadMark]:
    """The boundaries of lanes, each once, even if neighbouring lanelets share it."""
    drawn: set[tuple[int, ...]] = set()
    for lanelet in lanelets:
        if _surface(lanelet) == "crossing":
            continue
        for line, mark in ((lanelet.left, lanelet.left_mark), (lanelet.right, lanelet.right_mark)):
            ends = sorted(np.round(line[[0, -1]] / _SAME_MARK_M).astype(int).tolist())
            place = (*ends[0], *ends[1])
            if place not in drawn and mark != "none":
                drawn.add(place)
                yield RoadMark(line - origin, _MARKS[mark])


def scene_lights(lanelets: Iterable[Lanelet], origin: Points, steps: range) -> Iterator[SceneLight]:
    """The lights of lanelets, with their colours over a range of time steps."""
    for lanelet in lanelets:
        end = np.stack([lanelet.left[-1], lanelet.right[-1]]) - origin
        for number, light in enumerate(lanelet.lights):
            colours: list[tuple[int, str]] = []
            for state, step in enumerate(steps):
                colour = light.colour_at(step)
                if not colours or colours[-1][1] != colour:
                    colours.append((state, colour))
            share = (end[1] - end[0]) / len(lanelet.lights)
            line = end[0] + share * np.array([[number], [number + 1]])
            yield SceneLight(line, tuple(colours))


def scene_signs(lanelets: Sequence[Lanelet], origin: Points) -> Iterator[SceneSign]:
    """The signs at the right of the road, where they begin to apply."""
    by_id = {lanelet.id: lanelet for lanelet in lanelets}
    for lanelet in lanelets:
        before = [by_id[name] for name in lanelet.predecessors if name in by_id]
        beside = [by_id[name] for name in (lanelet.right_of,) if name in by_id]
        shown = [
            (_SIGN_TEXTS[sign], sign.lower().replace("_", " "))
            for sign in sorted(lanelet.signs & _SIGN_TEXTS.keys())
            if not any(sign in other.signs for other in (*before, *beside))
        ]
        limit = lanelet.limit_mps
        if limit is not None and all(other.limit_mps != limit for other in (*before, *beside)):
            shown.append((f"{limit * KMH_PER_MPS:.0f}", f"limit {limit * KMH_PER_MPS:.0f} km/h"))
        across = lanelet.right[0] - lanelet.left[0]
        outwards = across / max(float(np.hypot(*across)), 1e-9)
        along = np.array([-outwards[1], outwards[0]])
        for number, (text, name) in enumerate(shown):
            at = lanelet.right[0] - origin + outwards * 1.8 + along * (1.0 + 3.5 * number)
            yield SceneSign((float(at[0]), float(at[1])), text, name)

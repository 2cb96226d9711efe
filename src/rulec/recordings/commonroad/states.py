"""States in a CommonRoad file: time step, position and motion.

Positions may be areas, and numbers intervals. The spread of time steps is limited, to bound memory.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import pi
from pathlib import Path
from typing import NamedTuple

from rulec.recordings.commonroad.areas import (
    Area,
    is_area,
    read_area,
    read_point,
    turned_once,
)
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording import MOST_STEPS, SPARSEST

SPARSEST_STATES = 200
"""At least one in this many pairs of an obstacle and a time step must have a state in the file."""

_NEVER_TOO_MANY = 2_000_000
_WAY_OUT = "look for a time that is wrong, or take a part"


@dataclass(slots=True)
class TimeExtent:
    """The time steps of the obstacles in a file, collected while it is read.

    ``repeated``: the number of steps in intervals of time, not counting the first one of each.
    """

    moments: set[int] = field(default_factory=set)
    states: int = 0
    repeated: int = 0

    def add(self, steps: Iterable[int]) -> None:
        """Note the time steps of states."""
        known = tuple(steps)
        self.moments.update(known)
        self.states += len(known)

    def check(self, path: Path, form: FileFormat, obstacles: int) -> None:
        """Raise RulecError R0610 if the time steps are too far apart for the number of states."""
        first, last = min(self.moments, default=0), max(self.moments, default=0)
        spread = last - first
        most = max(_NEVER_TOO_MANY, SPARSEST_STATES * self.states)
        too_far = spread > min(MOST_STEPS, SPARSEST * len(self.moments))
        if too_far or (spread + 1) * obstacles > most:
            why = (
                f"the time steps {first} to {last} are too far apart for its content "
                f"(obstacles: {obstacles:,}, states: {self.states:,})"
            )
            raise form.refused(path, why, help_text=_WAY_OUT)


def read_steps(tree: Tree, extent: TimeExtent) -> range:
    """The time steps in an element: an exact one, or an interval.

    Raises RulecError R0610 for intervals that are longer than any recording.
    """
    if (exact := tree.first("exact")) is not None:
        first = last = exact.whole()
    else:
        first, last = (tree.child(name).whole() for name in ("intervalStart", "intervalEnd"))
    if last < first:
        raise tree.wrong(f"an interval of time begins at step {first} and ends at {last}")
    extent.add((first, last))
    extent.repeated += last - first
    if extent.repeated > MOST_STEPS:
        why = f"its intervals of time have more than {MOST_STEPS:,} steps in total"
        raise tree.form.refused(tree.path, why, tree.place, help_text=_WAY_OUT)
    return range(first, last + 1)


class Bounds(NamedTuple):
    """The ends of an interval of numbers."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        """The middle of the interval."""
        return (self.low + self.high) / 2


class State(NamedTuple):
    """A state of an obstacle or of ego; an ``area``, if not empty, replaces the position (x, y)."""

    step: int
    x: float
    y: float
    area: Area
    heading: Bounds
    speed: float
    acceleration: float
    speed_error: float

    @property
    def is_exact(self) -> bool:
        """Whether position and heading are known exactly."""
        return not self.area and self.heading.low == self.heading.high


def read_state(tree: Tree, *, initial: bool = False) -> State:
    """The state in an element.

    Time, position and heading of an ``initial`` state are 0 if missing; in other states they are
    required. Speed and acceleration are 0 if missing.
    """
    fields = {child.name: child for child in reversed(tree.children)}
    for name in ("time", "position", "orientation"):
        if name not in fields and not initial:
            tree.child(name)
    time, heading, position = map(fields.get, ("time", "orientation", "position"))
    x, y, area = (0.0, 0.0, ()) if position is None else _place(position)
    speed = _interval(fields.get("velocity"))
    return State(
        step=0 if time is None else read_step(time),
        x=x,
        y=y,
        area=area,
        heading=Bounds(0.0, 0.0) if heading is None else _heading(heading),
        speed=speed.middle,
        acceleration=_interval(fields.get("acceleration")).middle,
        speed_error=(speed.high - speed.low) / 2,
    )


def read_states(trajectory: Tree) -> list[State]:
    """The states of a trajectory."""
    return [read_state(state) for state in trajectory.all("state")]


def read_step(tree: Tree) -> int:
    """The time step in an element with an exact value."""
    return tree.child("exact").whole()


def _interval(tree: Tree | None) -> Bounds:
    return Bounds(0.0, 0.0) if tree is None else _bounds(tree)


def _bounds(tree: Tree) -> Bounds:
    exact = tree.first("exact")
    if exact is not None:
        value = exact.number()
        return Bounds(value, value)
    if tree.first("intervalStart") is None:
        raise tree.wrong(f"the element `{tree.name}` has neither `exact` nor `intervalStart`")
    low, high = tree.child("intervalStart").number(), tree.child("intervalEnd").number()
    if low > high:
        raise tree.wrong(f"the interval of a `{tree.name}` begins at {low:g} and ends at {high:g}")
    return Bounds(low, high)


def _heading(tree: Tree) -> Bounds:
    low, high = _bounds(tree)
    if high - low >= 2 * pi:
        raise tree.wrong("an interval of angles is a full turn or more")
    begin = turned_once(low) if high > low else low
    return Bounds(begin, high + (begin - low))


def _place(tree: Tree) -> tuple[float, float, Area]:
    point = tree.first("point")
    if point is not None:
        return (*read_point(point), ())
    if not is_area(tree):
        raise tree.wrong(f"the element `{tree.name}` has neither a `point` nor a shape")
    return 0.0, 0.0, read_area(tree)

"""States in a CommonRoad file: time step, position and motion.

Positions may be areas, and numbers intervals.
"""

from __future__ import annotations

from math import pi
from typing import NamedTuple

from rulec.recordings.commonroad.areas import (
    Area,
    is_area,
    read_area,
    read_point,
    turned_once,
)
from rulec.recordings.encodings.tree import Tree


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

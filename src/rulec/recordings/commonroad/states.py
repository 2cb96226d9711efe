"""States of a CommonRoad file: when, where, and how it moves there.

Places may be areas, and numbers intervals.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from math import pi
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from rulec.recordings.commonroad.areas import (
    Area,
    is_area,
    read_area,
    read_point,
    turned_once,
    usual_numbers,
)
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.encodings.xml_tree import tree_of

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_STEP = re.compile("[0-9]{1,8}")


class Bounds(NamedTuple):
    """The ends of an interval of numbers."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        """The number in its middle."""
        return (self.low + self.high) / 2


class State(NamedTuple):
    """A state of an obstacle or of ego; an ``area`` stands for all the places in it."""

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
        """True if place and heading are known exactly."""
        return not self.area and self.heading.low == self.heading.high


def read_state(tree: Tree, *, initial: bool = False) -> State:
    """The state in an element.

    An ``initial`` one that does not say where it is, and when, is at 0; speed and acceleration are
    0 where they are left out.
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
    if not trajectory.raw:
        return [read_state(state) for state in trajectory.all("state")]
    states = _usual_states(trajectory.raw)
    if states is not None:
        return states
    path, form = trajectory.path, trajectory.form
    return [read_state(tree_of(element, path, form)) for element in trajectory.raw]


_TEXTS = (
    ("time", "exact"),
    ("position", "point", "x"),
    ("position", "point", "y"),
    ("orientation", "exact"),
    ("velocity", "exact"),
    ("acceleration", "exact"),
)
"""Where a state's numbers stand; the last may be left out, and is 0 then."""

_Pick: TypeAlias = "Callable[[Sequence[Element]], tuple[Element, ...]]"


def _usual_states(elements: Sequence[Element]) -> list[State] | None:
    """The states in elements that spell all numbers exactly; None if in some there is more."""
    picks: dict[tuple[str, ...], _Pick | None] = {}
    steps: list[str | None] = []
    texts: list[str | None] = []
    for element in elements:
        parts = list(element.iter())
        names = tuple([part.tag for part in parts])
        if names not in picks:
            picks[names] = _pick(parts)
        pick = picks[names]
        if pick is None:
            return None
        step, *others = [part.text for part in pick(parts)]
        steps.append(step)
        texts += others
        texts += ["0"] * (len(_TEXTS) - 1 - len(others))
    numbers = usual_numbers(texts)
    if numbers is None or not all(step and _STEP.fullmatch(step) for step in steps):
        return None
    rows = zip(*[iter(numbers)] * (len(_TEXTS) - 1), strict=True)
    return [
        State._make((int(step or ""), x, y, (), Bounds(heading, heading), speed, acceleration, 0.0))
        for step, (x, y, heading, speed, acceleration) in zip(steps, rows, strict=True)
    ]


def _pick(parts: Sequence[Element]) -> _Pick | None:
    """What picks the elements with texts from states of this structure; None if there is more."""
    state, places = parts[0], {id(part): place for place, part in enumerate(parts)}
    picked = []
    for names in _TEXTS:
        found = _only(state, *names)
        if found is not None:
            picked.append(places[id(found)])
        elif names[0] != "acceleration" or state.find(names[0]) is not None:
            return None
    return itemgetter(*picked)


def _only(element: Element, *names: str) -> Element | None:
    """The element behind some names if it, and each before, is the only one of its name."""
    here: Element | None = element
    for name in names:
        found = [] if here is None else here.findall(name)
        here = found[0] if len(found) == 1 else None
    return here


def read_step(tree: Tree) -> int:
    """The time step that an element says exactly."""
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

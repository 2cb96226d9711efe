"""Traces and graphs of traces as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from rulec.diagnostics import SourceLocation
from rulec.value_display import short_repr

Value = bool | float | str

State = Mapping[str, "Value | Mapping[str, Value]"]
"""Vocabulary name -> its value, or for a per-object name object -> value."""


@dataclass(frozen=True, slots=True)
class Trace:
    """A finite sequence of states, ``step_s`` seconds apart.

    ``objects`` maps each object's id to its type. ``present`` gives, for an object that is not
    there all the time, the first and the last state (both from 0, inclusive) in which it is.
    ``place`` is where it was read, for messages.
    """

    __repr__ = short_repr

    id: str
    step_s: float
    objects: Mapping[str, str]
    states: tuple[State, ...]
    present: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    place: SourceLocation | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TraceGraph:
    """A layered directed graph whose paths from ``start`` to ``goals`` are traces.

    ``states[p][i]`` is the state of node ``i`` of layer ``p``; ``successors[p][i]`` are the indices
    in layer ``p + 1`` of its followers, ascending, ``weights[p][i]`` the whole-number costs of
    these edges, in the unit ``cost_unit`` (1/s), and ``margins[p][i]`` their time margins in layers
    (None for staying). ``objects`` and ``present`` are as in a trace, counted in layers.
    """

    __repr__ = short_repr

    step_s: float
    objects: Mapping[str, str]
    present: Mapping[str, tuple[int, int]]
    states: tuple[tuple[State, ...], ...]
    successors: tuple[tuple[tuple[int, ...], ...], ...]
    weights: tuple[tuple[tuple[int, ...], ...], ...]
    margins: tuple[tuple[tuple[int | None, ...], ...], ...]
    cost_unit: Fraction
    start: int
    goals: tuple[int, ...]

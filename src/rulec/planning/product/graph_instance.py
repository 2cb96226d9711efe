"""Bound rule with its reads in every node of a graph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.bindings import Binding
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True)
class SetMachine:
    """A deterministic machine whose states are sets of another one's.

    ``successors`` and ``outputs`` are as a ``MealyMonitor``'s.
    """

    __repr__ = short_repr

    successors: Sequence[Sequence[int]]
    outputs: Sequence[Sequence[bool]]
    rejecting_sink: int | None = None


@dataclass(frozen=True, slots=True)
class Readings:
    """A rule's machines where some letters are not known.

    What ``surely`` accepts is kept by every completion, what ``perhaps`` rejects is violated by
    every one. Unless they are ``exact`` more has been taken to be possible.
    """

    surely: SetMachine
    perhaps: SetMachine
    exact: bool


Machine: TypeAlias = MealyMonitor | SetMachine


@dataclass(frozen=True, slots=True)
class GraphInstance:
    """A rule with objects bound, and the letter class of every node.

    ``letters[p]`` are those of layer ``first + p``'s nodes. ``start`` is the state in which the
    machine waits for them. ``bindings`` are all those of the rule for which all this is the same.
    Where some letters are not known they, and the start, are those of the ``readings``.
    """

    rule: CompiledRule
    bindings: tuple[Binding, ...]
    letters: tuple[tuple[int, ...], ...]
    start: int = 0
    readings: Readings | None = None

    @property
    def first(self) -> int:
        """The first layer in which all objects are there."""
        return self.bindings[0].first

    @property
    def last(self) -> int:
        """The last layer in which all objects are there."""
        return self.bindings[0].last

    def machine(self, *, perhaps: bool = False) -> Machine:
        """The machine that judges it: whether it is kept for sure, or perhaps."""
        if self.readings is None:
            return self.rule.machine
        return self.readings.perhaps if perhaps else self.readings.surely

"""A bound rule with its letters in every node of a graph."""

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
    """A deterministic machine whose states are sets of another machine's states.

    ``successors`` and ``outputs`` are as in a ``MealyMonitor``.
    """

    __repr__ = short_repr

    successors: Sequence[Sequence[int]]
    outputs: Sequence[Sequence[bool]]
    rejecting_sink: int | None = None


@dataclass(frozen=True, slots=True)
class Readings:
    """A rule's machines where some letters are unknown.

    Every completion keeps the rule where ``surely`` accepts, and violates it where ``perhaps``
    rejects. If not ``exact``, more was assumed possible than is.
    """

    surely: SetMachine
    perhaps: SetMachine
    exact: bool


Machine: TypeAlias = MealyMonitor | SetMachine


@dataclass(frozen=True, slots=True)
class GraphInstance:
    """A rule bound to objects, and the letter class of every node.

    ``letters[p]`` are those of the nodes of layer ``first + p``. ``start`` is the machine's state
    before them. ``bindings`` are all bindings of the rule with the same letters and start. If some
    letters are unknown, letters and start are those of the ``readings``.
    """

    rule: CompiledRule
    bindings: tuple[Binding, ...]
    letters: tuple[tuple[int, ...], ...]
    start: int = 0
    readings: Readings | None = None

    @property
    def first(self) -> int:
        """The first layer in which all objects are present."""
        return self.bindings[0].first

    @property
    def last(self) -> int:
        """The last layer in which all objects are present."""
        return self.bindings[0].last

    def machine(self, *, perhaps: bool = False) -> Machine:
        """The machine that accepts what surely keeps the rule; with ``perhaps``, what may."""
        if self.readings is None:
            return self.rule.machine
        return self.readings.perhaps if perhaps else self.readings.surely

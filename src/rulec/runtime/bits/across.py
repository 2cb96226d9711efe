"""Many traces: a plane is a matrix of words, a row for each step, a bit for each trace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.logic.formula import Formula, Proposition
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.runtime.bits.algebra import evaluated
from rulec.trace.columns import Array, Layout

Words = NDArray[np.uint64]


class Across:
    """Traces, a bit for each, on which formulas are evaluated.

    Args:
        layout: where the traces' states stand in a column.
        column: gives for an atom or a comparison its column: Booleans, or whole numbers, false
            where 0.
        semantics: how the traces end.
    """

    def __init__(
        self,
        layout: Layout,
        column: Callable[[Proposition], Array],
        semantics: Semantics = "stutter",
    ) -> None:
        self._layout = layout
        self._column = column
        self._semantics = semantics
        self._packed: dict[Proposition, Words] = {}
        self._rectangular = layout.n_states == layout.n_traces * layout.n_steps
        alive = None if self._rectangular else self._pack(np.ones(layout.n_states, dtype=bool))
        self._alive = alive

    def holds(self, formula: Formula) -> NDArray[np.bool_]:
        """For each trace: does the formula, whose bounds are in steps, hold for it?"""
        ends = self._semantics == "finite"
        more = 0 if ends else steps_to_settle(formula)
        algebra = _AcrossTraces(
            self._layout.n_steps + more, self._n_words, ends, self._alive if ends else None
        )
        plane = evaluated(formula, lambda one: self._plane(one, more), algebra)
        bits = np.unpackbits(plane[0].view(np.uint8), count=self._layout.n_traces)
        return bits.view(np.bool_)

    @property
    def _n_words(self) -> int:
        return (self._layout.n_traces + 63) // 64

    def _plane(self, proposition: Proposition, more: int) -> Words:
        if proposition not in self._packed:
            packed = self._pack(self._column(proposition))
            if self._alive is not None and self._semantics != "finite":
                self._repeat_the_last(packed, self._alive)
            self._packed[proposition] = packed
        plane = self._packed[proposition]
        return np.concatenate([plane, np.repeat(plane[-1:], more, axis=0)]) if more else plane

    def _pack(self, column: Array) -> Words:
        """The bits of a column; those of traces that are over are 0."""
        starts, n_steps = self._layout.starts, self._layout.n_steps
        bits = np.zeros((n_steps, 8 * self._n_words), dtype=np.uint8)
        for step in range(n_steps):
            packed = np.packbits(column[starts[step] : starts[step + 1]])
            bits[step, : len(packed)] = packed
        return bits.view(np.uint64)

    def _repeat_the_last(self, packed: Words, alive: Words) -> None:
        for step in range(1, len(packed)):
            packed[step] |= packed[step - 1] & ~alive[step]


@dataclass(frozen=True, slots=True, eq=False)
class _AcrossTraces:
    """``alive`` has a 1 where a trace has a step; None if all have all, or go on for ever."""

    n_steps: int
    n_words: int
    ends: bool
    alive: Words | None

    def constant(self, value: bool) -> Words:
        return np.full((self.n_steps, self.n_words), -value, dtype=np.int64).view(np.uint64)

    def no(self, one: Words) -> Words:
        return ~one

    def both(self, one: Words, other: Words) -> Words:
        return one & other

    def either(self, one: Words, other: Words) -> Words:
        return one | other

    def differ(self, one: Words, other: Words) -> Words:
        return one ^ other

    def ahead(self, one: Words, steps: int) -> Words:
        steps = min(steps, self.n_steps)
        moved = np.empty_like(one)
        moved[: self.n_steps - steps] = self._existing(one)[steps:]
        moved[self.n_steps - steps :] = 0 if self.ends else one[-1]
        return moved

    def back(self, one: Words, steps: int) -> Words:
        steps = min(steps, self.n_steps)
        moved = np.empty_like(one)
        moved[steps:] = one[: self.n_steps - steps]
        moved[:steps] = 0
        return moved

    def until(self, left: Words, right: Words) -> Words:
        found: Words = self._existing(right).copy()
        for step in range(self.n_steps - 2, -1, -1):
            found[step] |= left[step] & found[step + 1]
        return found

    def since(self, left: Words, right: Words) -> Words:
        found: Words = right.copy()
        for step in range(1, self.n_steps):
            found[step] |= left[step] & found[step - 1]
        return found

    def _existing(self, one: Words) -> Words:
        return one if self.alive is None else one & self.alive


def across(
    formula: Formula,
    layout: Layout,
    column: Callable[[Proposition], NDArray[Any]],
    semantics: Semantics = "stutter",
) -> NDArray[np.bool_]:
    """For each trace of the layout: does the formula hold for it? See ``Across``."""
    return Across(layout, column, semantics).holds(formula)

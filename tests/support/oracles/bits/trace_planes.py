"""Many traces: a plane is a matrix of bytes, a row for each step, a bit for each trace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.logic.formula import Formula, Proposition
from rulec.logic.semantics import Semantics
from rulec.trace.trace_columns import Array, Layout
from support.oracles.bits.plane_program import program_of

Bits = NDArray[np.uint8]


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
        self._ends = semantics == "finite"
        self._packed: dict[Proposition, Bits] = {}
        self._alive: Bits | None = None
        if layout.n_states < layout.n_traces * layout.n_steps:
            self._alive = self._pack(np.ones(layout.n_states, dtype=bool), layout.n_steps)

    def holds(self, formula: Formula) -> NDArray[np.bool_]:
        """For each trace: does the formula, whose bounds are in steps, hold for it?"""
        program = program_of(formula)
        more = 0 if self._ends else program.settling
        row = program.run(_AcrossTraces(self, self._alive, self._layout.n_steps + more, self._ends))
        return np.unpackbits(row, count=self._layout.n_traces).view(np.bool_)

    def first_row(self, proposition: Proposition) -> Bits:
        """An atom or a comparison at the first step."""
        packed = self._packed.get(proposition)
        row: Bits = (self._pack(self._column(proposition), 1) if packed is None else packed)[0]
        return row

    def plane(self, proposition: Proposition) -> Bits:
        """An atom or a comparison at each step of the longest trace."""
        if proposition not in self._packed:
            packed = self._pack(self._column(proposition), self._layout.n_steps)
            if self._alive is not None and not self._ends:
                _repeat_the_last(packed, self._alive)
            self._packed[proposition] = packed
        return self._packed[proposition]

    @property
    def n_bytes(self) -> int:
        """How long a row is."""
        return (self._layout.n_traces + 7) // 8

    def _pack(self, column: Array, n_steps: int) -> Bits:
        """The bits of a column's first steps; those of traces that are over are 0."""
        n_traces, starts = self._layout.n_traces, self._layout.starts
        bits: Bits
        if starts[n_steps] == n_steps * n_traces:
            bits = np.packbits(column[: n_steps * n_traces].reshape(n_steps, n_traces), axis=1)
            return bits
        bits = np.zeros((n_steps, self.n_bytes), dtype=np.uint8)
        for step in range(n_steps):
            packed = np.packbits(column[starts[step] : starts[step + 1]])
            bits[step, : len(packed)] = packed
        return bits


def _repeat_the_last(packed: Bits, alive: Bits) -> None:
    for step in range(1, len(packed)):
        packed[step] |= packed[step - 1] & ~alive[step]


@dataclass(frozen=True, slots=True, eq=False)
class _AcrossTraces:
    """``alive`` has a 1 where a trace has a step; None if all have all.

    Traces that do not end go on for ever in all ``n_steps``.
    """

    traces: Across
    alive: Bits | None
    n_steps: int
    ends: bool

    def given(self, proposition: Proposition) -> Bits:
        plane = self.traces.plane(proposition)
        more = self.n_steps - len(plane)
        return np.concatenate([plane, np.repeat(plane[-1:], more, axis=0)]) if more else plane

    def constant(self, value: bool) -> Bits:
        return np.full((self.n_steps, self.traces.n_bytes), 255 if value else 0, dtype=np.uint8)

    def no(self, one: Bits) -> Bits:
        return ~one

    def both(self, one: Bits, other: Bits) -> Bits:
        return one & other

    def either(self, one: Bits, other: Bits) -> Bits:
        return one | other

    def differ(self, one: Bits, other: Bits) -> Bits:
        return one ^ other

    def ahead(self, one: Bits, steps: int) -> Bits:
        steps = min(steps, self.n_steps)
        moved = np.empty_like(one)
        moved[: self.n_steps - steps] = self._existing(one)[steps:]
        moved[self.n_steps - steps :] = 0 if self.ends else one[-1]
        return moved

    def back(self, one: Bits, steps: int) -> Bits:
        steps = min(steps, self.n_steps)
        moved = np.empty_like(one)
        moved[steps:] = one[: self.n_steps - steps]
        moved[:steps] = 0
        return moved

    def until(self, left: Bits | None, right: Bits) -> Bits:
        way = None if left is None else left[::-1]
        return _carried(self._existing(right)[::-1], way)[::-1]

    def since(self, left: Bits | None, right: Bits) -> Bits:
        return _carried(right, left)

    def given_first(self, proposition: Proposition) -> Bits:
        return self.traces.first_row(proposition)

    def first(self, one: Bits) -> Bits:
        row: Bits = one[0]
        return row

    def ever(self, one: Bits) -> Bits:
        found: Bits = np.bitwise_or.reduce(self._existing(one), axis=0)
        return found

    def opposite(self, row: Bits) -> Bits:
        return ~row

    def _existing(self, one: Bits) -> Bits:
        return one & self.alive if self.ends and self.alive is not None else one


def _carried(entered: Bits, way: Bits | None) -> Bits:
    """What has been entered, carried from each row to the next, where that has a way for it."""
    # A third argument is where the result goes; said by its name it would cost as much as a row.
    either, both = np.bitwise_or, np.bitwise_and
    found = np.empty_like(entered)
    before: Bits = entered[0]
    found[0] = before
    if way is None:
        for row, entry in zip(found[1:], entered[1:], strict=True):
            either(entry, before, row)
            before = row
        return found
    for row, entry, open_way in zip(found[1:], entered[1:], way[1:], strict=True):
        both(open_way, before, row)
        either(entry, row, row)
        before = row
    return found


def across(
    formula: Formula,
    layout: Layout,
    column: Callable[[Proposition], NDArray[Any]],
    semantics: Semantics = "stutter",
) -> NDArray[np.bool_]:
    """For each trace of the layout: does the formula hold for it? See ``Across``."""
    return Across(layout, column, semantics).holds(formula)

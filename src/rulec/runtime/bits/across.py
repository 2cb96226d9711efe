"""Many traces: a plane is a matrix of words, a row for each step, a bit for each trace."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Formula,
    Proposition,
    Unary,
    UnaryOperator,
)
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.runtime.bits.algebra import Evaluation
from rulec.trace.columns import Array, Layout

Words = NDArray[np.uint64]

_AT_ONCE: Mapping[BinaryOperator, Callable[[Words, Words], Words]] = {
    BinaryOperator.AND: lambda one, other: one & other,
    BinaryOperator.OR: lambda one, other: one | other,
    BinaryOperator.IMPLIES: lambda one, other: ~one | other,
    BinaryOperator.IFF: lambda one, other: ~(one ^ other),
    BinaryOperator.XOR: lambda one, other: one ^ other,
}


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
        self._alive: Words | None = None
        if layout.n_states < layout.n_traces * layout.n_steps:
            self._alive = self._pack(np.ones(layout.n_states, dtype=bool), layout.n_steps)

    def holds(self, formula: Formula) -> NDArray[np.bool_]:
        """For each trace: does the formula, whose bounds are in steps, hold for it?"""
        ends = self._semantics == "finite"
        more = 0 if ends else steps_to_settle(formula)
        algebra = _AcrossTraces(
            self._layout.n_steps + more, self._n_words, ends, self._alive if ends else None
        )
        evaluation = Evaluation(lambda one: self._plane(one, more), algebra)
        bits = np.unpackbits(self._first(formula, evaluation).view(np.uint8))
        return bits[: self._layout.n_traces].view(np.bool_)

    def _first(self, formula: Formula, evaluation: Evaluation[Words]) -> Words:
        """The first row of a formula's plane, and no more of it than that takes."""
        match formula:
            case Atom() | Comparison() if formula not in self._packed:
                packed: Words = self._pack(self._column(formula), 1)[0]
                return packed
            case Unary(UnaryOperator.NOT, operand):
                return ~self._first(operand, evaluation)
            case Unary(UnaryOperator.ALWAYS, operand, None):
                return ~self._ever(evaluation.negation(operand))
            case Unary(UnaryOperator.NEVER, operand, None):
                return ~self._ever(evaluation.plane(operand))
            case Unary(UnaryOperator.EVENTUALLY, operand, None):
                return self._ever(evaluation.plane(operand))
            case Binary(operator, left, right) if operator in _AT_ONCE:
                one, other = self._first(left, evaluation), self._first(right, evaluation)
                both: Words = _AT_ONCE[operator](one, other)
                return both
        row: Words = evaluation.plane(formula)[0]
        return row

    def _ever(self, plane: Words) -> Words:
        if self._alive is not None and self._semantics == "finite":
            plane = plane & self._alive
        found: Words = np.bitwise_or.reduce(plane, axis=0)
        return found

    @property
    def _n_words(self) -> int:
        return (self._layout.n_traces + 63) // 64

    def _plane(self, proposition: Proposition, more: int) -> Words:
        if proposition not in self._packed:
            packed = self._pack(self._column(proposition), self._layout.n_steps)
            if self._alive is not None and self._semantics != "finite":
                self._repeat_the_last(packed, self._alive)
            self._packed[proposition] = packed
        plane = self._packed[proposition]
        return np.concatenate([plane, np.repeat(plane[-1:], more, axis=0)]) if more else plane

    def _pack(self, column: Array, n_steps: int) -> Words:
        """The bits of a column's first steps; those of traces that are over are 0."""
        n_traces, starts = self._layout.n_traces, self._layout.starts
        bits = np.zeros((n_steps, 8 * self._n_words), dtype=np.uint8)
        if starts[n_steps] == n_steps * n_traces:
            rows = column[: n_steps * n_traces].reshape(n_steps, n_traces)
            bits[:, : (n_traces + 7) // 8] = np.packbits(rows, axis=1)
        else:
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

    def until(self, left: Words | None, right: Words) -> Words:
        found: Words = self._existing(right).copy()
        _carried(found[::-1], None if left is None else left[::-1])
        return found

    def since(self, left: Words | None, right: Words) -> Words:
        found: Words = right.copy()
        _carried(found, left)
        return found

    def _existing(self, one: Words) -> Words:
        return one if self.alive is None else one & self.alive


def _carried(found: Words, way: Words | None) -> None:
    """Carry what is found from each row to the next, where that has a way for it."""
    rows = list(found)
    if way is None:
        for before, row in pairwise(rows):
            np.bitwise_or(row, before, out=row)
        return
    passed = np.empty_like(rows[0])
    for before, row, open_way in zip(rows, rows[1:], list(way)[1:], strict=False):
        np.bitwise_and(open_way, before, out=passed)
        np.bitwise_or(row, passed, out=row)


def across(
    formula: Formula,
    layout: Layout,
    column: Callable[[Proposition], NDArray[Any]],
    semantics: Semantics = "stutter",
) -> NDArray[np.bool_]:
    """For each trace of the layout: does the formula hold for it? See ``Across``."""
    return Across(layout, column, semantics).holds(formula)

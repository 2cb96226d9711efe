"""The evaluation of a formula on rows: choices of objects times states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Indices
from rulec.automata.thresholds import ThresholdScale
from rulec.logic import formula as ltl
from rulec.logic.bounds import BOOLEAN
from rulec.monitoring.batch.columns.column_numbers import (
    ComparisonSides,
    comparison_sides,
    digits_of,
)
from rulec.monitoring.moments.name_tables import NameTables, ValueRows
from rulec.monitoring.moments.temporal_operators import (
    RowStretches,
    temporal_binary,
    temporal_unary,
)
from rulec.trace.partial_truth import Truth
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Enumeration


@dataclass(frozen=True, slots=True, eq=False)
class RowEvaluation:
    """The evaluation of formulas on some rows.

    ``spans`` (objects x 2) are the first and last state in which each object is present; ``states``
    are the traces' states in the columns, by row or the same for all rows. ``comparisons`` caches
    the evaluated ones by identity, since hashing one takes longer than evaluating it. ``trace`` is
    the trace of each row, None if there is only one.
    """

    tables: NameTables
    spans: Indices
    stretches: RowStretches
    states: Indices
    comparisons: dict[int, ComparisonSides]
    trace: Indices | None = None

    @property
    def n_states(self) -> int:
        """The number of columns."""
        return int(self.states.shape[-1])

    @property
    def _shows_all(self) -> bool:
        """Whether the columns are exactly the states of the traces."""
        n_states = self.tables.n_states
        if self.states.ndim > 1 or self.n_states != n_states:
            return False
        return int(self.states[-1]) == n_states - 1

    def of(self, formula: ltl.Formula, bound: Mapping[str, Indices]) -> Truth:
        """The truth of a formula.

        ``bound`` has the objects of its variables, per row or for all rows.
        """
        match formula:
            case ltl.Atom():
                return self._atom(formula, bound)
            case ltl.Comparison():
                return self._comparison(formula, bound)
            case ltl.Same(left, right):
                return Truth.known((bound[left] == bound[right])[:, None])
            case ltl.Constant(value):
                return Truth.known(np.full((1, self.n_states), value))
            case ltl.Unary(operator, operand):
                inner = self.of(operand, bound)
                if operator in BOOLEAN:
                    return ~inner
                return temporal_unary(formula, self._spread(inner), self.stretches, self.n_states)
            case ltl.Binary():
                return self._binary(formula, bound)

    def _binary(self, formula: ltl.Binary, bound: Mapping[str, Indices]) -> Truth:
        first = self.of(formula.left, bound)
        match formula.operator:
            case ltl.BinaryOperator.AND:
                return first & self.of(formula.right, bound) if first.possible.any() else first
            case ltl.BinaryOperator.OR:
                return first if first.sure.all() else first | self.of(formula.right, bound)
            case ltl.BinaryOperator.IMPLIES:
                return ~first | self.of(formula.right, bound) if first.possible.any() else ~first
            case ltl.BinaryOperator.IFF:
                return first.same_as(self.of(formula.right, bound))
            case ltl.BinaryOperator.XOR:
                return ~first.same_as(self.of(formula.right, bound))
            case _:
                left, right = self._spread(first), self._spread(self.of(formula.right, bound))
                return temporal_binary(formula, left, right, self.stretches)

    def _spread(self, truth: Truth) -> Truth:
        """The truth with a column for each state."""
        if truth.sure.shape[1] == self.n_states:
            return truth
        return truth.spread((len(truth.sure), self.n_states))

    def _atom(self, atom: ltl.Atom, bound: Mapping[str, Indices]) -> Truth:
        rows = self._rows(atom.name, atom.arguments, bound)
        values = rows.values
        declaration = self.tables.vocabulary.declarations[atom.name]
        if isinstance(declaration, Enumeration):
            assert atom.value is not None, "the formula has been checked"
            values = values == declaration.values.index(atom.value)
        return Truth.known(values).unknown_at(rows.unknown)

    def _rows(
        self, name: str, arguments: tuple[str, ...], bound: Mapping[str, Indices]
    ) -> ValueRows:
        """The values of a name for the objects of variables."""
        tables = self.tables
        states = None if self._shows_all else self.states
        if not arguments:
            return tables.world(name).at(rows=self.trace, states=states)
        if len(arguments) == 1:
            return tables.about(name).at(rows=bound[arguments[0]], states=states)
        several = np.broadcast_arrays(*[bound[argument] for argument in arguments])
        return tables.about_several(name, np.stack(several, axis=1)).at(states=states)

    def _comparison(self, comparison: ltl.Comparison, bound: Mapping[str, Indices]) -> Truth:
        ready = self.comparisons.get(id(comparison))
        if ready is None:
            ready = comparison_sides(comparison.terms, comparison.relation, comparison.limit)
            self.comparisons[id(comparison)] = ready
        parts = [(factor, self._term(term, bound)) for factor, term in comparison.terms]
        unknown = parts[0][1].unknown
        for _, part in parts[1:]:
            unknown = unknown | part.unknown
        lows = [(f, part.values if f > 0 else part.upper) for f, part in parts]
        highs = [(f, part.upper if f > 0 else part.values) for f, part in parts]
        low = _digits(ready.scale, lows, unknown)
        same = all(lower is upper for (_, lower), (_, upper) in zip(lows, highs, strict=True))
        high = low if same else _digits(ready.scale, highs, unknown)
        return Truth(ready.every[low, high], ready.some[low, high]).unknown_at(unknown)

    def _term(self, term: ltl.Term, bound: Mapping[str, Indices]) -> ValueRows:
        if isinstance(term, ltl.QuantityTerm):
            return self._rows(term.name, term.arguments, bound)
        sure = np.zeros((1, self.n_states), dtype=np.int64)
        possible = sure
        vocabulary = self.tables.vocabulary
        for place, kind in enumerate(self.tables.types):
            if vocabulary.is_subtype(kind, term.type):
                item = np.array([place])
                if self.trace is not None:
                    item = self.trace * len(self.tables.types) + place
                body = self.of(term.body, {**bound, term.variable: item})
                first, last = self.spans[item, 0, None], self.spans[item, 1, None]
                there = (self.states >= first) & (self.states <= last)
                sure = sure + (body.sure & there)
                possible = possible + (body.possible & there)
        return ValueRows(sure, possible, np.zeros((1, self.n_states), dtype=bool))


def _digits(
    ready: ThresholdScale, summands: list[tuple[Fraction, Array]], ignored: NDArray[np.bool_]
) -> Array:
    """For each row and state the side of the limit that a sum is on; arbitrary if it is ignored."""
    if ready.quantity is not None:
        return digits_of(ready, summands, 0)
    spread = np.broadcast_arrays(ignored, *[numbers for _, numbers in summands])
    shape = spread[0].shape
    flat = [column.ravel() for column in spread]
    parts = [(factor, values) for (factor, _), values in zip(summands, flat[1:], strict=True)]
    return digits_of(ready, parts, flat[0].size, flat[0]).reshape(shape)

"""Reader of columns: values, numbers and counts as digits of letters.

Truth values follow Kleene's strong three-valued logic, as in ``StateView`` for a single state.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import ThresholdScale, scale
from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.logic.free_names import names_in, reads_in
from rulec.logic.kleene import ObjectBinding
from rulec.monitoring.batch.columns.column_numbers import Mask, comparison_sides, digits_of
from rulec.monitoring.batch.stacked.met_values import KLEENE_COLUMNS, UNKNOWN
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Enumeration, Vocabulary


class NotGivenError(Exception):
    """A rule needs a value that has neither a column nor a default."""

    def __init__(self, name: str, objects: tuple[str, ...]) -> None:
        super().__init__(name)
        self.name = name
        self.objects = objects


class ColumnReader:
    """A caching reader of columns for the rules of a vocabulary."""

    def __init__(self, columns: TraceColumns, vocabulary: Vocabulary) -> None:
        self.columns = columns
        self._vocabulary = vocabulary
        self._known: dict[tuple[object, ...], Array] = {}

    def values(self, name: str, items: tuple[str, ...]) -> Array | bool | float | None:
        """The column of a name, or its default; None if it has neither.

        The default of an enumeration is given as its place among the declared values.
        """
        column = self.columns.values.get((name, items))
        if column is not None:
            return column
        declaration = self._vocabulary.declarations[name]
        default = declaration.default
        if isinstance(declaration, Enumeration):
            return None if default is None else declaration.values.index(default)
        assert not isinstance(default, str), "only an enumeration's default is a value's name"
        return default

    def given(self, name: str, items: tuple[str, ...]) -> Array | bool | float:
        """The column of a name, or its default. Raises NotGivenError."""
        values = self.values(name, items)
        if values is None:
            raise NotGivenError(name, items)
        return values

    def digits(self, read: NumberRead, bound: ObjectBinding) -> Array:
        """The number of thresholds passed in each state. Raises NotGivenError."""
        return self._digits(scale(read), bound)

    def _digits(self, ready: ThresholdScale, bound: ObjectBinding) -> Array:
        read, chosen = ready.read, {name: bound[name] for name in ready.variables}
        key = (read.terms, read.thresholds, *sorted(chosen.items()))
        if key not in self._known:
            summands = [(factor, self._summand(term, chosen)) for factor, term in read.terms]
            n_states = self.columns.layout.n_states
            self._known[key] = np.broadcast_to(digits_of(ready, summands), n_states)
        return self._known[key]

    def _summand(self, term: ltl.Term, bound: ObjectBinding) -> Array | float:
        """The value of a term of a sum. Raises NotGivenError."""
        if isinstance(term, ltl.Count):
            return self._counted(term, bound)
        return self.given(term.name, tuple([bound[variable] for variable in term.arguments]))

    def _counted(self, count: ltl.Count, bound: ObjectBinding) -> Array:
        """The value of a count in each state. Raises NotGivenError if it is not known."""
        total, undecided = self.count(count, bound)
        for inner, where in undecided:
            if np.any(where):
                raise self._missing(count, inner)
        return total

    def count(
        self, count: ltl.Count, bound: ObjectBinding
    ) -> tuple[Array, list[tuple[ObjectBinding, Mask]]]:
        """How many objects surely count in each state, and where it is unknown if one does."""
        total: Array = np.zeros(self.columns.layout.n_states, dtype=np.int64)
        undecided: list[tuple[ObjectBinding, Mask]] = []
        for name, kind in self.columns.objects.items():
            if self._vocabulary.is_subtype(kind, count.type):
                inner = {**bound, count.variable: name}
                truth = self._truth(count.body, inner)
                there = self._presence(name)
                total += truth.sure & there
                undecided.append((inner, there & truth.unknown))
        return total, undecided

    def _missing(self, count: ltl.Count, bound: ObjectBinding) -> NotGivenError:
        for read in reads_in(count.body):
            if not isinstance(read, ltl.Count):
                items = tuple([bound[variable] for variable in read.arguments])
                if self.values(read.name, items) is None:
                    return NotGivenError(read.name, items)
        return NotGivenError(next(names_in(count)), ())

    def _presence(self, name: str) -> Mask:
        if name not in self.columns.present:
            return np.True_
        first, last = self.columns.present[name]
        layout = self.columns.layout
        there = np.zeros(layout.n_states, dtype=bool)
        there[layout.starts[first] : layout.starts[last + 1]] = True
        return there

    def _truth(self, formula: ltl.Formula, bound: ObjectBinding) -> Truth:
        """The three-valued truth of a non-temporal formula in each state."""

        def proposition(part: ltl.Proposition) -> Truth:
            if isinstance(part, ltl.Comparison):
                return self._compared(part, bound)
            items = tuple([bound[variable] for variable in part.arguments])
            return self.atom(part.name, items, part.value)

        def identity(same: ltl.Same) -> Truth:
            return Truth.known(np.asarray(bound[same.left] == bound[same.right]))

        return fold(formula, replace(KLEENE_COLUMNS, proposition=proposition, identity=identity))

    def _compared(self, comparison: ltl.Comparison, bound: ObjectBinding) -> Truth:
        try:
            return Truth.known(np.asarray(self.compared(comparison, bound)))
        except NotGivenError:
            return UNKNOWN

    def compared(self, comparison: ltl.Comparison, bound: ObjectBinding) -> Mask:
        """The truth of a comparison in each state. Raises NotGivenError."""
        sides = comparison_sides(comparison.terms, comparison.relation, comparison.limit)
        return sides.every.diagonal().take(self._digits(sides.scale, bound))

    def atom(self, name: str, items: tuple[str, ...], expected: str | None) -> Truth:
        """The three-valued truth of an atom in each state."""
        values = self.values(name, items)
        if values is None:
            return UNKNOWN
        declaration = self._vocabulary.declarations[name]
        if isinstance(declaration, Enumeration):
            assert expected is not None, "the rulebook has been checked"
            return Truth.known(np.asarray(values == declaration.values.index(expected)))
        return Truth.known(np.asarray(values, dtype=bool))

"""The truth of propositions on rows: choices of objects times states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from rulec.array_types import Indices
from rulec.logic import formula as ltl
from rulec.logic.fold import fold
from rulec.monitoring.batch.columns.column_numbers import (
    ComparisonSides,
    comparison_sides,
    truth_between,
)
from rulec.monitoring.moments.name_tables import NameTables, at_places
from rulec.trace.partly_known.partly_known_values import (
    EnumeratedChoice,
    NameValues,
    Number,
    Truth,
)
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.vocabulary import Enumeration


@dataclass(frozen=True, slots=True, eq=False)
class RowEvaluation:
    """The evaluation of formulas on some rows.

    ``bound`` has the objects of variables, per row or for all rows; ``states`` are the traces'
    states in the columns, by row or the same for all rows. ``comparisons`` caches the evaluated
    ones by identity, since hashing one takes longer than evaluating it. ``trace`` is the trace of
    each row, None if there is only one.
    """

    tables: NameTables
    stretches: RowStretches
    states: Indices
    bound: Mapping[str, Indices]
    comparisons: dict[int, ComparisonSides]
    trace: Indices | None = None

    def of(self, formula: ltl.Formula) -> Truth:
        """The truth of a formula."""
        return fold(formula, self.stretches.algebra(self._proposition, self._identity))

    def _identity(self, same: ltl.Same) -> Truth:
        return Truth.known((self.bound[same.left] == self.bound[same.right])[:, None])

    def _proposition(self, proposition: ltl.Proposition) -> Truth:
        if isinstance(proposition, ltl.Comparison):
            return self._comparison(proposition)
        values = self._values(proposition.name, proposition.arguments)
        if isinstance(values, EnumeratedChoice):
            declaration = self.tables.vocabulary.declarations[proposition.name]
            assert isinstance(declaration, Enumeration), "its values are choices"
            assert proposition.value is not None, "the formula has been checked"
            return values.equals(declaration.values.index(proposition.value))
        assert isinstance(values, Truth), "the formula has been checked"
        return values

    @property
    def _shows_all(self) -> bool:
        """Whether the columns are exactly the states of the traces."""
        n_states = self.tables.n_states
        if self.states.ndim > 1 or self.states.size != n_states:
            return False
        return int(self.states[-1]) == n_states - 1

    def _values(self, name: str, arguments: tuple[str, ...]) -> NameValues:
        """The values of a name for the objects of variables."""
        tables = self.tables
        states = None if self._shows_all else self.states
        if not arguments:
            return at_places(tables.world(name), self.trace, states)
        if len(arguments) == 1:
            return at_places(tables.about(name), self.bound[arguments[0]], states)
        several = np.broadcast_arrays(*[self.bound[argument] for argument in arguments])
        return at_places(tables.about_several(name, np.stack(several, axis=1)), None, states)

    def _comparison(self, comparison: ltl.Comparison) -> Truth:
        ready = self.comparisons.get(id(comparison))
        if ready is None:
            ready = comparison_sides(comparison.terms, comparison.relation, comparison.limit)
            self.comparisons[id(comparison)] = ready
        parts = [(factor, self._term(term)) for factor, term in comparison.terms]
        return truth_between(ready, parts)

    def _term(self, term: ltl.Term) -> Number:
        if isinstance(term, ltl.QuantityTerm):
            number = self._values(term.name, term.arguments)
            assert isinstance(number, Number), "the formula has been checked"
            return number
        nobody = np.zeros((1, self.states.shape[-1]), dtype=np.int64)
        count = Number(nobody, nobody)
        vocabulary, spans = self.tables.vocabulary, self.tables.spans
        for place, kind in enumerate(self.tables.types):
            if vocabulary.is_subtype(kind, term.type):
                item = np.array([place])
                if self.trace is not None:
                    item = self.trace * len(self.tables.types) + place
                first, last = spans[item, 0, None], spans[item, 1, None]
                there = Truth.known((self.states >= first) & (self.states <= last))
                inner = replace(self, bound={**self.bound, term.variable: item})
                counts = inner.of(term.body) & there
                count += Number(counts.sure, counts.possible)
        return count

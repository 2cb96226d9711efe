"""Columns of words that no trace of a stack tells, by their meanings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.logic import formula as ltl
from rulec.logic.free_names import rename_variables
from rulec.logic.kleene import alias_of
from rulec.monitoring.batch.columns.column_formulas import ColumnFormulas
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.trace_places import TracePlaces
from rulec.trace.partly_known.partly_known_values import NameValues, Number, Truth
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.trace.partly_known.temporal_operators import Beyond
from rulec.trace.trace_columns import Array

Named: TypeAlias = Callable[[str], NameValues]
"""A name's values by state, or by cell if it is about an object."""


def meant(
    variables: tuple[str, ...],
    formula: ltl.Formula,
    places: TracePlaces,
    named: Named,
    beyond: Beyond,
) -> Truth:
    """The truth of a word in all states, or in all cells if it is about an object.

    It means a formula with bounds in steps. Raises UnencodableError if it is about several objects.
    """
    if len(variables) > 1:
        raise UnencodableError
    return _about(variables[0] if variables else None, places, named, beyond).everywhere(formula)


def _about(variable: str | None, places: TracePlaces, named: Named, beyond: Beyond) -> _Places:
    bounds = places.begins if variable is None else places.starts
    lengths = bounds[1:] - bounds[:-1]
    first, last = (ends.repeat(lengths) for ends in (bounds[:-1], bounds[1:] - 1))
    stretches = RowStretches(first, last, int(bounds[-1]), beyond)
    return _Places(places.vocabulary, stretches, places, named, variable)


@dataclass(frozen=True, eq=False)
class _Places(ColumnFormulas):
    """All states, or all cells, of whose object a ``variable`` speaks."""

    places: TracePlaces
    named: Named
    variable: str | None

    def everywhere(self, formula: ltl.Formula) -> Truth:
        """The truth of a formula, with an entry for each place."""
        n_places = self.stretches.n_states
        return self.of(formula).each(
            lambda half: np.broadcast_to(half.reshape(half.shape[-1:]), n_places)
        )

    def identity(self, same: ltl.Same) -> Truth:
        """There is only one variable."""
        if same.left != same.right:
            raise UnencodableError
        return Truth.known(np.ones(1, dtype=bool))

    def values(self, name: str, arguments: tuple[str, ...]) -> NameValues:
        """The values of a name, about the object of a cell or about nobody."""
        if any(argument != self.variable for argument in arguments) or len(arguments) > 1:
            raise UnencodableError
        values = self.named(name)
        return values if arguments else values.each(self._by_place)

    def _by_place(self, by_state: Array) -> Array:
        return by_state if self.variable is None else by_state[self.places.state_of]

    def counted(self, count: ltl.Count) -> Number:
        """How many objects count, or whether the object of a cell does."""
        places, cells = self.places, self.places.cells_of_type(count.type)
        alias = alias_of(count.variable, count.body)
        if alias is not None and alias == self.variable:
            counted = self.everywhere(rename_variables(count.body, {count.variable: alias}))
            there = np.zeros(int(places.starts[-1]), dtype=bool)
            there[cells] = True
            return Number(counted.sure & there, counted.possible & there).each(_as_numbers)
        inner = _about(count.variable, places, self.named, self.stretches.ends)
        truth, states = inner.everywhere(count.body), places.state_of[cells]
        low, high = (
            self._by_place(np.bincount(states[half[cells]], minlength=places.n_states))
            for half in (truth.sure, truth.possible)
        )
        return Number(low, high)


def _as_numbers(flags: Flags) -> Indices:
    return flags.astype(np.intp)

"""Columns of words that no trace of a stack tells, by their meanings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.fold import fold
from rulec.logic.free_names import number_of, rename_variables, terms_of
from rulec.logic.kleene import alias_of
from rulec.monitoring.batch.columns.calculated_columns import calculated_truth
from rulec.monitoring.batch.columns.column_numbers import (
    comparison_sides,
    proposition_truth,
    truth_between,
)
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.trace.partly_known.partly_known_values import (
    NameValues,
    Number,
    Truth,
)
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.trace.partly_known.temporal_operators import Beyond
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import Meaning


@dataclass(frozen=True, slots=True, kw_only=True)
class MeaningReader:
    """What meanings are made of in traces end to end, whose cells are an object's states.

    ``named`` has a name's values by state, or by cell if it is about an object. ``begins`` and
    ``starts`` are where the states of a trace and the cells of an object begin; ``of_type`` are the
    cells of the objects of a type, ``state_of`` the state of each cell.
    """

    vocabulary: Vocabulary
    named: Callable[[str], NameValues]
    begins: Indices
    starts: Indices
    state_of: Indices
    of_type: Callable[[str], Indices]
    step_s: Fraction
    beyond: Beyond

    def of(self, meaning: Meaning) -> Truth:
        """The truth of a word in all states, or in all cells if it is about an object.

        Raises UnencodableError if it is about several.
        """
        if len(meaning.variables) > 1:
            raise UnencodableError
        places = _Places(self, meaning.variables[0] if meaning.variables else None)
        return places.of(in_steps(meaning.formula, self.step_s))


@dataclass(frozen=True, slots=True)
class _Places:
    """All states, or all cells, of whose object a ``variable`` speaks."""

    reader: MeaningReader
    variable: str | None

    @property
    def _bounds(self) -> Indices:
        return self.reader.begins if self.variable is None else self.reader.starts

    def of(self, formula: ltl.Formula) -> Truth:
        """The truth of a formula."""
        bounds = self._bounds
        n_places, lengths = int(bounds[-1]), bounds[1:] - bounds[:-1]
        first, last = (ends.repeat(lengths) for ends in (bounds[:-1], bounds[1:] - 1))
        stretches = RowStretches(first, last, n_places, self.reader.beyond)
        truth = fold(formula, stretches.algebra(self._proposition, self._identity))
        return truth.each(lambda half: np.broadcast_to(half.reshape(half.shape[-1:]), n_places))

    def _identity(self, same: ltl.Same) -> Truth:
        if same.left != same.right:
            raise UnencodableError
        return Truth.known(np.ones(1, dtype=bool))

    def _proposition(self, asked: ltl.Proposition) -> Truth:
        if isinstance(asked, ltl.Comparison):
            ready = comparison_sides(asked.terms, asked.relation, asked.limit)
            return truth_between(ready, [(own, self._term(term)) for own, term in asked.terms])
        if isinstance(asked, ltl.Calculated):
            terms = terms_of(number_of(asked))
            return calculated_truth(
                asked, {term: self._term(term) for term in terms}, int(self._bounds[-1])
            )
        values = self._named(asked.name, asked.arguments)
        return proposition_truth(values, asked, self.reader.vocabulary.declarations[asked.name])

    def _named(self, name: str, arguments: tuple[str, ...]) -> NameValues:
        if any(argument != self.variable for argument in arguments) or len(arguments) > 1:
            raise UnencodableError
        values = self.reader.named(name)
        return values if arguments else values.each(self._by_place)

    def _by_place(self, by_state: Array) -> Array:
        return by_state if self.variable is None else by_state[self.reader.state_of]

    def _term(self, term: ltl.Term) -> Number:
        if isinstance(term, ltl.QuantityTerm):
            number = self._named(term.name, term.arguments)
            assert isinstance(number, Number), "the formula has been checked"
            return number
        reader, cells = self.reader, self.reader.of_type(term.type)
        alias = alias_of(term.variable, term.body)
        if alias is not None and alias == self.variable:
            counted = self.of(rename_variables(term.body, {term.variable: alias}))
            there = np.zeros(int(reader.starts[-1]), dtype=bool)
            there[cells] = True
            return Number(counted.sure & there, counted.possible & there).each(_as_numbers)
        inner = replace(self, variable=term.variable).of(term.body)
        states, n_states = reader.state_of[cells], int(reader.begins[-1])
        low, high = (
            self._by_place(np.bincount(states[half[cells]], minlength=n_states))
            for half in (inner.sure, inner.possible)
        )
        return Number(low, high)


def _as_numbers(flags: Flags) -> Indices:
    return flags.astype(np.intp)

"""The truth of formulas in every state of traces, for all choices of objects together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Indices
from rulec.diagnostics import SourceLocation
from rulec.logic import formula as ltl
from rulec.logic.bounds import looks_elsewhere
from rulec.logic.formula import BinaryOperator, Formula, chain_of
from rulec.logic.free_names import variables_of
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.monitoring.batch.columns.column_formulas import ColumnFormulas
from rulec.monitoring.moments.name_tables import NameTables, at_places
from rulec.resource_limits import LOOKBACK
from rulec.rulebook.rulebook_model import Variable
from rulec.trace.partly_known.partly_known_values import (
    NameValues,
    Number,
    Truth,
)
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.trace.partly_known.temporal_operators import Beyond
from rulec.trace.trace_model import Ending
from rulec.vocabulary.vocabulary_model import choices


@dataclass(frozen=True, eq=False)
class RowFormulas(ColumnFormulas):
    """The truth of formulas on some rows.

    ``bound`` has the objects of variables, per row or for all rows; ``states`` are the traces'
    states in the columns, by row or the same for all rows. ``trace`` is the trace of each row, None
    if there is only one.
    """

    tables: NameTables
    states: Indices
    bound: Mapping[str, Indices]
    trace: Indices | None = None

    @cached_property
    def _chosen_states(self) -> Indices | None:
        """The states in the columns; None if these are exactly the states of the traces."""
        n_states = self.tables.n_states
        if self.states.ndim > 1 or self.states.size != n_states:
            return self.states
        return None if int(self.states[-1]) == n_states - 1 else self.states

    def identity(self, same: ltl.Same) -> Truth:
        """Where two variables stand for the same object."""
        return Truth.known((self.bound[same.left] == self.bound[same.right])[:, None])

    def values(self, name: str, arguments: tuple[str, ...]) -> NameValues:
        """The values of a name for the objects of variables."""
        tables, states = self.tables, self._chosen_states
        if not arguments:
            return at_places(tables.world(name), self.trace, states)
        if len(arguments) == 1:
            return at_places(tables.about(name), self.bound[arguments[0]], states)
        several = np.broadcast_arrays(*[self.bound[argument] for argument in arguments])
        return at_places(tables.about_several(name, np.stack(several, axis=1)), None, states)

    def counted(self, count: ltl.Count) -> Number:
        """How many objects count in each state."""
        nobody = np.zeros((1, self.states.shape[-1]), dtype=np.int64)
        number = Number(nobody, nobody)
        tables, spans = self.tables, self.tables.spans
        for place, kind in enumerate(tables.types):
            if self.vocabulary.is_subtype(kind, count.type):
                item = np.array([place])
                if self.trace is not None:
                    item = self.trace * len(tables.types) + place
                first, last = spans[item, 0, None], spans[item, 1, None]
                there = Truth.known((self.states >= first) & (self.states <= last))
                inner = replace(self, bound={**self.bound, count.variable: item})
                counts = inner.of(count.body) & there
                number += Number(counts.sure, counts.possible)
        return number


MOST_ENTRIES = 1 << 22
"""The most rows times states that are evaluated together, to limit memory."""


@dataclass(frozen=True, slots=True, eq=False)
class ChosenObjects:
    """Choices of objects for variables with these names, one per row, sorted by ``trace``.

    ``items`` (rows x variables) are object numbers, as in tables.
    """

    variables: tuple[str, ...]
    trace: Indices
    items: Indices

    def __len__(self) -> int:
        return len(self.trace)

    def at(self, rows: Indices) -> ChosenObjects:
        """Some of the rows."""
        return ChosenObjects(self.variables, self.trace[rows], self.items[rows])


@dataclass(frozen=True, slots=True, eq=False)
class FormulaTruth:
    """The truth of a formula in every state, with a row for each choice of objects.

    ``rows`` are their places among the choices asked about. ``truth`` (rows x states) is False
    where some of their objects are absent. For a row that continues for ever, the states up to the
    point after which nothing changes follow its ``last`` state.
    """

    choices: ChosenObjects
    rows: Indices
    last: Indices
    truth: Truth

    def in_trace(self) -> Truth:
        """The truth, only in states of the trace."""
        return self.truth & Truth.known(np.arange(self.truth.sure.shape[1]) <= self.last[:, None])


class ReadyFormula:
    """A formula with what is known of it without a trace; bounds of operators are in steps.

    Rows that continue for ever are extended by at least as many states as it ``settles`` in.
    """

    def __init__(
        self, formula: Formula, settles: int = 0, place: SourceLocation | None = None
    ) -> None:
        self.formula = formula
        self.settles = max(steps_to_settle(formula), settles)
        LOOKBACK.within(self.settles, place, "the formula")
        self.world_parts = [
            part
            for part in chain_of(BinaryOperator.AND, formula)
            if next(variables_of(part), None) is None and not looks_elsewhere(part)
        ]


class TraceTruth:
    """The truth of formulas on checked traces of one shape, which end as ``ends`` says."""

    def __init__(self, tables: NameTables, semantics: Semantics, ends: Ending) -> None:
        self.tables = tables
        self._spans = tables.spans
        self._ends: Beyond = "goes on" if semantics == "stutter" else "over"
        if ends == "cut":
            self._ends = "cut"

    def of(self, ready: ReadyFormula, wanted: ChosenObjects) -> Iterator[FormulaTruth]:
        """The truth of a formula for choices of objects that are present together.

        A large result is yielded in several parts; traces in which the formula evidently holds
        nowhere are left out.
        """
        rows = np.flatnonzero(self._may_hold(ready)[wanted.trace])
        most = max(1, MOST_ENTRIES // (self.tables.n_states + ready.settles + 1))
        for begin in range(0, len(rows), most):
            yield self._part(ready, wanted, rows[begin : begin + most])

    def choices_of(self, variables: Sequence[Variable]) -> ChosenObjects:
        """All choices of distinct objects of these types that are present together."""
        tables = self.tables
        wanted = [variable.type for variable in variables]
        numbers = {str(number): kind for number, kind in enumerate(tables.types)}
        chosen = [list(map(int, row)) for row in choices(wanted, numbers, tables.vocabulary)]
        own = np.array(chosen, dtype=np.intp).reshape(len(chosen), len(variables))
        trace = np.repeat(np.arange(tables.n_traces), len(own))
        items = np.tile(own, (tables.n_traces, 1)) + (trace * len(numbers))[:, None]
        every = ChosenObjects(tuple([variable.name for variable in variables]), trace, items)
        first, last = self.stretch_of(every)
        return every.at(np.flatnonzero(first <= last))

    def stretch_of(self, chosen: ChosenObjects) -> tuple[Indices, Indices]:
        """The first and last state in which the objects of each choice are present."""
        if not chosen.variables:
            return np.zeros(len(chosen), dtype=np.intp), self.tables.last[chosen.trace]
        spans = self._spans[chosen.items]
        return spans[:, :, 0].max(axis=1), spans[:, :, 1].min(axis=1)

    def _part(self, ready: ReadyFormula, wanted: ChosenObjects, rows: Indices) -> FormulaTruth:
        own = wanted.at(rows)
        first, last = self.stretch_of(own)
        states, end = np.arange(self.tables.n_states), last
        if self._ends == "goes on":
            # The last state is repeated until nothing changes.
            states, end = np.arange(len(states) + ready.settles), last + ready.settles
            states = np.minimum(states, last[:1] if (last == last[0]).all() else last[:, None])
        state = np.arange(states.shape[-1])
        stretches = RowStretches(first[:, None], end[:, None], len(state), self._ends)
        truth = self._evaluation(stretches, states, own).of(ready.formula)
        there = (state >= first[:, None]) & (state <= end[:, None])
        return FormulaTruth(own, rows, last, truth & Truth.known(there))

    def _may_hold(self, ready: ReadyFormula) -> NDArray[np.bool_]:
        """The traces in which the formula may hold.

        Judged by its parts that are about one state and no object.
        """
        tables = self.tables
        states, last = np.arange(tables.n_states), tables.last[:, None]
        stretches = RowStretches(np.zeros_like(last), last, len(states), self._ends)
        nobody = np.empty((tables.n_traces, 0), dtype=np.intp)
        chosen = ChosenObjects((), np.arange(tables.n_traces), nobody)
        evaluation = self._evaluation(stretches, states, chosen)
        result = np.ones(tables.n_traces, dtype=bool)
        for part in ready.world_parts:
            result &= (evaluation.of(part).possible & (states <= last)).any(axis=1)
        return result

    def _evaluation(
        self,
        stretches: RowStretches,
        states: Indices,
        chosen: ChosenObjects,
    ) -> RowFormulas:
        return RowFormulas(
            self.tables.vocabulary,
            stretches,
            self.tables,
            states,
            dict(zip(chosen.variables, chosen.items.T, strict=True)),
            trace=chosen.trace if self.tables.n_traces > 1 else None,
        )

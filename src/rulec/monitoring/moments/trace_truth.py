"""The truth of formulas at every state of a trace, for all choices of objects together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import SourceLocation
from rulec.logic.formula import Formula
from rulec.logic.free_names import variables_of
from rulec.logic.opportunities import conjuncts, looks_elsewhere
from rulec.logic.semantics import Semantics, steps_to_settle
from rulec.monitoring.moments.array_tables import ArrayTables
from rulec.monitoring.moments.name_tables import NameTables, StateTables
from rulec.monitoring.moments.row_evaluation import Places, ReadyComparison, RowEvaluation
from rulec.monitoring.moments.truth_rows import RowEnding, RowStretches
from rulec.resource_limits import LOOKBACK
from rulec.rulebook.rulebook_model import Variable
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices

MOST_ENTRIES = 1 << 22
"""Rows times states that are evaluated together; more take more memory."""


@dataclass(frozen=True, slots=True, eq=False)
class FormulaTruth:
    """The truth of a formula at every state, a row for each choice of objects.

    ``choices`` are the objects by the variables' order, ``first`` and ``last`` (one a row) the
    states in which all of them are there. ``sure`` and ``possible`` (rows x states) are False
    elsewhere. Behind the last state of a row that goes on for ever are those until nothing changes
    any more.
    """

    choices: tuple[tuple[str, ...], ...]
    first: Places
    last: Places
    sure: NDArray[np.bool_]
    possible: NDArray[np.bool_]


def tables_of(trace: Trace | TraceArrays, vocabulary: Vocabulary) -> NameTables:
    """What a checked trace says of names."""
    if isinstance(trace, Trace):
        return StateTables(trace, vocabulary)
    return ArrayTables(trace, vocabulary)


class ReadyFormula:
    """A formula with what is known of it without a trace; bounds of operators are in steps.

    Rows that go on for ever do so for at least as many states as it ``settles`` in.
    """

    def __init__(
        self, formula: Formula, settles: int = 0, place: SourceLocation | None = None
    ) -> None:
        self.formula = formula
        self.settles = max(steps_to_settle(formula), settles)
        LOOKBACK.within(self.settles, place, "the formula")
        self.world_parts = [
            part
            for part in conjuncts(formula)
            if next(variables_of(part), None) is None and not looks_elsewhere(part)
        ]
        self.comparisons: dict[int, ReadyComparison] = {}


class TraceTruth:
    """What formulas come to on one checked trace."""

    def __init__(
        self, trace: Trace | TraceArrays, vocabulary: Vocabulary, semantics: Semantics
    ) -> None:
        self._objects = trace.objects
        self._tables = tables_of(trace, vocabulary)
        self.n_states = self._tables.n_states
        self._places = {item: place for place, item in enumerate(self._tables.objects)}
        self._spans = self._tables.spans
        self._ends: RowEnding = "goes on" if semantics == "stutter" else "over"
        if trace.ends == "cut":
            self._ends = "cut"

    def of(
        self,
        ready: ReadyFormula,
        variables: Sequence[Variable] = (),
        choice: tuple[str, ...] | None = None,
    ) -> Iterator[FormulaTruth]:
        """The truth of a formula for every choice of distinct objects that are there together.

        With a ``choice`` it is that of these objects alone. There are several parts where there is
        much of it, or rows that end at different states, and none where it is seen to hold nowhere.
        """
        if self._never_holds(ready):
            return
        if choice is None:
            rows = self._choices_of(variables)
        else:
            rows = np.array([[self._places[item] for item in choice]], dtype=np.intp)
        for together in self._together(rows, ready.settles):
            yield self._part(ready, variables, together)

    def stretches_of(self, variables: Sequence[Variable]) -> tuple[Places, Places]:
        """The first and the last state in which each choice of objects is there."""
        return self._stretch(self._choices_of(variables))

    def _choices_of(self, variables: Sequence[Variable]) -> Places:
        """The choices (rows x variables) as places of objects that are there together."""
        if not variables:
            return np.empty((1, 0), dtype=np.intp)
        wanted = [variable.type for variable in variables]
        chosen = choices(wanted, self._objects, self._tables.vocabulary)
        places = [[self._places[item] for item in row] for row in chosen]
        rows = np.array(places, dtype=np.intp).reshape(-1, len(variables))
        first, last = self._stretch(rows)
        return rows[first <= last]

    def _stretch(self, rows: Places) -> tuple[Places, Places]:
        n_rows, n_variables = rows.shape
        if not n_variables:
            whole = np.array([self.n_states - 1] * n_rows, dtype=np.intp)
            return np.zeros(n_rows, dtype=np.intp), whole
        spans = self._spans[rows]
        return spans[:, :, 0].max(axis=1), spans[:, :, 1].min(axis=1)

    def _together(self, rows: Places, settles: int) -> Iterator[Places]:
        """Rows that are evaluated together."""
        most = max(1, MOST_ENTRIES // (self.n_states + settles + 1))
        if self._ends != "goes on":
            groups = [rows]
        else:
            _, last = self._stretch(rows)
            groups = [rows[last == end] for end in np.unique(last)]
        for group in groups:
            for begin in range(0, len(group), most):
                yield group[begin : begin + most]

    def _part(
        self, ready: ReadyFormula, variables: Sequence[Variable], rows: Places
    ) -> FormulaTruth:
        first, last = self._stretch(rows)
        states = np.arange(self.n_states)
        end = last
        if self._ends == "goes on":
            # All rows end together; the last state is repeated until nothing changes any more.
            count = int(last[0]) + 1 + ready.settles
            states = np.minimum(np.arange(count), int(last[0]))
            end = np.full_like(last, count - 1)
        bound = {variable.name: rows[:, place] for place, variable in enumerate(variables)}
        stretches = RowStretches(first[:, None], end[:, None], self._ends)
        truth = self._evaluation(ready, stretches, states).of(ready.formula, bound)
        state = np.arange(len(states))
        there = (state >= first[:, None]) & (state <= end[:, None])
        objects = self._tables.objects
        return FormulaTruth(
            tuple([tuple([objects[place] for place in row]) for row in rows.tolist()]),
            first,
            last,
            truth.sure & there,
            truth.possible & there,
        )

    def _never_holds(self, ready: ReadyFormula) -> bool:
        """Whether parts that are about no object and of one state tell that it holds nowhere."""
        begin = np.zeros((1, 1), dtype=np.intp)
        states = np.arange(self.n_states)
        stretches = RowStretches(begin, begin + self.n_states - 1, self._ends)
        evaluation = self._evaluation(ready, stretches, states)
        return any(not evaluation.of(part, {}).possible.any() for part in ready.world_parts)

    def _evaluation(
        self, ready: ReadyFormula, stretches: RowStretches, states: Places
    ) -> RowEvaluation:
        return RowEvaluation(self._tables, self._spans, stretches, states, ready.comparisons)

"""Rows of traces; a trace with unknown constants has a row for each choice of their values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Indices
from rulec.monitoring.batch.columns.column_numbers import alike_places
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.trace import Value
from rulec.trace.plain_arrays import distinct
from rulec.trace.trace_columns import Layout, layout_of
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, PartialValue

NOT_SUPPOSED = -1


@dataclass(frozen=True, slots=True, eq=False)
class SupposedValues:
    """The supposed value of a constant, as a place among ``values`` for each row.

    Negative for none.
    """

    values: Sequence[Value]
    of_rows: Indices


@dataclass(frozen=True, slots=True, eq=False)
class SupposedRows:
    """Rows in the order of their traces; each trace has one or more.

    ``begins`` is the first row of each trace, ``traces`` the trace of each row. For each state of
    the rows, in their own ``layout``, ``rows`` has its row and ``states`` its state among those of
    the traces. These are None if every trace has exactly one row.
    """

    layout: Layout
    begins: Indices | None = None
    traces: Indices | None = None
    rows: Indices | None = None
    states: Indices | None = None
    supposed: Mapping[Subject, SupposedValues] = field(default_factory=dict)

    def numbers(self, of_traces: Numbers) -> Numbers:
        """Numbers of the traces' states, for the states of rows."""
        if self.states is None or not isinstance(of_traces, np.ndarray) or not of_traces.ndim:
            return of_traces
        return of_traces.take(self.states)

    def flags(self, of_traces: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Flags of the traces' states, for the states of rows."""
        return of_traces if self.states is None else of_traces.take(self.states)

    def places(self, places: Indices) -> Indices:
        """The states of traces for these places in rows."""
        return places if self.states is None else self.states.take(places)

    def in_rows(self, of_traces: NDArray[Any]) -> NDArray[Any]:
        """A value of each trace, for each row."""
        return of_traces if self.traces is None else of_traces.take(self.traces)

    def in_any(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether some row of each trace has a flag."""
        return flags if self.begins is None else np.logical_or.reduceat(flags, self.begins)

    def in_all(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether all rows of each trace have a flag."""
        return flags if self.begins is None else np.logical_and.reduceat(flags, self.begins)

    def traces_at(self, places: Indices) -> Indices:
        """The traces with states at some places."""
        rows = self.layout.traces_at(places)
        traces: Indices = distinct(rows if self.traces is None else self.traces.take(rows))
        return traces

    def where_supposed(self, subject: Subject) -> tuple[Sequence[Value], Indices] | None:
        """The supposed values of a constant, and for each state the place of its value.

        The place is negative where nothing is supposed. None if nothing is supposed anywhere.
        """
        own = self.supposed.get(subject)
        if own is None or self.rows is None:
            return None
        return own.values, own.of_rows.take(self.rows)

    def with_supposed(
        self, subject: Subject, values: Sequence[PartialValue | None], places: Indices
    ) -> Sequence[PartialValue | None]:
        """A subject's values at places of rows, with supposed values instead of unknown ones."""
        where = self.where_supposed(subject)
        if where is None:
            return values
        supposed = [*where[0], None]
        pairs = zip(values, where[1].take(places).tolist(), strict=True)
        return [
            supposed[own] if own >= 0 and type(value) in UNKNOWN_TYPES else value
            for value, own in pairs
        ]


def supposed_rows(
    layout: Layout,
    unknown: Mapping[Subject, NDArray[np.bool_]],
    suppose: Callable[[Sequence[Subject]], Sequence[Mapping[Subject, Value]]],
) -> SupposedRows:
    """The rows of traces, with a row for each supposed choice of values of unknown constants."""
    patterns = alike_places(unknown.values(), layout.n_traces)
    _, examples = np.unique(patterns, return_index=True)
    subjects = [
        [subject for subject, flags in unknown.items() if flags[trace]]
        for trace in examples.tolist()
    ]
    suppositions = [suppose(own) if own else [{}] for own in subjects]
    counts = np.array(list(map(len, suppositions)), dtype=np.intp).take(patterns)
    begins = np.cumsum(counts) - counts
    traces = np.repeat(np.arange(layout.n_traces), counts)
    own_layout = layout_of(layout.lengths[traces])
    of_steps = np.diff(own_layout.starts)
    rows = np.arange(own_layout.n_states) - np.repeat(own_layout.starts[:-1], of_steps)
    states = np.repeat(layout.starts[:-1], of_steps) + traces.take(rows)
    supposed: dict[Subject, SupposedValues] = {}
    for subject in unknown:
        values: dict[Value, int] = {}
        of_rows = np.full(len(traces), NOT_SUPPOSED, dtype=np.intp)
        for pattern, own in enumerate(suppositions):
            chosen = [
                values.setdefault(row[subject], len(values)) if subject in row else NOT_SUPPOSED
                for row in own
            ]
            firsts = begins[patterns == pattern]
            of_rows[firsts[:, None] + np.arange(len(own))] = chosen
        if values:
            supposed[subject] = SupposedValues(tuple(values), of_rows)
    return SupposedRows(
        own_layout, begins=begins, traces=traces, rows=rows, states=states, supposed=supposed
    )

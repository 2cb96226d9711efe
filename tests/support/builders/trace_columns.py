"""Traces of one shape as cells and as columns, value by value."""

from itertools import product
from typing import NamedTuple

import numpy as np

from rulec.diagnostics import RulecError
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError, encode_partly_known
from rulec.monitoring.state_validation import check_state
from rulec.monitoring.state_view import value_in
from rulec.trace.trace_columns import TraceCells, TraceColumns, layout_of, smallest_unsigned
from rulec.trace.trace_model import present_in


class TraceGroup(NamedTuple):
    """Traces as cells, and their places in the order of these."""

    cells: TraceCells
    order: list[int]


def group_traces(traces):
    """Traces with the same objects; states are told apart by identity."""
    lengths = np.array([len(trace.states) for trace in traces])
    order = np.argsort(-lengths, kind="stable")
    layout = layout_of(lengths[order])
    numbers, cells = {}, np.empty(layout.n_states, dtype=np.int64)
    example = traces[order[0]]
    for rank, place in enumerate(order.tolist()):
        for step, state in enumerate(traces[place].states):
            there = present_in(step, example.objects, example.present)
            key = id(state), tuple(there)
            number, *_ = numbers.setdefault(key, (len(numbers), state, there))
            cells[layout.starts[step] + rank] = number
    made = TraceCells(
        layout=layout,
        cells=cells.astype(smallest_unsigned(len(numbers))),
        states=tuple(state for _, state, _ in numbers.values()),
        objects=example.objects,
        present=example.present,
        there=tuple(there for *_, there in numbers.values()),
        step_s=example.step_s,
    )
    return TraceGroup(made, order.tolist())


def columnize(traces, vocabulary):
    """The columns of cells. Raises UnencodableError if a value is invalid or missing."""
    there = traces.there or [traces.objects] * len(traces.states)
    try:
        for state in traces.states:
            check_state(state, traces.objects, vocabulary, "")
    except RulecError:
        raise UnencodableError from None
    values, unknown, upper = {}, {}, {}
    for name in set().union(*traces.states):
        declaration = vocabulary.declarations[name]
        fitting = [
            [item for item, own in traces.objects.items() if vocabulary.is_subtype(own, kind)]
            for kind in declaration.parameters
        ]
        for items in product(*fitting):
            said = [value_in(state, name, items, declaration) for state in traces.states]
            known = [value for value in said if value is not None]
            if any(
                x is None and own.keys() >= set(items) for x, own in zip(said, there, strict=True)
            ):
                raise UnencodableError
            if known:
                filled = [known[0] if value is None else value for value in said]
                column = encode_partly_known(filled, declaration)
                values[name, items] = column.values.take(traces.cells)
                if column.unknown is not None:
                    unknown[name, items] = column.unknown.take(traces.cells)
                if column.upper is not None:
                    upper[name, items] = column.upper.take(traces.cells)
    return TraceColumns(
        traces.layout,
        values,
        traces.objects,
        traces.present,
        traces.step_s,
        unknown=unknown,
        upper=upper,
    )

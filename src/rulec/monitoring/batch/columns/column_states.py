"""States of traces that are given as columns: some of them, or the few that all are equal to."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.batch.columns.encoded_columns import PartlyKnown
from rulec.trace import Trace
from rulec.trace.trace_columns import Array, TraceCells, TraceColumns, smallest_unsigned
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary

MOST_CODES = 1 << 16
"""With more combinations of values, equal states are not searched for."""

_SHARED = 4
"""If a state occurs this often on average, what it means is computed once and shared."""


def shared_states(columns: TraceColumns, vocabulary: Vocabulary) -> TraceCells | None:
    """The same traces as cells, if they consist of few different states.

    None if they do not, if some value is unknown, or if an object is not always present.
    """
    if columns.present or columns.unknown or columns.upper:
        return None
    n_states, n_codes = columns.layout.n_states, 1
    codes = np.zeros(n_states, dtype=smallest_unsigned(MOST_CODES))
    for (name, _), values in columns.values.items():
        n_values = _number_of_values(vocabulary.declarations[name], values)
        if n_values is None or n_codes * n_values > MOST_CODES:
            return None
        if n_values > 1:
            codes += values.astype(codes.dtype) * codes.dtype.type(n_codes)
        n_codes *= n_values
    used = np.bincount(codes, minlength=n_codes).nonzero()[0]
    if len(used) * _SHARED > n_states:
        return None
    examples = np.empty(n_codes, dtype=np.intp)
    examples[codes] = np.arange(n_states)
    numbers = np.zeros(n_codes, dtype=smallest_unsigned(len(used)))
    numbers[used] = np.arange(len(used))
    return TraceCells(
        layout=columns.layout,
        cells=numbers.take(codes),
        states=tuple(states_at(columns, examples[used], vocabulary)),
        objects=columns.objects,
        step_s=columns.step_s,
    )


def _number_of_values(declaration: Declaration, values: Array) -> int | None:
    """How many values a column may have; None if it may have any number, and has several."""
    if isinstance(declaration, Signal):
        return 2
    if isinstance(declaration, Enumeration):
        return len(declaration.values)
    return 1 if len(values) and (values == values[0]).all() else None


def trace_at(columns: TraceColumns, number: int, vocabulary: Vocabulary) -> Trace:
    """The trace of a number by itself."""
    states = states_at(columns, columns.layout.places(number), vocabulary)
    return Trace(str(number), columns.step_s, columns.objects, tuple(states), columns.present)


def states_at(
    columns: TraceColumns, places: NDArray[np.intp], vocabulary: Vocabulary
) -> list[dict[str, Any]]:
    """The states at these positions, with the values about those who are present."""
    steps = (columns.layout.starts.searchsorted(places, side="right") - 1).tolist()
    states: list[dict[str, Any]] = [{} for _ in steps]
    for (name, items), values in columns.values.items():
        key = name, items
        column = PartlyKnown(values, columns.upper.get(key), columns.unknown.get(key))
        own_values = column.at(places).decoded(vocabulary.declarations[name])
        since, until = _stretch(columns, items)
        for state, step, value in zip(states, steps, own_values, strict=True):
            if since <= step <= until:
                inner, path = state, (name, *items)
                for part in path[:-1]:
                    inner = inner.setdefault(part, {})
                inner[path[-1]] = value
    return states


def _stretch(columns: TraceColumns, items: Iterable[str]) -> tuple[int, int]:
    """The steps in which all of these are present."""
    stretches = [columns.present[item] for item in items if item in columns.present]
    since, until = zip((0, columns.layout.n_steps), *stretches, strict=True)
    return max(since), min(until)

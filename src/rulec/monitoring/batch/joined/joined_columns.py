"""Traces given as columns, or as rows of tables, laid end to end."""

from __future__ import annotations

from typing import Any

import numpy as np

from rulec.array_types import Indices
from rulec.monitoring.batch.columns.column_states import trace_at
from rulec.monitoring.batch.columns.encoded_columns import (
    PartlyKnown,
    UnencodableError,
    column_dtype,
    encode_values,
)
from rulec.monitoring.batch.joined.given_values import GivenValues, piece_of
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind, with_all_values
from rulec.monitoring.batch.joined.trace_places import TracePlaces
from rulec.trace import Trace
from rulec.trace.formats.table_blocks import NOBODY, Block, BlockPresence, Coded, Column
from rulec.trace.plain_arrays import ranges
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary


def joined_columns(columns: TraceColumns, vocabulary: Vocabulary) -> JoinedTraces:
    """Traces that a caller gives as columns, in their order, with their numbers as ids.

    Raises UnencodableError as ``piece_of``.
    """
    layout, objects = columns.layout, list(columns.objects)
    lengths = layout.lengths.astype(np.intp)
    steps = np.arange(layout.n_steps).repeat(np.diff(layout.starts))
    traces = np.arange(layout.n_states) - layout.starts[steps]
    spans: Any = np.zeros((layout.n_traces, len(objects), 2), dtype=np.intp)
    spans[:, :, 1] = lengths[:, None] - 1
    for number, item in enumerate(objects):
        spans[:, number] = columns.present.get(item, spans[:, number])
    n_objects, spans = [len(objects)] * layout.n_traces, spans.reshape(-1, 2)
    types = [*columns.objects.values()] * layout.n_traces
    places = TracePlaces(lengths, n_objects, spans, types, vocabulary)
    given: dict[str, list[GivenValues]] = {}
    for key, values in columns.values.items():
        name, items = key
        if columns.objects.keys() >= set(items):
            about = [len(objects) * traces + objects.index(item) for item in items]
            column = PartlyKnown(values, columns.upper.get(key), columns.unknown.get(key))
            own = GivenValues(places.begins[traces] + steps, tuple(about), column)
            given.setdefault(name, []).append(own)
    names = {name for name, _ in columns.values}
    return JoinedTraces(
        kind=TraceKind(columns.step_s, "complete", None),
        lengths=lengths,
        n_objects=n_objects,
        spans=spans,
        types=types,
        names=objects * layout.n_traces,
        pieces=(piece_of(given, places),),
        id_of=str,
        says=lambda _, name: name in names,
        trace=lambda n: with_all_values(trace_at(columns, n, vocabulary), vocabulary),
        derived=True,
    )


def check_arrays(columns: TraceColumns, vocabulary: Vocabulary) -> None:
    """Raise ValueError for an array that fits no name of the vocabulary, or not the layout."""
    for key, values in columns.values.items():
        (name, items), n_states = key, columns.layout.n_states
        what = f"the array for `{name}`{' of `' + ', '.join(items) + '`' if items else ''}"
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise ValueError(f"{what} is of no name that `{vocabulary.name}` has")
        most = len(declaration.parameters)
        if len(items) != most:
            raise ValueError(f"{what} is about {len(items)} objects, not {most}")
        for column in (values, columns.unknown.get(key, values), columns.upper.get(key, values)):
            if len(column) != n_states:
                raise ValueError(f"{what} has {len(column)} entries, for {n_states} states")
        if isinstance(declaration, Enumeration):
            most = len(declaration.values)
            wrong = values[(values < 0) | (values >= most)]
            if len(wrong):
                raise ValueError(
                    f"{what} has place {wrong[0]}, of {most} values, which count from 0"
                )


def joined_rows(
    block: Block, presence: BlockPresence, traces: Indices, vocabulary: Vocabulary
) -> JoinedTraces:
    """Some traces of a block, of one kind, in their order.

    Raises UnencodableError as ``piece_of``.
    """
    lengths = presence.length[traces].astype(np.intp)
    n_objects = np.diff(presence.starts)[traces]
    objects, firsts = ranges(presence.starts[traces], n_objects)
    spans = presence.stretches[objects].astype(np.intp)
    is_always = (spans[:, 0] == NOBODY).nonzero()[0]
    spans[is_always] = 0
    spans[is_always, 1] = (lengths - 1).repeat(n_objects)[is_always]
    types = [presence.types[item] for item in objects.tolist()]
    places = TracePlaces(lengths, n_objects, spans, types, vocabulary)
    number_of = np.full(len(block), -1)
    number_of[traces] = np.arange(len(traces))
    rows = (number_of[presence.trace] >= 0).nonzero()[0]
    numbers = number_of[presence.trace[rows]]
    states, of_rows = places.begins[numbers] + presence.step[rows], firsts[numbers]
    given: dict[str, list[GivenValues]] = {}
    known: dict[bytes, tuple[Indices, Indices, tuple[Indices, ...]]] = {}
    for name in block.table.names:
        said = block.columns[name].given[rows]
        if not said.any():
            continue
        key = said.tobytes()
        if key not in known:
            about = [
                _given(own[rows[said]], of_rows[said]) for own in (presence.item, presence.other)
            ]
            known[key] = rows[said], states[said], tuple(x for x in about if x is not None)
        own_rows, own_states, own_objects = known[key]
        column = _encoded(block.columns[name], own_rows, name, vocabulary)
        given[name] = [GivenValues(own_states, own_objects, column)]
    starts, table = block.starts.tolist(), block.table.names

    def says(number: int, name: str) -> bool:
        start, stop = starts[traces[number]], starts[traces[number] + 1]
        return name in table and bool(block.columns[name].given_at(slice(start, stop)).any())

    def trace(number: int) -> Trace:
        item = block[int(traces[number])]
        assert isinstance(item, Trace), "it has been read"
        return with_all_values(item, vocabulary)

    return JoinedTraces(
        kind=TraceKind(float(presence.step_s[traces[0]]), presence.ends[traces[0]], None),
        lengths=lengths,
        n_objects=n_objects.tolist(),
        spans=spans,
        types=types,
        names=[presence.objects[item] for item in objects.tolist()],
        pieces=(piece_of(given, places),),
        id_of=lambda number: presence.names[traces[number]],
        says=says,
        trace=trace,
        derived=True,
    )


def _given(items: Indices, firsts: Indices) -> Indices | None:
    """The numbers of the objects of rows; None for none. UnencodableError if only some have one."""
    if items.max(initial=NOBODY) == NOBODY:
        return None
    if items.min() == NOBODY:
        raise UnencodableError
    return items + firsts


def _encoded(column: Column, rows: Indices, name: str, vocabulary: Vocabulary) -> PartlyKnown:
    """The given values in some rows, encoded. Raises UnencodableError."""
    declaration = vocabulary.declarations.get(name)
    if declaration is None:
        raise UnencodableError
    return PartlyKnown(_values(column, rows, declaration))


def _values(column: Column, rows: Indices, declaration: Declaration) -> Array:
    if isinstance(column, Coded):
        codes = column.codes[rows]
        used = np.bincount(codes, minlength=len(column.values)) > 0
        values = [value for value, is_used in zip(column.values, used, strict=True) if is_used]
        table = np.zeros(len(used), dtype=column_dtype(declaration))
        table[used] = encode_values(values, declaration)
        return table.take(codes)
    numbers = column.numbers[rows]
    if isinstance(declaration, Enumeration | Signal) or not np.isfinite(numbers).all():
        raise UnencodableError
    return numbers

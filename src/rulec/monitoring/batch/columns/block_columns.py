"""Columns of values from blocks of tables without oddities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.batch.columns.value_encoding import (
    UnencodableError,
    column_dtype,
    encode_values,
)
from rulec.monitoring.batch.trace_shapes import Names
from rulec.trace.formats.block_presence import NOBODY, BlockPresence
from rulec.trace.formats.table_blocks import Block, Coded, Column
from rulec.trace.trace_columns import Array, Key, Layout, TraceColumns, layout_of
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary

_MOST_EMPTY = 64
"""So many times as many cells as there are rows may be left empty."""


@dataclass(frozen=True, slots=True, eq=False)
class BlockGroup:
    """Traces of one shape in a block, with one trace's object names.

    ``traces`` are their places in the block, in the order of the ``layout``; ``rows`` those of the
    block that are theirs, ``state`` where these rows' states stand in a column.
    """

    block: Block
    presence: BlockPresence
    traces: NDArray[np.int64]
    layout: Layout
    rows: NDArray[np.int64]
    state: NDArray[np.int64]
    objects: Names
    types: Sequence[str]
    stretches: NDArray[np.int64]


def groups_of(block: Block, presence: BlockPresence) -> list[BlockGroup]:
    """The traces of a block, by their shape."""
    shapes: dict[tuple[object, ...], list[int]] = {}
    for trace in range(len(block)):
        shapes.setdefault(presence.shape_of(trace), []).append(trace)
    return [_group(block, presence, np.array(traces)) for traces in shapes.values()]


def _group(block: Block, presence: BlockPresence, traces: NDArray[np.int64]) -> BlockGroup:
    traces = traces[np.argsort(-presence.length[traces], kind="stable")]
    layout = layout_of(presence.length[traces])
    rank = np.full(len(block), -1)
    rank[traces] = np.arange(len(traces))
    rows = np.flatnonzero(rank[presence.trace] >= 0)
    state = layout.starts[presence.step[rows]] + rank[presence.trace[rows]]
    there = slice(presence.starts[traces[0]], presence.starts[traces[0] + 1])
    names, types = tuple(presence.objects[there]), presence.types[there]
    stretches = presence.stretches[there]
    return BlockGroup(
        block=block,
        presence=presence,
        traces=traces,
        layout=layout,
        rows=rows,
        state=state,
        objects=names,
        types=types,
        stretches=stretches,
    )


def columnize_block(group: BlockGroup, vocabulary: Vocabulary) -> TraceColumns:
    """The group as columns. Raises OddError as ``gathered`` does."""
    columns: dict[Key, Array] = {}
    for name in group.block.table.names:
        column = group.block.columns[name]
        told = column.given[group.rows]
        if not told.any():
            continue
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise UnencodableError
        columns |= _by_objects(column, told, declaration, group, vocabulary)
    present = {
        name: (first, last)
        for name, (first, last) in zip(group.objects, group.stretches.tolist(), strict=True)
        if first != NOBODY
    }
    objects = dict(zip(group.objects, group.types, strict=True))
    step_s = float(group.presence.step_s[group.traces[0]])
    return TraceColumns(group.layout, columns, objects, present, step_s)


def _by_objects(
    column: Column,
    told: NDArray[np.bool_],
    declaration: Declaration,
    group: BlockGroup,
    vocabulary: Vocabulary,
) -> dict[Key, Array]:
    """Columns of a name's values by the objects that they describe."""
    rows, state = group.rows[told], group.state[told]
    about = [group.presence.item[rows], group.presence.other[rows]]
    n_parameters = len(declaration.parameters)
    if any((one == NOBODY).any() for one in about[:n_parameters]):
        raise UnencodableError
    if any((one != NOBODY).any() for one in about[n_parameters:]):
        raise UnencodableError
    n_objects, n_states = len(group.objects), group.layout.n_states
    which = np.zeros(len(rows), dtype=np.int64)
    for place in about[:n_parameters]:
        which = which * n_objects + place
    result = np.flatnonzero(np.bincount(which))
    if len(result) * n_states > len(group.rows) * _MOST_EMPTY:
        raise UnencodableError
    number = np.zeros(int(result[-1]) + 1, dtype=np.int64)
    number[result] = np.arange(len(result))
    values = _values(column, rows, declaration)
    cells = number[which] * n_states + state
    table = np.zeros(len(result) * n_states, dtype=values.dtype)
    table[cells] = values
    is_told = np.zeros(len(table), dtype=bool)
    is_told[cells] = True
    if np.count_nonzero(is_told) != len(cells):
        raise UnencodableError  # something is told twice
    columns: dict[Key, Array] = {}
    lines = zip(table.reshape(-1, n_states), is_told.reshape(-1, n_states), strict=True)
    for one, (line, was_told) in zip(result.tolist(), lines, strict=True):
        places = [one // n_objects, one % n_objects][2 - n_parameters :] if n_parameters else []
        for place, parameter in zip(places, declaration.parameters, strict=True):
            if not vocabulary.is_subtype(group.types[place], parameter):
                raise UnencodableError
        if not was_told.all():
            _fill(line, ~was_told, places, declaration, group)
        columns[declaration.name, tuple([group.objects[place] for place in places])] = line
    return columns


def _values(column: Column, rows: NDArray[np.int64], declaration: Declaration) -> Array:
    """Encoded values of rows, in the encoding of ``TraceColumns``."""
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


def _fill(
    line: Array,
    missing: NDArray[np.bool_],
    places: Sequence[int],
    declaration: Declaration,
    group: BlockGroup,
) -> None:
    """Fill in a column's default for objects present but without values."""
    default = declaration.default
    if default is not None:
        line[missing] = encode_values([default], declaration)[0]
        return
    starts = group.layout.starts
    needed = missing.copy()
    for first, last in group.stretches[list(places)].tolist():
        if first != NOBODY:
            # All traces have these steps.
            needed[: starts[first]] = False
            needed[starts[last + 1] :] = False
    if needed.any():
        raise UnencodableError

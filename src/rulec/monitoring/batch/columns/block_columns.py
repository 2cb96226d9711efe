"""Columns of values from blocks of regular tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.batch.columns.encoded_columns import (
    UnencodableError,
    column_dtype,
    encode_values,
)
from rulec.monitoring.batch.trace_groups import Names
from rulec.trace.formats.table_blocks import NOBODY, Block, BlockPresence, Coded, Column
from rulec.trace.trace_columns import Array, Key, Layout, TraceColumns, layout_of
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary

_MOST_EMPTY = 64
"""How many cells per row may be empty."""


@dataclass(frozen=True, slots=True, eq=False)
class BlockGroup:
    """Traces of one shape in a block, with the object names of one trace.

    ``traces`` are their positions in the block, in the order of the ``layout``; ``rows`` are their
    rows in the block, and ``state`` is the position of each of these rows' states in a column.
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
    """The traces of a block of which everything is known, grouped by shape."""
    shapes: dict[tuple[object, ...], list[int]] = {}
    for trace in sorted(set(range(len(block))) - block.partial):
        shapes.setdefault(presence.shape_of(trace), []).append(trace)
    return [_group(block, presence, np.array(traces)) for traces in shapes.values()]


def _group(block: Block, presence: BlockPresence, traces: NDArray[np.int64]) -> BlockGroup:
    traces = traces[(-presence.length[traces]).argsort(kind="stable")]
    layout = layout_of(presence.length[traces])
    rank = np.full(len(block), -1)
    rank[traces] = np.arange(len(traces))
    rows = (rank[presence.trace] >= 0).nonzero()[0]
    objects = slice(presence.starts[traces[0]], presence.starts[traces[0] + 1])
    return BlockGroup(
        block=block,
        presence=presence,
        traces=traces,
        layout=layout,
        rows=rows,
        state=layout.starts[presence.step[rows]] + rank[presence.trace[rows]],
        objects=tuple(presence.objects[objects]),
        types=presence.types[objects],
        stretches=presence.stretches[objects],
    )


def columnize_block(group: BlockGroup, vocabulary: Vocabulary) -> TraceColumns:
    """The group as columns. Raises UnencodableError."""
    columns: dict[Key, Array] = {}
    placed: list[_Placement] = []
    for name in group.block.table.names:
        column = group.block.columns[name]
        given = column.given[group.rows]
        if given.any():
            if name not in vocabulary.declarations:
                raise UnencodableError
            declaration = vocabulary.declarations[name]
            n_parameters = len(declaration.parameters)
            known = (item for item in placed if item.is_of(given, n_parameters))
            placement = next(known, None)
            if placement is None:
                placement = _placement(given, n_parameters, group)
                placed.append(placement)
            columns |= _by_objects(column, placement, declaration, group, vocabulary)
    present = {
        name: (first, last)
        for name, (first, last) in zip(group.objects, group.stretches.tolist(), strict=True)
        if first != NOBODY
    }
    objects = dict(zip(group.objects, group.types, strict=True))
    step_s = float(group.presence.step_s[group.traces[0]])
    return TraceColumns(group.layout, columns, objects, present, step_s)


@dataclass(frozen=True, slots=True, eq=False)
class _Placement:
    """Positions in the columns for objects of values that are ``given`` in some rows.

    ``choices`` are the choices of objects that have columns, each encoded as one number whose
    digits are the objects' places. ``rows`` are those of the block, ``cells`` their positions in
    all columns together, and ``are_given`` the mask of these positions (columns x states).
    """

    given: NDArray[np.bool_]
    n_parameters: int
    choices: NDArray[np.int64]
    rows: NDArray[np.int64]
    cells: NDArray[np.int64]
    are_given: NDArray[np.bool_]

    def is_of(self, given: NDArray[np.bool_], n_parameters: int) -> bool:
        """Whether this placement is that of the values given in these rows."""
        return self.n_parameters == n_parameters and np.array_equal(self.given, given)


def _placement(given: NDArray[np.bool_], n_parameters: int, group: BlockGroup) -> _Placement:
    rows, state = group.rows[given], group.state[given]
    n_objects, n_states = len(group.objects), group.layout.n_states
    chosen = np.zeros(len(rows), dtype=np.int64)
    for parameter, items in enumerate((group.presence.item[rows], group.presence.other[rows])):
        if ((items == NOBODY) if parameter < n_parameters else (items != NOBODY)).any():
            raise UnencodableError
        if parameter < n_parameters:
            chosen = chosen * n_objects + items
    choices = np.bincount(chosen).nonzero()[0]
    if len(choices) * n_states > len(group.rows) * _MOST_EMPTY:
        raise UnencodableError
    line_of = np.zeros(int(choices[-1]) + 1, dtype=np.int64)
    line_of[choices] = np.arange(len(choices))
    cells = line_of[chosen] * n_states + state
    are_given = np.zeros((len(choices), n_states), dtype=bool)
    are_given.ravel()[cells] = True
    if np.count_nonzero(are_given) != len(cells):
        raise UnencodableError  # something is said twice
    return _Placement(
        given=given,
        n_parameters=n_parameters,
        choices=choices,
        rows=rows,
        cells=cells,
        are_given=are_given,
    )


def _by_objects(
    column: Column,
    placement: _Placement,
    declaration: Declaration,
    group: BlockGroup,
    vocabulary: Vocabulary,
) -> dict[Key, Array]:
    """Columns of a name's values, by the objects that they describe."""
    n_objects, n_parameters = len(group.objects), placement.n_parameters
    choices, are_given = placement.choices, placement.are_given
    values = encode_column(column, placement.rows, declaration)
    lines = np.zeros(are_given.shape, dtype=values.dtype)
    lines.ravel()[placement.cells] = values
    columns: dict[Key, Array] = {}
    for choice, line, is_given in zip(choices.tolist(), lines, are_given, strict=True):
        places = divmod(choice, n_objects)[2 - n_parameters :] if n_parameters else ()
        for place, kind in zip(places, declaration.parameters, strict=True):
            if not vocabulary.is_subtype(group.types[place], kind):
                raise UnencodableError
        if not is_given.all():
            _fill(line, ~is_given, places, declaration, group)
        columns[declaration.name, tuple([group.objects[place] for place in places])] = line
    return columns


def encode_column(column: Column, rows: NDArray[np.int64], declaration: Declaration) -> Array:
    """The given values in some rows, encoded. Raises UnencodableError."""
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

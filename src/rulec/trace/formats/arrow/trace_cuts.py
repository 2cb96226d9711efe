"""Tables that come in pieces, cut where traces end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from typing import Any

import numpy as np
import pyarrow

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats.arrow.arrow_columns import coded, columns_of
from rulec.trace.formats.chunks import in_chunks
from rulec.trace.formats.table_blocks import Block, OddTableError, trace_starts
from rulec.trace.formats.table_reader import TRACE, Row, Table, traces_in
from rulec.trace.trace_model import Trace

Piece = Any
"""A record batch."""


def cut(
    pieces: Iterable[Piece | Iterator[Row] | RulecError],
    table: Table,
    first: int,
    file: SourceLocation,
) -> Iterator[Sequence[Trace | RulecError]]:
    """Cut a table into traces: blocks, or lists of rows.

    ``pieces`` may end with rows, which are then read one by one, or with an error, which takes the
    place of the trace that may have gone on there. ``first`` is the first row's number. A table
    without any trace gives one RulecError, as from ``traces_in``.
    """
    waiting: list[Piece] = []
    for piece in pieces:
        if isinstance(piece, RulecError):
            yield [piece]
            return
        if not isinstance(piece, pyarrow.RecordBatch):
            rows = chain(_rows(waiting, first), piece)
            yield from in_chunks(traces_in(rows, table, file))
            return
        if not len(piece):
            continue
        end = _last_start(waiting, piece, table)
        if end is None:
            waiting.append(piece)
            continue
        whole = [*waiting, piece.slice(0, end)]
        yield _block(whole, table, first, file)
        first += sum(map(len, whole))
        waiting = [piece.slice(end)]
    yield _block(waiting, table, first, file)


def _last_start(waiting: Sequence[Piece], piece: Piece, table: Table) -> int | None:
    """Start of the last trace of a piece; None if earlier."""
    at = table.at[TRACE]
    start = int(trace_starts(coded(piece.column(at)))[-1])
    if start:
        return start
    if not waiting or waiting[-1].column(at)[-1] == piece.column(at)[0]:
        return None
    return 0


def _block(
    pieces: Sequence[Piece], table: Table, first: int, file: SourceLocation
) -> Sequence[Trace | RulecError]:
    if not pieces:
        return list(traces_in((), table, file))
    whole = pyarrow.Table.from_batches(pieces).combine_chunks().to_batches()[0]
    try:
        columns = columns_of(whole, table)
    except OddTableError:
        return list(traces_in(_rows([whole], first), table, file))
    starts = np.append(trace_starts(coded(whole.column(table.at[TRACE]))), len(whole))

    def rows(start: int, stop: int) -> Iterator[Row]:
        return _rows([whole.slice(start, stop - start)], first + start)

    return Block(table, columns, starts, rows, file)


def _rows(pieces: Iterable[Piece], first: int) -> Iterator[Row]:
    cells = chain.from_iterable(
        zip(*[column.to_pylist() for column in piece.columns], strict=True) for piece in pieces
    )
    return enumerate(cells, first)

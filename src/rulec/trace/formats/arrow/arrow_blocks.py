"""Tables in pieces, cut where traces end, with columns as arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import compute, types

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats import table_blocks as blocks
from rulec.trace.formats.table_reader import (
    NAMES,
    OWN,
    PARTIAL,
    TRACE,
    Row,
    Table,
    in_chunks,
    traces_in,
)
from rulec.trace.trace_model import Trace
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue
from rulec.vocabulary.written_numbers import WrittenNumber, number_written

Piece = Any
"""A record batch."""

NUMBER = r"\A[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\z"
"""A number in a text, as ``csv_table`` knows it."""

_FEW = 1 << 10
_SHORT = 15
"""Numbers of so many characters are floats, but for those with an exponent."""


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
    start = int(blocks.trace_starts(coded(piece.column(at)))[-1])
    goes_on = not waiting or waiting[-1].column(at)[-1] == piece.column(at)[0]
    return None if start == 0 and goes_on else start


def _block(
    pieces: Sequence[Piece], table: Table, first: int, file: SourceLocation
) -> Sequence[Trace | RulecError]:
    if not pieces:
        return list(traces_in((), table, file))
    whole = pyarrow.Table.from_batches(pieces).combine_chunks().to_batches()[0]
    partial = _partial_rows(whole, table)
    try:
        columns = columns_of(whole, table)
    except (blocks.OddTableError, ValueError):  # a number that cannot be
        return list(traces_in(_rows([whole], first), table, file))
    for column in columns.values():
        partial |= _no_floats(column)
    starts = np.append(blocks.trace_starts(coded(whole.column(table.at[TRACE]))), len(whole))

    def rows(start: int, stop: int) -> Iterator[Row]:
        return _rows([whole.slice(start, stop - start)], first + start)

    owner = np.searchsorted(starts, np.flatnonzero(partial), "right") - 1
    partial_traces = frozenset(owner.tolist())
    return blocks.Block(table, columns, starts, rows, file, partial=partial_traces)


def _partial_rows(piece: Piece, table: Table) -> NDArray[np.bool_]:
    """The rows that say that something is not known."""
    rows = np.zeros(len(piece), dtype=bool)
    bounds = chain.from_iterable(table.intervals.values())
    for place in (*(table.at[name] for name in PARTIAL if name in table.at), *bounds):
        array = piece.column(place)
        said = compute.is_valid(array)
        if types.is_string(array.type):
            said = compute.and_kleene(said, compute.not_equal(array, ""))
        rows |= said.fill_null(False).to_numpy(zero_copy_only=False)
    if table.has_texts:
        for name in table.names:
            is_mark = compute.equal(piece.column(table.at[name]), UNKNOWN.value)
            if compute.any(is_mark).as_py():
                rows |= is_mark.fill_null(False).to_numpy(zero_copy_only=False)
    return rows


def _no_floats(column: blocks.Column) -> NDArray[np.bool_] | bool:
    """The rows with numbers that no float stands for."""
    if isinstance(column, blocks.Numbers):
        return False
    which = [type(value) is WrittenNumber for value in column.values]
    return np.array(which).take(column.codes) & column.given if any(which) else False


def _rows(pieces: Iterable[Piece], first: int) -> Iterator[Row]:
    cells = chain.from_iterable(
        zip(*[column.to_pylist() for column in piece.columns], strict=True) for piece in pieces
    )
    return enumerate(cells, first)


def columns_of(piece: Any, table: Table) -> Mapping[str, blocks.Column]:
    """The columns of a piece (a record batch). Raises OddTableError."""
    columns: dict[str, blocks.Column] = {}
    for name in (*OWN, *table.names):
        if name in PARTIAL or name not in table.at:
            continue
        array = piece.column(table.at[name])
        if types.is_dictionary(array.type):
            array = array.dictionary_decode()  # whose values need not be distinct
        if name in NAMES:
            columns[name] = coded(array)
        elif table.has_texts:
            columns[name] = _read(coded(array), table.value)
        elif types.is_integer(array.type) or types.is_floating(array.type):
            columns[name] = _numbers(array)
        else:
            columns[name] = coded(array)
    return columns


def coded(array: Any) -> blocks.Coded:
    """Column of dictionary codes; empty texts are no value."""
    if types.is_null(array.type):
        return blocks.Coded(np.full(len(array), -1), ())
    encoded = array.dictionary_encode()
    values = encoded.dictionary.to_pylist()
    codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False)
    if "" in values:
        codes = np.where(codes == values.index(""), -1, codes)
    return blocks.Coded(codes, values)


def _numbers(array: Any) -> blocks.Numbers:
    try:
        numbers = array.cast(pyarrow.float64()).fill_null(0)
    except pyarrow.ArrowInvalid:  # floats cannot tell such whole numbers apart
        raise blocks.OddTableError from None
    given = compute.is_valid(array)
    return blocks.Numbers(
        numbers.to_numpy(zero_copy_only=False), given.to_numpy(zero_copy_only=False)
    )


def _read(texts: blocks.Coded, value: Callable[[str], PartialValue]) -> blocks.Column:
    if UNKNOWN.value in texts.values:  # its rows are read one by one
        place = texts.values.index(UNKNOWN.value)
        texts = blocks.Coded(np.where(texts.codes == place, -1, texts.codes), texts.values)
        texts = blocks.Coded(texts.codes, ["" if x == UNKNOWN.value else x for x in texts.values])
    if len(texts.values) > _FEW:
        written = pyarrow.array([text or "0" for text in texts.values])
        if compute.all(compute.match_substring_regex(written, NUMBER)).as_py():
            try:
                numbers = written.cast(pyarrow.float64())
                if _are_floats(written, numbers):
                    numbers = numbers.to_numpy()
                    return blocks.Numbers(numbers.take(texts.codes, mode="clip"), texts.given)
            except pyarrow.ArrowInvalid:  # such as `.5`, which Arrow does not read
                pass
    return blocks.Coded(texts.codes, [value(text) if text else "" for text in texts.values])


def _are_floats(texts: Any, numbers: Any) -> bool:
    """Whether each text is the decimal that its float stands for."""
    long = compute.greater(compute.binary_length(texts), _SHORT)
    long = compute.or_(long, compute.match_substring(texts, "e", ignore_case=True))
    doubtful = compute.and_(long, compute.not_equal(numbers.cast(pyarrow.string()), texts))
    return not any(
        isinstance(number_written(text), WrittenNumber)
        for text in texts.filter(doubtful).to_pylist()
    )

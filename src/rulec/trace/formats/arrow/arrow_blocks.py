"""Tables that arrive in pieces, cut where traces end, with columns as arrays."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import types

from rulec.diagnostics import RulecError, SourceLocation
from rulec.resource_limits import STATES
from rulec.trace.formats import table_blocks as blocks
from rulec.trace.formats.arrow.arrow_arrays import (
    are_equal,
    array_of_truths,
    cast_to,
    codes_in,
    ends_in,
    given_in,
    lengths_in,
    list_lengths_in,
    numbers_in,
    one_in,
    runs_in,
    truths_in,
)
from rulec.trace.formats.table_reader import (
    ENDS,
    NAMES,
    OWN,
    STEP,
    TOLD,
    TRACE,
    UNKNOWN_NAMES,
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

CodesReader = Callable[[Any], tuple[NDArray[Any], Sequence[Any]]]

_SHORT = 15
"""Numbers of at most this many characters are exact floats, except tiny ones with an exponent."""

_TINY = 1e-290

_FEW_ROWS = 1 << 10

_DIGIT = re.compile(r"\A[-+.]?[0-9]")


class WholeTraces(NamedTuple):
    """A piece that ends where a trace ends; further traces follow."""

    piece: Piece


def cut(
    pieces: Iterable[Piece | WholeTraces | Iterator[Row] | RulecError],
    table: Table,
    first: int,
    file: SourceLocation,
) -> Iterator[Sequence[Trace | RulecError]]:
    """Cut a table into traces: blocks, or lists of traces read row by row.

    ``pieces`` may end with an iterator of rows, which are read one by one, or with an error, which
    replaces the trace that may have continued there. ``first`` is the number of the first row. A
    table without any trace gives one RulecError, as from ``traces_in``.
    """
    waiting: list[Piece] = []
    most = STATES.value()
    for piece in pieces:
        if isinstance(piece, RulecError):
            yield [piece]
            return
        if isinstance(piece, WholeTraces):
            whole = [*waiting, piece.piece]
            yield _block(whole, table, first, file)
            first, waiting = first + sum(map(len, whole)), []
            continue
        if not isinstance(piece, pyarrow.RecordBatch):
            rows = chain(_rows(waiting, first, table), piece)
            yield from in_chunks(traces_in(rows, table, file))
            return
        if not len(piece):
            continue
        end = _last_start(waiting, piece, table)
        if end is None:
            waiting.append(piece)
            if sum(map(len, waiting)) > most:
                yield [STATES.exceeded(table.place(first))]
                return
            continue
        whole = [*waiting, piece.slice(0, end)]
        yield _block(whole, table, first, file)
        first += sum(map(len, whole))
        waiting = [piece.slice(end)]
    yield _block(waiting, table, first, file)


def _last_start(waiting: Sequence[Piece], piece: Piece, table: Table) -> int | None:
    """The row where a piece's last trace begins; None if no trace has ended before it."""
    at = table.at[TRACE]
    names = piece.column(at)
    start = start_of_last(names)
    goes_on = not waiting or waiting[-1].column(at)[-1] == names[0]
    return None if start == 0 and goes_on else start


def start_of_last(names: Any) -> int:
    """The row where the last trace begins, from the column of trace names."""
    if not types.is_string(names.type) or not names[-1].as_py():
        return int(blocks.trace_starts(coded(names))[-1])
    # Searching backwards for another name is faster than encoding all names.
    for size in (_FEW_ROWS, len(names)):
        begin = max(len(names) - size, 0)
        others = np.flatnonzero(~are_equal(names.slice(begin), names[-1]))
        if len(others):
            return begin + int(others[-1]) + 1
    return 0


def _block(
    pieces: Sequence[Piece], table: Table, first: int, file: SourceLocation
) -> Sequence[Trace | RulecError]:
    if not pieces:
        return list(traces_in((), table, file))
    if any(piece.schema != pieces[0].schema for piece in pieces):
        pieces = [_as_texts(piece) for piece in pieces]
    whole = pyarrow.Table.from_batches(pieces).combine_chunks().to_batches()[0]
    partial = _partial_rows(whole, table)
    try:
        columns = columns_of(whole, table)
    except (blocks.OddTableError, ValueError):  # ValueError: a number outside the limits
        return list(traces_in(_rows([whole], first, table), table, file))
    is_odd = np.zeros(len(whole), dtype=bool)
    for column in columns.values():
        is_odd |= _odd_values(column)
    names = columns[TRACE]
    assert isinstance(names, blocks.Coded), "names are texts"
    starts = np.append(blocks.trace_starts(names), len(whole))

    def rows(start: int, stop: int) -> Iterator[Row]:
        return _rows([whole.slice(start, stop - start)], first + start, table)

    unknown = _unknown_rows(whole, table)
    if unknown is None:
        unknown = {}
        partial |= given_in(whole.column(table.at[UNKNOWN_NAMES]))
    for nobody_knows in unknown.values():
        is_odd[nobody_knows] = True
    unsaid, others = (
        frozenset((np.searchsorted(starts, np.flatnonzero(flags), "right") - 1).tolist())
        for flags in (partial, is_odd)
    )
    return blocks.Block(
        table,
        columns,
        starts,
        rows,
        file,
        partial=unsaid | others,
        unsaid=unsaid,
        unknown=unknown,
    )


def _unknown_rows(piece: Piece, table: Table) -> Mapping[str, NDArray[np.int64]] | None:
    """Name -> rows in which its value is unknown; None if the names are not in plain lists."""
    if UNKNOWN_NAMES not in table.at:
        return {}
    lists = piece.column(table.at[UNKNOWN_NAMES])
    if types.is_null(lists.type):
        return {}
    if not types.is_list(lists.type) or not types.is_string(lists.type.value_type):
        return None
    lengths = list_lengths_in(lists)
    codes, names = codes_in(lists.flatten())
    if (codes < 0).any():
        return None
    row = np.repeat(np.arange(len(piece)), np.where(given_in(lengths), numbers_in(lengths), 0))
    return {name: row[codes == code] for code, name in enumerate(names)}


def _partial_rows(piece: Piece, table: Table) -> NDArray[np.bool_]:
    """Mask of the rows that give an interval's bounds or ``told``."""
    rows = np.zeros(len(piece), dtype=bool)
    bounds = chain.from_iterable(table.intervals.values())
    own = [table.at[TOLD]] if TOLD in table.at else []
    for place in (*own, *bounds):
        array = piece.column(place)
        is_text = types.is_string(array.type) or types.is_dictionary(array.type)
        rows |= coded(array).given if is_text else given_in(array)
    return rows


def _odd_values(column: blocks.Column) -> NDArray[np.bool_] | bool:
    """Mask of the rows with unknown values or with numbers that no float represents."""
    if isinstance(column, blocks.Numbers) or isinstance(column.values, range):
        return False
    which = [value is UNKNOWN or type(value) is WrittenNumber for value in column.values]
    return np.array(which).take(column.codes) & column.given if any(which) else False


def _rows(pieces: Iterable[Piece], first: int, table: Table) -> Iterator[Row]:
    if table.has_texts:
        pieces = map(_as_texts, pieces)
    cells = chain.from_iterable(
        zip(*[column.to_pylist() for column in piece.columns], strict=True) for piece in pieces
    )
    return enumerate(cells, first)


def _as_texts(piece: Piece) -> Piece:
    """A piece with its Boolean columns as text."""
    columns = [
        cast_to(column, pyarrow.string()) if types.is_boolean(column.type) else column
        for column in piece.columns
    ]
    return pyarrow.RecordBatch.from_arrays(columns, names=piece.schema.names)


def columns_of(piece: Any, table: Table) -> Mapping[str, blocks.Column]:
    """The columns of a record batch as arrays. Raises OddTableError."""
    columns: dict[str, blocks.Column] = {}
    for name in (*OWN, *table.names):
        if name in (TOLD, UNKNOWN_NAMES) or name not in table.at:
            continue
        array = piece.column(table.at[name])
        steps = _whole(array) if name == STEP else None
        if steps is not None:
            columns[name] = steps
        elif name == TRACE and types.is_string(array.type):
            columns[name] = coded(array, runs_in)
        elif name in NAMES or name == ENDS:
            columns[name] = (_one_text(array, str) if table.has_texts else None) or coded(array)
        elif types.is_boolean(array.type):
            codes = np.where(given_in(array), truths_in(array), np.int8(-1))
            columns[name] = blocks.Coded(codes, (False, True))
        elif table.has_texts:
            columns[name] = _texts_read(array, table.value)
        elif types.is_integer(array.type) or types.is_floating(array.type):
            columns[name] = _numbers(array)
        else:
            columns[name] = coded(array)
    return columns


def coded(array: Any, codes_in: CodesReader = codes_in) -> blocks.Coded:
    """A column as codes of its distinct values; empty texts count as missing."""
    codes, values = codes_in(array)
    if "" in values:
        codes = np.where(codes == values.index(""), -1, codes)
    return blocks.Coded(codes, values)


def _numbers(array: Any) -> blocks.Numbers:
    try:
        numbers = numbers_in(cast_to(array, pyarrow.float64()))
    except pyarrow.ArrowInvalid:  # integers too large for exact floats
        raise blocks.OddTableError from None
    return blocks.Numbers(numbers, given_in(array), whole=types.is_integer(array.type))


def _whole(array: Any) -> blocks.Coded | None:
    """Steps as codes that equal them; None if they are not plain whole numbers."""
    if types.is_string(array.type):
        lengths = lengths_in(array)
        try:
            array = cast_to(array, pyarrow.int64())
        except pyarrow.ArrowInvalid:
            return None
        # Arrow also accepts `0x10` and `-0`.
        if ((lengths != _n_digits(numbers_in(array))) & given_in(array)).any():
            return None
    if not types.is_int64(array.type):
        return None
    steps = numbers_in(array)
    fits = given_in(array) & (steps >= 0) & (steps < len(steps))
    return blocks.Coded(np.where(fits, steps, -1), range(len(steps)))


def _n_digits(steps: NDArray[np.int64]) -> NDArray[np.int8]:
    digits, most = np.ones(len(steps), dtype=np.int8), int(steps.max(initial=0))
    for power in range(1, len(str(most))):
        digits += steps >= 10**power
    return digits


def _texts_read(array: Any, value: Callable[[str], PartialValue]) -> blocks.Column:
    """A column of values read from texts, or of numbers if all texts are numbers."""
    column = _one_text(array, value) or _numbers_said(array)
    if column is not None:
        return column
    texts = coded(array)
    return blocks.Coded(texts.codes, [value(text) if text else "" for text in texts.values])


def _one_text(array: Any, value: Callable[[str], PartialValue]) -> blocks.Coded | None:
    """A column in which all texts are the same; None if they differ."""
    same = one_in(array)
    return None if same is None else blocks.Coded(same[0], [value(same[1])])


def _numbers_said(array: Any) -> blocks.Numbers | None:
    """The numbers of a column if each text is exactly a float's decimal; else None."""
    lengths = lengths_in(array)
    given = lengths > 0
    # Arrow takes long to refuse texts that are not numbers.
    if not given.any() or not _DIGIT.search(array[int(given.argmax())].as_py()):
        return None
    try:
        floats = cast_to(array, pyarrow.float64())
    except pyarrow.ArrowInvalid:  # texts, or numbers that Arrow does not read, such as `.5`
        return None
    numbers = numbers_in(floats)
    sizes = np.abs(np.where(given, numbers, 1.0))
    # Arrow accepts `nan`, and a number with an exponent may be closer to 0 than any float.
    if not np.isfinite(sizes.max()):
        return None
    if not sizes.min() > _TINY and _has_exponents(array):
        return None
    long = np.flatnonzero(lengths > _SHORT)
    if len(long):
        places = pyarrow.Array.from_buffers(
            pyarrow.int64(), len(long), [None, pyarrow.py_buffer(long.astype(np.int64))]
        )
        texts, again = array.take(places), cast_to(floats.take(places), pyarrow.string())
        others = texts.filter(array_of_truths(~are_equal(texts, again))).to_pylist()
        if any(isinstance(number_written(text), WrittenNumber) for text in others):
            return None
    return blocks.Numbers(numbers, given)


def _has_exponents(array: Any) -> bool:
    _, _, data = array.buffers()
    ends = ends_in(array)
    text = np.frombuffer(data, np.uint8)[ends[0] : ends[-1]]
    return bool(np.isin(text, (ord("e"), ord("E"))).any())

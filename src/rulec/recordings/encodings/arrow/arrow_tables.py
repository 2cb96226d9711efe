"""Tables in Parquet and Feather files, read with Arrow within bounds.

Feather's second version is Arrow's file format for interprocess communication. See the Arrow
columnar format, "Serialization and Interprocess Communication" (format version 1.5): a file holds
messages, each with metadata as a flatbuffer and a body whose buffers may be packed. What buffers
unpack to is added up before Arrow unpacks them; everything else is left to Arrow.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import LARGEST, short
from rulec.recordings.encodings.table_columns import Texts
from rulec.trace.formats import arrow as arrays
from rulec.trace.formats.arrow.parquet import arrow as arrow_modules

_DICTIONARY_BATCH, _RECORD_BATCH = 2, 3
_HEADER_TYPE, _HEADER = 1, 2
_ROWS, _BUFFERS, _COMPRESSION = 0, 2, 3
_BATCH_OF_DICTIONARY = 1
_BUFFER_BYTES = 16
_MOST_BUFFERS = 100_000


class OddMessageError(Exception):
    """The metadata of a message are inconsistent."""


@dataclass(frozen=True, slots=True)
class BatchSize:
    """The stated number of rows of a batch, and the bytes that its buffers unpack to."""

    rows: int
    unpacked_bytes: int


def batch_size(metadata: bytes, body: memoryview) -> BatchSize:
    """The size of a message's batch; zero for messages of other kinds.

    Raises OddMessageError.
    """
    try:
        message = _table_at(metadata, 0)
        kind = _scalar(metadata, message, _HEADER_TYPE, "<B")
        if kind not in (_DICTIONARY_BATCH, _RECORD_BATCH):
            return BatchSize(0, 0)
        batch = _table_in(metadata, message, _HEADER)
        if kind == _DICTIONARY_BATCH:
            batch = _table_in(metadata, batch, _BATCH_OF_DICTIONARY)
        packed = _place(metadata, batch, _COMPRESSION) is not None
        sizes = sum(_buffer_sizes(metadata, batch, body, packed=packed))
        return BatchSize(_scalar(metadata, batch, _ROWS, "<q"), sizes)
    except (struct.error, IndexError):
        raise OddMessageError from None


def _buffer_sizes(metadata: bytes, batch: int, body: memoryview, *, packed: bool) -> Iterator[int]:
    at = _place(metadata, batch, _BUFFERS)
    if at is None:
        return
    start = at + _unsigned(metadata, at)
    count = _unsigned(metadata, start)
    if count > _MOST_BUFFERS:
        raise OddMessageError
    for number in range(count):
        offset, length = struct.unpack_from("<qq", metadata, start + 4 + number * _BUFFER_BYTES)
        if offset < 0 or length < 0 or offset + length > len(body):
            raise OddMessageError
        if packed and length:
            (size,) = struct.unpack_from("<q", body, offset)
            # -1: this buffer is not packed
            yield length if size == -1 else size
            if size < -1:
                raise OddMessageError
        else:
            yield length


def _table_at(data: bytes, at: int) -> int:
    return at + _unsigned(data, at)


def _unsigned(data: bytes, at: int) -> int:
    value: int = struct.unpack_from("<I", data, at)[0]
    return value


def _place(data: bytes, table: int, field: int) -> int | None:
    """The position of a flatbuffer table's field; None if the field is absent."""
    virtual = table - struct.unpack_from("<i", data, table)[0]
    if virtual < 0:
        raise OddMessageError
    (size,) = struct.unpack_from("<H", data, virtual)
    if 4 + 2 * field + 2 > size:
        return None
    (offset,) = struct.unpack_from("<H", data, virtual + 4 + 2 * field)
    return table + offset if offset else None


def _table_in(data: bytes, table: int, field: int) -> int:
    at = _place(data, table, field)
    if at is None:
        raise OddMessageError
    return _table_at(data, at)


def _scalar(data: bytes, table: int, field: int, form: str) -> int:
    at = _place(data, table, field)
    value: int = 0 if at is None else struct.unpack_from(form, data, at)[0]
    return value


MOST_ROWS = 5_000_000
MOST_CELLS = 100_000_000
"""Limit on rows times columns read: a repeated value may be packed into almost no bytes."""

MOST_BYTES = 1_000_000_000
"""Limit on the unpacked bytes of the columns that are read."""

LONGEST_TEXT = 200

PARQUET_MARK, FEATHER_MARK = b"PAR1", b"ARROW1"
_FIRST_FEATHER = b"FEA1"
_STREAM_MARK = b"\xff\xff\xff\xff"
"""The mark at the start of every message; a stream's first message is its schema."""

_HEADER_BYTES = 8


class OddColumnError(Exception):
    """A column is not of its kind; ``row`` is the first wrong one, counted from 1."""

    def __init__(self, why: str, row: int | None = None) -> None:
        self.why, self.row = why, row


@dataclass(frozen=True, eq=False, slots=True)
class ArrowTable:
    """Columns of a file by name, none with missing values; numbers are below ``LARGEST``."""

    path: Path
    form: FileFormat
    rows: int
    numbers: Mapping[str, NDArray[float64]]
    whole: Mapping[str, NDArray[int64]]
    texts: Mapping[str, Texts]

    def refused(self, row: int, why: str, expected: str = "") -> RulecError:
        """The error (R0610) for a row, counted from 1."""
        return self.form.refused(self.path, why, row + 1, expected=expected)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """The columns to read, by their kind; those in ``optional`` may be missing."""

    numbers: tuple[str, ...] = ()
    whole: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    optional: frozenset[str] = frozenset()

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all columns to read."""
        return (*self.numbers, *self.whole, *self.texts)


def read_table(path: Path, form: FileFormat, wanted: Wanted) -> ArrowTable:
    """Read columns of a Parquet or Feather file.

    Raises RulecError R0610 for a file that is not of this format, is damaged or too large, or lacks
    a column, R0701 if it cannot be opened, R0706 without pyarrow.
    """
    arrow, _ = arrow_modules(str(path), f"`{path.name}`")
    data = form.content(path)
    try:
        table = _read(arrow, data, path, form, wanted)
        table.validate(full=True)
        table = table.combine_chunks()
        columns: dict[str, Any] = {name: table.column(name) for name in table.column_names}

        def read(names: Iterable[str], reader: Callable[[str, Any, Any], Any]) -> dict[str, Any]:
            return {name: reader(name, columns[name], arrow) for name in names if name in columns}

        return ArrowTable(
            path=path,
            form=form,
            rows=table.num_rows,
            numbers=read(wanted.numbers, _numbers),
            whole=read(wanted.whole, _whole),
            texts=read(wanted.texts, _texts),
        )
    except OddMessageError:
        raise form.refused(path, "it is damaged (its sizes contradict each other)") from None
    except OddColumnError as reason:
        raise form.refused(path, reason.why, reason.row) from None
    except (arrow.ArrowException, OSError, ValueError, KeyError, MemoryError) as reason:
        words = short(str(reason).partition(".")[0].partition("\n")[0])
        raise form.refused(path, f"it is damaged ({words})") from None


def _read(arrow: Any, data: bytes, path: Path, form: FileFormat, wanted: Wanted) -> Any:
    if data.startswith(FEATHER_MARK):
        return _feather(arrow, data, path, form, wanted)
    if data.startswith(PARQUET_MARK):
        return _parquet(arrow, data, path, form, wanted)
    if data.startswith(_FIRST_FEATHER):
        raise form.refused(path, "it is of Feather's first version", help_text="write it anew")
    if data.startswith(_STREAM_MARK):
        why = "it is a stream of Arrow's, not a file of Arrow's"
        way_out = "write it with `pyarrow.ipc.new_file`, or as Feather, instead of `new_stream`"
        raise form.refused(path, why, help_text=way_out)
    raise form.refused(path, "it is neither Parquet nor Feather" if data else "it is empty")


def _feather(arrow: Any, data: bytes, path: Path, form: FileFormat, wanted: Wanted) -> Any:
    # The messages one after the other, without the table of contents, which could point anywhere
    messages = arrow.py_buffer(data).slice(_HEADER_BYTES)
    rows = unpacked = 0
    for message in arrow.ipc.MessageReader.open_stream(messages):
        body = memoryview(b"" if message.body is None else message.body)
        size = batch_size(message.metadata.to_pybytes(), body)
        rows, unpacked = rows + size.rows, unpacked + size.unpacked_bytes
        if size.rows < 0 or rows > MOST_ROWS or unpacked > MOST_BYTES:
            raise _too_much(path, form, rows)
    with arrow.ipc.open_stream(messages) as reader:
        columns = _present(reader.schema.names, path, form, wanted)
        table = reader.read_all()
    return table.select(columns)


def _parquet(arrow: Any, data: bytes, path: Path, form: FileFormat, wanted: Wanted) -> Any:
    plain = arrow.parquet.ParquetFile(arrow.BufferReader(data))
    columns = _present(plain.schema_arrow.names, path, form, wanted)
    # Texts as numbers in a dictionary: each may be there a million times
    texts = [name for name in wanted.texts if name in columns]
    source = arrow.parquet.ParquetFile(arrow.BufferReader(data), read_dictionary=texts)
    about = source.metadata
    # Not the metadata of single columns: broken statistics there would crash the process
    groups = range(about.num_row_groups)
    unpacked = sum(abs(about.row_group(number).total_byte_size) for number in groups)
    is_fit = 0 <= about.num_rows <= MOST_ROWS and about.num_rows * len(columns) <= MOST_CELLS
    if not is_fit or unpacked > MOST_BYTES:
        raise _too_much(path, form, about.num_rows)
    batches, rows = [], 0
    for batch in source.iter_batches(columns=columns, use_threads=False):
        rows += batch.num_rows
        if rows > MOST_ROWS or rows * len(columns) > MOST_CELLS:
            raise _too_much(path, form, rows)
        batches.append(batch)
    if not batches:
        return plain.schema_arrow.empty_table().select(columns)
    return arrow.Table.from_batches(batches)


def _too_much(path: Path, form: FileFormat, rows: int) -> RulecError:
    why = f"its table of {rows:,} rows is too large"
    expected = f"{MOST_ROWS:,} rows at most, {MOST_CELLS:,} cells and {MOST_BYTES:,} bytes"
    return form.refused(path, why, expected=f"expected {expected}")


def _present(names: Iterable[str], path: Path, form: FileFormat, wanted: Wanted) -> list[str]:
    known = list(names)
    doubled = sorted({name for name in known if known.count(name) > 1 and name in wanted.names})
    if doubled:
        raise form.refused(path, f"it has two columns `{doubled[0]}`")
    missing = [x for x in wanted.names if x not in known and x not in wanted.optional]
    if missing:
        raise form.refused(path, f"it has no column `{missing[0]}`")
    return [name for name in wanted.names if name in known]


def _check(name: str, column: Any, is_of_kind: bool) -> None:
    """Refuse a column of another type, or with a missing value."""
    if not is_of_kind:
        raise OddColumnError(f"its column `{name}` is of type {short(str(column.type))}")
    if column.null_count:
        row = int(np.argmax(column.is_null().to_numpy())) + 1
        raise OddColumnError(f"`{name}` has no value", row)


def _numbers(name: str, column: Any, arrow: Any) -> NDArray[float64]:
    types = arrow.types
    _check(name, column, types.is_floating(column.type) or types.is_integer(column.type))
    values = np.asarray(column.to_numpy(), dtype=float)
    odd = ~(np.abs(values) < LARGEST)
    if odd.any():
        row = int(np.argmax(odd))
        raise OddColumnError(f"`{name}` is {values[row]:g}", row + 1)
    return values


def _whole(name: str, column: Any, arrow: Any) -> NDArray[int64]:
    _check(name, column, arrow.types.is_integer(column.type))
    values: NDArray[int64] = column.cast(arrow.int64()).to_numpy()
    return values


def _texts(name: str, column: Any, arrow: Any) -> Texts:
    kind = column.type.value_type if arrow.types.is_dictionary(column.type) else column.type
    _check(name, column, arrow.types.is_string(kind) or arrow.types.is_large_string(kind))
    codes, known = arrays.codes_in(arrays.whole_array(column))
    if (codes < 0).any():
        raise OddColumnError(f"`{name}` has no value")
    values = tuple([value or "" for value in known])
    if max(map(len, values), default=0) > LONGEST_TEXT:
        raise OddColumnError(f"a text in `{name}` is longer than {LONGEST_TEXT} characters")
    return Texts(codes.astype(int64), values)

"""Traces as Parquet, with the same columns as in CSV."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import missing_package
from rulec.files.read_files import opened
from rulec.trace.formats import arrow as arrays
from rulec.trace.formats.stream_lines import packed
from rulec.trace.formats.table_reader import (
    TOLD,
    UNKNOWN_NAMES,
    Cell,
    Table,
    check_columns,
    problem,
)
from rulec.trace.trace_messages import PARQUET_UNAVAILABLE
from rulec.trace.trace_model import Trace

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rulec.trace.formats.arrow.arrow_blocks import Piece

_ROWS_AT_ONCE = 1 << 17

LARGEST_GROUP, _LARGE_CELL = 1 << 26, 1 << 10
"""Bytes that a row group may have unpacked, plus bytes per cell."""

_MARK = b"PAR1"
"""The first and last bytes of a Parquet file."""

_AGAIN = "write or copy the file again"
_GLANCE = 64

Refused = Callable[..., RulecError]


def read_parquet(stream: IO[bytes], file: str) -> Iterator[Sequence[Trace | RulecError]]:
    """Read the traces of a Parquet file, or why they are bad (R0509).

    Raises RulecError R0706 if pyarrow is missing, or if the stream is a pipe.
    """
    if not stream.seekable():
        message = "Parquet has its table of contents at the end, so it cannot be read from a pipe"
        way_out = "give a file, or write JSON Lines into the pipe"
        raise PARQUET_UNAVAILABLE.error(SourceLocation(file), message, help=way_out)
    pyarrow, parquet = arrow(file)
    refused = _no_parquet(stream, file)
    if refused is not None:
        yield [refused]
        return
    start = stream.tell()
    try:
        source = parquet.ParquetFile(stream)
        schema = source.schema_arrow
        check_columns(schema.names, SourceLocation(file))
        check_types(schema, pyarrow, file)
        _check_sizes(source.metadata, file)
        stream.seek(start)
        # Texts repeat; read as dictionary codes, they need not be compared.
        source = parquet.ParquetFile(stream, read_dictionary=_texts(schema, pyarrow))
    except RulecError as error:
        yield [error]
        return
    except UnicodeDecodeError:
        yield [_no_utf8("a column has a name", SourceLocation(file))]
        return
    except (pyarrow.ArrowException, OSError, ValueError) as reason:
        yield [_unreadable("the file", reason, file)]
        return
    table = Table(tuple(schema.names), lambda value: value, lambda row: SourceLocation(file, row))
    problems = (pyarrow.ArrowException, OSError, ValueError)
    yield from arrays.cut(_pieces(source, problems, file), table, 1, SourceLocation(file))


def _check_sizes(metadata: Any, file: str) -> None:
    """Refuse row groups that unpack from a few bytes to gigabytes: they are decoded as a whole."""
    for group in (metadata.row_group(number) for number in range(metadata.num_row_groups)):
        # Not the sizes of single columns: damaged statistics in them would crash the process
        size = abs(group.total_byte_size)
        if size > LARGEST_GROUP + _LARGE_CELL * group.num_rows * group.num_columns:
            message = f"{group.num_rows:,} rows in one group have {size:,} bytes unpacked"
            way_out = f"for {group.num_columns} columns that is too much: no cell is that long"
            raise problem(message, SourceLocation(file), way_out)


def _texts(schema: Any, pyarrow: Any) -> list[str]:
    return [field.name for field in schema if pyarrow.types.is_string(field.type)]


def _pieces(
    source: Any, problems: tuple[type[Exception], ...], file: str
) -> Iterator[Piece | RulecError]:
    number = 0
    try:
        for batch in source.iter_batches(_ROWS_AT_ONCE):
            invalid = _first_no_text(batch)
            if invalid is not None:
                row, column = invalid
                yield _rows_before(row, batch)
                yield _no_utf8(
                    f"the column `{column}` has a text here", SourceLocation(file, number + row + 1)
                )
                return
            yield arrays.with_plain_texts(batch)
            number += len(batch)
    except problems as reason:
        yield _unreadable(f"after row {number} the file", reason, file)


def _first_no_text(batch: Any) -> tuple[int, str] | None:
    """The first row, from 0, with a text that is not UTF-8, and its column; None without one."""
    columns = zip(batch.schema.names, batch.columns, strict=True)
    wrong = [(_first_that_fails(column), name) for name, column in columns if not is_valid(column)]
    return min(wrong, default=None)


def is_valid(column: Any) -> bool:
    """Whether Arrow finds a column valid; it is not if, for example, a text is not UTF-8."""
    try:
        column.validate(full=True)
    except ValueError:  # Arrow's error is one
        return False
    return True


def _first_that_fails(column: Any) -> int:
    """The first row whose text cannot be decoded; 0 if such a text is only in a dictionary."""
    first, last = 0, len(column)
    while first < last:
        middle = (first + last) // 2
        try:
            column.slice(first, middle - first + 1).to_pylist()
            first = middle + 1
        except UnicodeDecodeError:
            last = middle
    return first if first < len(column) else 0


def _rows_before(row: int, batch: Any) -> Any:
    """The rows before ``row``, without dictionary entries that only other rows use."""
    columns = [
        # Encoding anew drops the entries of other rows.
        column.dictionary_decode().dictionary_encode() if hasattr(column, "indices") else column
        for column in batch.slice(0, row).columns
    ]
    return type(batch).from_arrays(columns, schema=batch.schema)


def _no_utf8(content: str, place: SourceLocation) -> RulecError:
    return problem(f"{content} that is not UTF-8", place, "write the file's texts in UTF-8")


def _no_parquet(stream: IO[bytes], file: str) -> RulecError | None:
    start = stream.tell()
    head = stream.read(100)
    beginning = head[: len(_MARK)]
    size = stream.seek(0, io.SEEK_END) - start
    stream.seek(max(start, start + size - len(_MARK)))
    end = stream.read()
    stream.seek(start)
    refusal = "the file cannot be read as Parquet"
    if not size:
        return problem(f"{refusal}: it is empty", SourceLocation(file), _AGAIN)
    if beginning != _MARK:
        result = packed(head)
        if result is not None:
            return problem(
                f"this is not Parquet but {result.noun}", SourceLocation(file), result.help
            )
        way_out = "if it is CSV, call it `.csv`; else name its format with `--input-format`"
        return problem(f"{refusal}: it does not begin with `PAR1`", SourceLocation(file), way_out)
    if end != _MARK or size == len(_MARK):
        why = "its table of contents, which comes last, is missing; it has been cut short"
        return problem(f"{refusal}: {why}", SourceLocation(file), _AGAIN)
    return None


def _unreadable(part: str, reason: Exception, file: str) -> RulecError:
    words = str(reason).split(".")[0]
    return problem(
        f"{part} cannot be read as Parquet: it is damaged ({words})", SourceLocation(file), _AGAIN
    )


def check_types(schema: Any, pyarrow: Any, file: str) -> None:
    """Check (R0509) that every column has a type that values can have."""
    types = pyarrow.types
    for name, kind in zip(schema.names, schema.types, strict=True):
        value = kind.value_type if types.is_dictionary(kind) else kind
        known = ("boolean", "integer", "float64", "string", "large_string", "string_view", "null")
        if name in (TOLD, UNKNOWN_NAMES) and (types.is_list(kind) or types.is_large_list(kind)):
            value = kind.value_type
        if not any(getattr(types, f"is_{type_name}")(value) for type_name in known):
            message = (
                f"the column `{name}` is of type {kind}; it can be bool, integer, double (float64) "
                "or string"
            )
            raise problem(message, SourceLocation(file), "write it anew with such a column")


def rows_of_columns(path: Path, columns: Sequence[str]) -> Iterator[Mapping[str, Any]]:
    """The rows of any Parquet file, with those of ``columns`` that it has.

    Pages are compared with their checksums, if the file has some. Raises RulecError R0509 if it
    cannot be read, R0701, R0706.
    """
    pyarrow, parquet = arrow(str(path))
    with opened(path) as stream:
        refused = _no_parquet(stream, str(path))
        if refused is not None:
            raise refused
        try:
            source = parquet.ParquetFile(stream, page_checksum_verification=True)
            names = [name for name in source.schema_arrow.names if name in columns]
            for batch in source.iter_batches(_ROWS_AT_ONCE, columns=names):
                yield from batch.to_pylist()
        except (pyarrow.ArrowException, OSError, ValueError) as reason:
            raise _unreadable("the file", reason, str(path)) from None


def parquet_names(path: Path, refused: Refused) -> tuple[str, ...]:
    """The names of a file's columns.

    Raises RulecError R0706 if pyarrow is missing, R0701 if the file cannot be opened, and otherwise
    the error that ``refused`` makes of the reason.
    """
    with opened(path) as stream:
        start = stream.read(_GLANCE)
        if start and not start.startswith(_MARK) and start.isascii() and b"\0" not in start:
            way_out = "if it is CSV, call it `.csv`"
            raise refused("it is not Parquet but text", help_text=way_out)
    pyarrow, parquet = arrow(str(path))
    with opened(path) as stream:
        try:
            return tuple(parquet.ParquetFile(stream).schema_arrow.names)
        except (pyarrow.ArrowException, OSError, ValueError) as reason:
            # Column names that are not UTF-8 raise a ValueError
            raise refused(f"it is not Parquet ({_first(reason)})") from None


def parquet_columns(
    path: Path, names: Sequence[str], refused: Refused, most_rows: int
) -> dict[str, NDArray[Any]]:
    """The named columns of a file, as arrays. Raises RulecError as ``parquet_names`` does."""
    pyarrow, parquet = arrow(str(path))
    with opened(path) as stream:
        try:
            source = parquet.ParquetFile(stream)
            if source.metadata.num_rows > most_rows:
                raise refused(f"it has more than {most_rows:,} rows")
            table = source.read(columns=list(names))
            return {name: table.column(name).to_numpy() for name in names}
        except (pyarrow.ArrowException, OSError, ValueError, TypeError) as reason:
            raise refused(f"it is damaged Parquet ({_first(reason)})") from None


def _first(reason: Exception) -> str:
    return str(reason).split("\n")[0].split(".")[0][:120]


def write_parquet(
    rows: Iterable[Sequence[Cell]],
    types: Sequence[tuple[str, type]],
    stream: IO[bytes],
    file: str,
) -> None:
    """Write a table; ``types`` are the columns' names and types. Raises RulecError R0706."""
    pyarrow, parquet = arrow(file)
    texts = pyarrow.list_(pyarrow.string())
    kinds = {bool: "bool", int: "int64", float: "float64", str: "string", list: texts}
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in types])
    waiting = iter(rows)
    with parquet.ParquetWriter(stream, schema) as writer:
        while chunk := list(islice(waiting, _ROWS_AT_ONCE)):
            columns = zip(zip(*chunk, strict=True), schema.types, strict=True)
            arrays = [pyarrow.array(column, kind) for column, kind in columns]
            writer.write_batch(pyarrow.record_batch(arrays, schema=schema))


def arrow(file: str, task: str = "Parquet") -> tuple[Any, Any]:
    """The modules ``pyarrow`` and ``pyarrow.parquet``, which a task requires.

    Raises RulecError R0706 if they are missing.
    """
    try:
        import pyarrow.parquet  # an extra, and 0.1 s
    except ImportError:
        place = SourceLocation(file)
        raise missing_package(PARQUET_UNAVAILABLE, task, "pyarrow", "parquet", place) from None
    return pyarrow, pyarrow.parquet

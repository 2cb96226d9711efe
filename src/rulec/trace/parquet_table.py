"""Traces as Parquet: the same table as in CSV, its columns of one type each.

The only file that knows pyarrow, which is installed on request.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import IO, Any

from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.trace.model import Trace, Value
from rulec.trace.rows import Row, Table, check_columns, problem, traces_in

_ROWS_AT_ONCE = 1 << 15


def read_parquet(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    """The traces of a Parquet file; in place of a bad one the RulecError (R0509) that says why.

    Raises:
        RulecError: R0706 if pyarrow is missing, or the stream is a pipe.
    """
    if not stream.seekable():
        message = "Parquet has its table of contents at the end, so it cannot be read from a pipe"
        raise _unavailable(message, file, "give a file, or write JSON Lines into the pipe")
    pyarrow, parquet = _pyarrow(file)
    try:
        source = parquet.ParquetFile(stream)
        schema = source.schema_arrow
        check_columns(schema.names, Place(file))
        _check_types(schema, pyarrow, file)
    except RulecError as error:
        yield error
        return
    except (pyarrow.ArrowException, OSError) as reason:
        yield _unreadable("the file", reason, file)
        return
    table = Table(tuple(schema.names), lambda value: value, lambda row: Place(file, row))
    problems = (pyarrow.ArrowException, OSError)
    yield from traces_in(_rows(source, problems, file), table, Place(file))


def _rows(source: Any, problems: tuple[type[Exception], ...], file: str) -> Iterator[Row]:
    """The rows, counted from 1. Raises RulecError R0509."""
    number = 0
    try:
        for batch in source.iter_batches(_ROWS_AT_ONCE):
            columns = [column.to_pylist() for column in batch.columns]
            for cells in zip(*columns, strict=True):
                number += 1
                yield number, cells
    except problems as reason:
        raise _unreadable(f"after row {number} the file", reason, file) from None


def _unreadable(what: str, reason: Exception, file: str) -> RulecError:
    words = str(reason).split(".")[0]
    return problem(f"{what} cannot be read as Parquet: {words}", Place(file))


def _check_types(schema: Any, pyarrow: Any, file: str) -> None:
    types = pyarrow.types
    for name, kind in zip(schema.names, schema.types, strict=True):
        value = kind.value_type if types.is_dictionary(kind) else kind
        tests = (
            types.is_boolean,
            types.is_integer,
            types.is_float64,
            types.is_string,
            types.is_large_string,
            types.is_null,
        )
        if not any(test(value) for test in tests):
            message = f"the column `{name}` is of type {kind}"
            help_text = "types are bool, integers, double (float64), and string"
            raise problem(message, Place(file), help_text)


def write_parquet(
    rows: Iterable[Sequence[Value | None]],
    types: Sequence[tuple[str, type]],
    stream: IO[bytes],
    file: str,
) -> None:
    """Write a table; ``types`` are its columns' names, each with the type of its cells.

    Each is ``bool``, ``int``, ``float`` or ``str``. Raises RulecError R0706 without pyarrow.
    """
    pyarrow, parquet = _pyarrow(file)
    kinds = {
        bool: pyarrow.bool_(),
        int: pyarrow.int64(),
        float: pyarrow.float64(),
        str: pyarrow.string(),
    }
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in types])
    waiting = iter(rows)
    with parquet.ParquetWriter(stream, schema) as writer:
        while chunk := list(islice(waiting, _ROWS_AT_ONCE)):
            arrays = [
                pyarrow.array(column, field.type)
                for column, field in zip(zip(*chunk, strict=True), schema, strict=True)
            ]
            writer.write_batch(pyarrow.record_batch(arrays, schema=schema))


def _pyarrow(file: str) -> tuple[Any, Any]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        message = "Parquet takes the package `pyarrow`, which is not installed"
        raise _unavailable(message, file, "`pip install 'rulec[parquet]'`") from None
    return pyarrow, parquet


def _unavailable(message: str, file: str, help_text: str) -> RulecError:
    return RulecError(Diagnostic("R0706", message, Place(file), help=help_text))

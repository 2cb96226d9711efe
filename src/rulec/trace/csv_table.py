"""Traces as CSV: rows of cells separated by commas, the columns' names first."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import IO, Any

from rulec.diagnostics import Place, RulecError
from rulec.trace.model import Trace, Value
from rulec.trace.rows import Row, Table, check_columns, problem, traces_in

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_BOOLEANS = {"true": True, "false": False}


def read_csv(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    """The traces of a CSV file; in place of a bad one the RulecError (R0509) that says why."""
    text = io.TextIOWrapper(stream, "utf-8-sig", newline="")
    try:
        yield from _traces(csv.reader(text, strict=True), file)
    finally:
        text.detach()  # the stream is its owner's


def _traces(lines: Any, file: str) -> Iterator[Trace | RulecError]:
    """Those of a reader of the csv module, which knows the number of its line."""
    found = _rows(lines, file)
    try:
        number, columns = next(found, (0, []))
        if columns:
            check_columns(columns, Place(file, number))
    except RulecError as error:
        yield error
        return
    table = Table(tuple(columns), _value, lambda line: Place(file, line))
    yield from traces_in(found, table, Place(file))


def _rows(lines: Any, file: str) -> Iterator[Row]:
    """The rows, the columns' names among them. Raises RulecError R0509."""
    number = 0
    try:
        for cells in lines:
            if cells:
                yield number + 1, cells
            number = lines.line_num
    except (csv.Error, UnicodeDecodeError) as reason:
        words = "it is not in UTF-8" if isinstance(reason, UnicodeDecodeError) else str(reason)
        message = f"from here on the file cannot be read as CSV: {words}"
        raise problem(message, Place(file, number + 1)) from None


def _value(cell: str) -> Value:
    truth = _BOOLEANS.get(cell)
    if truth is not None:
        return truth
    return float(cell) if _NUMBER.fullmatch(cell) else cell


def write_csv(
    rows: Iterable[Sequence[Value | None]], columns: Sequence[str], stream: IO[bytes]
) -> None:
    """Write a table: its columns' names, then its rows."""
    text = io.TextIOWrapper(stream, "utf-8", newline="")
    try:
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(columns)
        for row in rows:
            lines.writerow([_cell(value) for value in row])
    finally:
        text.detach()  # which writes what is left


def _cell(value: Value | None) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case float():
            return float.__repr__(value)
        case _:
            return str(value)

"""Traces as CSV: a line of column names, then rows of cells."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib.util import find_spec
from typing import IO, cast

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats import table_reader as tables
from rulec.trace.formats.stream_lines import foreign, not_utf8, placed
from rulec.trace.trace_model import Trace
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue
from rulec.vocabulary.written_numbers import WrittenNumber, number_written

LARGE_BYTES = 1 << 19
"""Reading the rows of a smaller file takes less time than loading Arrow."""

_LONGEST_HEAD_BYTES = 1 << 16

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_WORDS_OF_VALUES: dict[str, PartialValue] = {"true": True, "false": False, "?": UNKNOWN}


def read_csv(stream: IO[bytes], file: str) -> Iterator[Sequence[Trace | RulecError]]:
    """Read the traces of a CSV file, or why they are bad (R0509).

    A large file is read in blocks if Arrow is installed.
    """
    error = _no_table(stream, file)
    if error is not None:
        yield [error]
        return
    columns = _columns_if_large(stream)
    if columns is None:
        yield from tables.in_chunks(_traces(stream, file))
        return
    plain = arrow_tables.pieces(stream, columns, 2, lambda rest, number: _rows(rest, number, file))
    yield from arrow_tables.cut(plain, _table(columns, file), 2, SourceLocation(file))


def _no_table(stream: IO[bytes], file: str) -> RulecError | None:
    if stream.seekable():
        beginning = stream.read(_LONGEST_HEAD_BYTES)
        stream.seek(-len(beginning), io.SEEK_CUR)
    else:
        beginning = cast("io.BufferedReader", stream).peek()
    result = foreign(beginning)
    if result is not None:
        return tables.problem(
            f"this is not CSV but {result.noun}", SourceLocation(file), result.help
        )
    if beginning.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"["):
        return tables.problem(
            "this is not CSV but JSON", SourceLocation(file), "add `--input-format jsonl`"
        )
    return None


def _columns_if_large(stream: IO[bytes]) -> list[str] | None:
    """The columns of a large plain file, of which the first line is consumed; None for others."""
    if not stream.seekable() or find_spec("pyarrow") is None:
        return None
    start = stream.tell()
    size = stream.seek(0, io.SEEK_END) - start
    stream.seek(start)
    if size >= LARGE_BYTES:
        line = stream.readline(_LONGEST_HEAD_BYTES).removeprefix(b"\xef\xbb\xbf")
        with suppress(UnicodeDecodeError, RulecError, csv.Error, StopIteration):
            columns = next(csv.reader([line.decode().rstrip("\r\n")], strict=True))
            tables.check_columns(columns, SourceLocation(""))
            if line.endswith(b"\n") and not re.search(rb"\0|\r(?!\n)", line):
                return columns
        stream.seek(start)
    return None


def _traces(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    rows = _rows(stream, 1, file)
    try:
        number, columns = next(rows, (0, []))
        if columns:
            _check_separator(columns, SourceLocation(file, number))
            tables.check_columns(columns, SourceLocation(file, number))
    except RulecError as error:
        yield error
        return
    yield from tables.traces_in(rows, _table(columns, file), SourceLocation(file))


def _check_separator(columns: Sequence[str], place: SourceLocation) -> None:
    for name, mark in (("semicolons", ";"), ("tabs", "\t"), ("bars", "|")):
        if len(columns) == 1 and mark in columns[0]:
            message = f"the columns' names are separated by {name}"
            raise tables.problem(
                message, place, "separate the cells by commas, and decimals by points"
            )


def _table(columns: Sequence[str], file: str) -> tables.Table:
    return tables.Table(
        tuple(columns), _value, lambda line: SourceLocation(file, line), has_texts=True
    )


def _rows(stream: IO[bytes], number: int, file: str) -> Iterator[tables.Row]:
    """Rows from line ``number`` on; line 1 is the header. Raises RulecError R0509."""
    text = io.TextIOWrapper(stream, "utf-8-sig" if number == 1 else "utf-8", newline="")
    arriving = _Lines(text)
    lines = csv.reader(arriving, strict=True)
    before = number - 1
    try:
        for cells in lines:
            arriving.row = 0
            if cells:
                yield number, cells
            number = before + lines.line_num + 1
    except UnicodeDecodeError as reason:
        raise _not_utf8(stream, SourceLocation(file, number), reason) from None
    except csv.Error as reason:
        words = next((ours for theirs, ours in _WORDS.items() if theirs in str(reason)), reason)
        message = f"from here on the file cannot be read as CSV: {words}"
        raise tables.problem(message, SourceLocation(file, number), _QUOTES) from None
    finally:
        with suppress(ValueError):  # the caller may have closed the stream already
            text.detach()  # the caller owns the stream: do not close it


_WORDS = {
    "unexpected end of data": "it ends within quotes that begin here",
    "field larger than field limit": f"a cell has more than {csv.field_size_limit():,} characters",
    "expected after": "closing quotes are followed by neither a comma nor the line's end",
    "NUL": "it holds a null character",
    "row": f"a row has more than {tables.LONGEST_ROW:,} characters",
}
_QUOTES = "a quoted cell ends with quotes; are they missing, or has the file been cut short?"


@dataclass(slots=True)
class _Lines(Iterator[str]):
    """Lines of a text; ``row`` counts the characters of the current row, which may have several."""

    text: io.TextIOWrapper
    row: int = 0

    def __next__(self) -> str:
        line = self.text.readline(tables.LONGEST_ROW + 1)
        if not line:
            raise StopIteration
        if "\0" in line:
            raise csv.Error("NUL")
        self.row += len(line)
        if self.row > tables.LONGEST_ROW:
            raise csv.Error("row")
        return line


def _not_utf8(stream: IO[bytes], place: SourceLocation, reason: UnicodeDecodeError) -> RulecError:
    """Error for the first byte that is not UTF-8; its place is only approximate in a pipe."""
    byte, where = reason.object[reason.start], "here or further on "
    if stream.seekable():
        stream.seek(0)
        for number, line in enumerate(stream, 1):
            at = not_utf8(line)
            if at is not None:
                byte, where = line[at], ""
                place = placed(SourceLocation(place.file, number), line.rstrip(b"\n"), at)
                break
    message = f"{where}the byte 0x{byte:02x} is not UTF-8"
    return tables.problem(message, place, "save the file in UTF-8")


def _value(cell: str) -> PartialValue:
    if cell in _WORDS_OF_VALUES:
        return _WORDS_OF_VALUES[cell]
    return number_written(cell) if _NUMBER.fullmatch(cell) else cell


def write_csv(
    rows: Iterable[Sequence[tables.Cell]], columns: Sequence[str], stream: IO[bytes]
) -> None:
    """Write a table: its column names, then its rows."""
    text = io.TextIOWrapper(stream, "utf-8", newline="")
    try:
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(columns)
        for row in rows:
            lines.writerow([_cell(value) for value in row])
    finally:
        text.detach()  # also flushes


def _cell(value: tables.Cell) -> str:
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case WrittenNumber():
            return str(value)
        case float():
            return float.__repr__(value)
        case list():
            return " ".join(value) or " "  # an empty cell would mean that no list is given
        case _ if value is UNKNOWN:
            return UNKNOWN.value
        case _:
            return str(value)

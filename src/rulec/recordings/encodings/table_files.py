"""Tables read from CSV or Parquet files, and from columns in memory."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy import int64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files.read_files import opened
from rulec.recordings.encodings.csv_head import (
    LONGEST_LINE,
    is_number,
    is_parquet,
    separator_of,
)
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.table_columns import (
    MOST_COLUMNS,
    MOST_ROWS,
    Columns,
    ColumnTable,
    Refused,
    Texts,
    checked_numbers,
)
from rulec.recordings.recording_messages import NOT_A_RECORDING
from rulec.trace.formats.arrow.parquet import parquet_columns, parquet_names
from rulec.trace.formats.stream_lines import foreign, utf16

LARGEST_NUMBER = 1e19
"""Limit on numbers: nanoseconds since 1970 have nineteen digits."""

_BEGINNING = 1000
_ROWS_AT_ONCE = 1 << 16


def open_table(path: Path, form: FileFormat, names: Sequence[str] = ()) -> ColumnTable:
    """The table in a file; ``names`` are its column names if the file has no header row.

    Raises RulecError R0610 for a file that is not a table, R0701 for one that cannot be read, R0706
    if Parquet cannot be read here.
    """
    refused = partial(form.refused, path)
    with opened(path) as file:
        beginning = file.read(_BEGINNING)
    if is_parquet(path.name, beginning):
        column_names = parquet_names(path, refused)

        def read_parquet(numbers: Sequence[str], texts: Sequence[str]) -> Columns:
            wanted = [*numbers, *texts]
            values = parquet_columns(path, wanted, refused, MOST_ROWS)
            return columns_of(values, numbers, texts, refused)

        return ColumnTable(_checked_names(column_names, refused), refused, read_parquet)
    if utf16(beginning):
        raise _foreign(beginning, refused)
    with _lines(path, form, refused) as stream:
        head = stream.readline(LONGEST_LINE)
    if not head.strip():
        raise refused("it is empty" if not head else "its first line is empty", 1)
    mark = separator_of(head)
    first = _cells(head, mark, refused)
    given = tuple(names) or _checked_names(tuple(first), refused)

    def read_csv(numbers: Sequence[str], texts: Sequence[str]) -> Columns:
        with _lines(path, form, refused) as stream:
            if not names:
                stream.readline(LONGEST_LINE)
            by_blanks = mark == " "
            rows = map(str.split, stream) if by_blanks else csv.reader(stream, delimiter=mark)
            return _read(rows, given, (numbers, texts), refused, 1 if names else 2)

    return ColumnTable(given, refused, read_csv)


def _cells(head: str, mark: str, refused: Any) -> list[str]:
    try:
        return next(csv.reader([head], delimiter=mark)) if mark != " " else head.split()
    except csv.Error as reason:
        raise refused(f"its first line is no list of names ({reason})", 1) from None


def _checked_names(names: tuple[str, ...], refused: Any) -> tuple[str, ...]:
    if len(names) > MOST_COLUMNS:
        raise refused(f"it has {len(names):,} columns, more than {MOST_COLUMNS:,}", 1)
    kept = [name for name in names if name]
    twice = next((name for name in kept if kept.count(name) > 1), None)
    if twice is not None:
        raise refused(f"it has two columns `{short(twice)}`", 1)
    return names


@contextmanager
def _lines(path: Path, form: FileFormat, refused: Any) -> Iterator[io.TextIOWrapper]:
    """The lines of a text file, possibly packed, read within limits."""
    with opened(path) as stream:
        bounded = io.BufferedReader(_Bounded(stream, form.largest_bytes, refused), 1 << 20)
        try:
            yield io.TextIOWrapper(bounded, encoding="utf-8-sig", newline="")
        except UnicodeDecodeError:
            stream.seek(0)
            raise _foreign(stream.read(_BEGINNING), refused) from None


def _foreign(beginning: bytes, refused: Refused) -> RulecError:
    """The error about a file that is no text in UTF-8."""
    kind = foreign(beginning)
    if kind is None:
        return refused("it is no text in UTF-8", help_text="save it in UTF-8")
    return refused(f"it is {kind.noun}", help_text=kind.help)


class _Bounded(io.RawIOBase):
    """A stream that raises an error beyond a size."""

    def __init__(self, stream: Any, most: int, refused: Any) -> None:
        self._stream, self._left, self._most, self._refused = stream, most, most, refused

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        data = self._stream.read(len(buffer))
        self._left -= len(data)
        if self._left < 0:
            raise self._refused(f"it is too large: at most {self._most:,} bytes are read")
        buffer[: len(data)] = data
        return len(data)


def _read(
    rows: Iterator[list[str]],
    names: Sequence[str],
    wanted: tuple[Sequence[str], Sequence[str]],
    refused: Any,
    line: int,
) -> Columns:
    """The wanted number and text columns, read block by block."""
    numbers, texts = wanted
    at = {name: place for place, name in enumerate(names)}
    parts_of: dict[str, list[NDArray[Any]]] = {name: [] for name in (*numbers, *texts)}
    codes: dict[str, dict[str, int]] = {name: {} for name in texts}
    lines: list[NDArray[int64]] = []
    count = 0
    while True:
        try:
            block = list(islice(rows, _ROWS_AT_ONCE))
        except csv.Error as reason:
            raise refused(f"after line {line:,} it is no CSV ({reason})", line) from None
        if not block:
            break
        own = np.arange(line, line + len(block))
        line += len(block)
        if not all(block):
            own = own[[bool(row) for row in block]]
            block = [row for row in block if row]
        count += len(block)
        if count > MOST_ROWS:
            raise refused(f"it has more than {MOST_ROWS:,} rows", line)
        _check_lengths(block, names, own, refused, is_last=len(own) < _ROWS_AT_ONCE)
        cells = list(zip(*block, strict=True))
        lines.append(own)
        for name in numbers if block else ():
            values, bad = checked_numbers(cells[at[name]], LARGEST_NUMBER)
            if bad is not None:
                raise _no_number(name, cells[at[name]][bad], int(own[bad]), refused)
            parts_of[name].append(values)
        for name in texts if block else ():
            known = codes[name]
            column = (known.setdefault(cell, len(known)) for cell in cells[at[name]])
            parts_of[name].append(np.fromiter(column, int64, len(block)))
    if not count:
        raise refused("it has a head, but no rows", line)
    whole = {name: np.concatenate(parts) for name, parts in parts_of.items()}
    return Columns(
        refused,
        {name: whole[name] for name in numbers},
        {name: _stripped(whole[name], codes[name]) for name in texts},
        np.concatenate(lines),
    )


def _check_lengths(
    block: Sequence[Sequence[str]],
    names: Sequence[str],
    lines: NDArray[int64],
    refused: Any,
    *,
    is_last: bool,
) -> None:
    if set(map(len, block)) <= {len(names)}:
        return
    at = next(place for place, row in enumerate(block) if len(row) != len(names))
    n_cells = f"{len(block[at])} {'cell' if len(block[at]) == 1 else 'cells'}"
    why = f"its row has {n_cells}, its head {len(names)} names"
    if is_last and at == len(block) - 1 and len(block[at]) < len(names):
        why = f"it seems to be cut short: its last row has {n_cells}, its head {len(names)} names"
        way_out = "write or copy the file again; or take out its last row"
        raise refused(why, int(lines[at]), help_text=way_out)
    raise refused(why, int(lines[at]), help_text="cells with commas in them go in quotes")


def _no_number(name: str, cell: str, line: int, refused: Any) -> RulecError:
    why = f"its column `{short(name)}` holds `{short(cell)}`"
    is_large = is_number(cell)
    expected = f"expected a number below {LARGEST_NUMBER:.0e}" if is_large else "expected a number"
    way_out = "leave the row out, or write the number that is meant" if is_large else ""
    way_out = next((text for kind, text in _WAYS_OUT if kind.fullmatch(cell)), way_out)
    error: RulecError = refused(why, line, expected=expected, help_text=way_out)
    return error


_WAYS_OUT = (
    (re.compile(r"[0-9,]+"), "write decimal points, not commas"),
    (
        re.compile(r"(?i)true|false|yes|no"),
        "write 1 for true, 0 for false; or `true` and `false` in all of the column",
    ),
    (
        re.compile(r"\d{4}-\d\d-\d\d.*|\d+:\d\d.*"),
        "write seconds, such as 0.1, from any moment on: `(t - t.min()).dt.total_seconds()`",
    ),
    (
        re.compile(r"-?\d+ days.*"),
        "write seconds, such as 0.1, as pandas' `t.dt.total_seconds()` gives them",
    ),
)
"""Pattern of a text found instead of a number, and advice on what to write."""


def _stripped(codes: NDArray[int64], known: Mapping[str, int]) -> Texts:
    """The texts without surrounding blanks; equal texts get the same code.

    If all are whole numbers with a decimal, as pandas writes ids in a column with gaps, the decimal
    is dropped.
    """
    names: dict[str, int] = {}
    stripped = [name.strip() for name in known]
    if all(name.endswith(".0") and name[:-2].isdecimal() for name in stripped if name):
        stripped = [name[:-2] for name in stripped]
    again = [names.setdefault(name, len(names)) for name in stripped]
    return Texts(np.array(again, dtype=int64)[codes], tuple(names))


_EXPECTED = 'expected a data frame, or a dict of columns, such as `{"track": [1, 1], …}`'


def table_of(columns: Mapping[str, Any], words: str) -> ColumnTable:
    """The table of columns in memory: sequences of equal length, such as a data frame's.

    ``words`` says what is read, for messages. Raises RulecError R0610.
    """

    def refused(
        why: str, place: int | None = None, *, expected: str = "", help_text: str = ""
    ) -> RulecError:
        where = "" if place is None else f"row {place}: "
        message = f"the columns cannot be read as {words}: {where}{why}"
        return NOT_A_RECORDING.error(None, message, expected=expected, help=help_text)

    given: object = columns
    if isinstance(given, str | bytes | Sequence):
        kind = type(given).__name__
        way_out = "`rulec.read_recording(path, map_path)` reads a file" if kind == "str" else ""
        raise refused(f"they are of type `{kind}`", expected=_EXPECTED, help_text=way_out)
    # polars frames and Arrow tables list their names here; a mapping yields them itself
    listed = getattr(columns, "columns", columns)
    listed = getattr(columns, "column_names", listed)
    try:
        names = _checked_names(tuple(map(str, listed)), refused)
    except TypeError:
        raise refused(f"they are of type `{type(given).__name__}`", expected=_EXPECTED) from None

    def read(numbers: Sequence[str], texts: Sequence[str]) -> Columns:
        wanted = {name: _array(name, columns[name], refused) for name in (*numbers, *texts)}
        return columns_of(wanted, numbers, texts, refused)

    return ColumnTable(names, refused, read)


def _array(name: str, values: Any, refused: Any) -> NDArray[Any]:
    try:
        return np.asarray(values)
    except ValueError:  # lists in lists, of many depths or different lengths
        raise refused(f"its column `{short(name)}` is no row of values") from None


def columns_of(
    values: Mapping[str, NDArray[Any]], numbers: Sequence[str], texts: Sequence[str], refused: Any
) -> Columns:
    """Columns from arrays, which must have the same length; rows count from 0."""
    for name, column in values.items():
        if column.ndim != 1:
            raise refused(f"its column `{short(name)}` is no row of values")
    lengths = {len(column) for column in values.values()}
    if len(lengths) != 1:
        raise refused(f"its columns are of {len(lengths)} different lengths")
    (count,) = lengths
    if not 0 < count <= MOST_ROWS:
        raise refused("it has no rows" if not count else f"it has more than {MOST_ROWS:,} rows")
    return Columns(
        refused,
        {name: _floats(name, values[name], refused) for name in numbers},
        {name: _texts(values[name]) for name in texts},
        np.arange(count),
    )


def _floats(name: str, column: NDArray[Any], refused: Any) -> NDArray[np.float64]:
    if column.dtype.kind in "mM":
        why = f"its column `{short(name)}` holds dates or durations ({column.dtype}), not numbers"
        way_out = "give seconds, as pandas' `(t - t.min()).dt.total_seconds()` does"
        raise refused(why, help_text=way_out)
    if column.dtype.kind in "biuf":
        floats = column.astype(float)
        bad = ~(np.abs(floats) < LARGEST_NUMBER) & ~np.isnan(floats)
        place = int(np.argmax(bad)) if bad.any() else None
    else:
        floats, place = checked_numbers(
            ["" if cell is None else str(cell) for cell in column.tolist()], LARGEST_NUMBER
        )
    if place is not None:
        raise _no_number(name, str(column[place]), place, refused)
    return floats


def _texts(column: NDArray[Any]) -> Texts:
    codes: dict[str, int] = {}
    names = (codes.setdefault(_text(cell), len(codes)) for cell in column.tolist())
    return _stripped(np.fromiter(names, int64, len(column)), codes)


def _text(cell: object) -> str:
    """A cell as text; ids that a gap turned into floats lose their decimals."""
    if cell is None or (isinstance(cell, float) and cell != cell):
        return ""
    return str(int(cell)) if isinstance(cell, float) and cell.is_integer() else str(cell)

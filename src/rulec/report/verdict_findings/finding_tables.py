"""Findings as JSON Lines, CSV and Parquet, with a line or row for each."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import IO, Any, TypeAlias

from rulec.report.text.csv_text import csv_text
from rulec.report.verdict_findings.verdict_finding import (
    COLUMNS,
    EMPTY_CELLS,
    RecordingFindings,
    as_json,
)
from rulec.trace.formats.arrow.parquet import arrow, write_parquet

Columns: TypeAlias = Mapping[str, type]
"""Name -> the type of its values."""


class JsonLinesWriter:
    """Findings, or rows of these columns, as JSON Lines."""

    def __init__(self, stream: IO[bytes], columns: Columns | None = None) -> None:
        self._stream = stream
        self._columns = columns

    def add(self, recording: RecordingFindings) -> None:
        """Write a line for each finding or row."""
        if self._columns is None:
            lines = [as_json(finding) for finding in recording.findings]
        else:
            rows = [
                dict(zip(self._columns, row, strict=True))
                for row in _rows(recording, self._columns)
            ]
            lines = [json.dumps({"version": 1, **row}, ensure_ascii=False) for row in rows]
        for line in lines:
            # A lone surrogate, which UTF-8 cannot encode, is written as JSON escapes it.
            self._stream.write(f"{line}\n".encode("utf-8", "backslashreplace"))

    def close(self) -> None:
        """Do nothing: there is no end to write."""


class CsvWriter:
    """Findings, or rows of these columns, as CSV (RFC 4180), with a line of names."""

    def __init__(self, stream: IO[bytes], columns: Columns | None = None) -> None:
        self._stream = stream
        self._columns = columns
        stream.write(csv_text([columns or COLUMNS]).encode())

    def add(self, recording: RecordingFindings) -> None:
        """Write a row for each finding or row."""
        self._stream.write(csv_text(_rows(recording, self._columns)).encode())

    def close(self) -> None:
        """Do nothing: there is no end to write."""


class RowWriter:
    """Writes rows of a table as CSV, or as Parquet. Raises RulecError R0706."""

    def __init__(self, form: str, stream: IO[bytes], name: str, columns: Columns) -> None:
        self._writer = (
            CsvWriter(stream, columns) if form == "csv" else ParquetWriter(stream, name, columns)
        )

    def add(self, rows: Iterable[Mapping[str, object]]) -> None:
        """Write rows."""
        self._writer.add(RecordingFindings("", "", (), (), tuple(rows)))

    def close(self) -> None:
        """Write the end of the table."""
        self._writer.close()


def _rows(recording: RecordingFindings, columns: Columns | None) -> Iterator[list[Any]]:
    """The values of the findings; if there are columns, those of the rows."""
    if columns is None:
        yield from ([getattr(finding, name) for name in COLUMNS] for finding in recording.findings)
    else:
        empty = [(name, EMPTY_CELLS.get(kind)) for name, kind in columns.items()]
        yield from ([row.get(name, nothing) for name, nothing in empty] for row in recording.rows)


class ParquetWriter:
    """Findings, or rows of these columns, as Parquet; tuples of texts become lists."""

    def __init__(self, stream: IO[bytes], name: str, columns: Columns | None = None) -> None:
        arrow(name)  # a missing package is reported before anything is judged
        self._stream = stream
        self._name = name
        self._columns = columns
        self._all_rows: list[list[Any]] = []

    def add(self, recording: RecordingFindings) -> None:
        """Store the findings."""
        self._all_rows += _rows(recording, self._columns)

    def close(self) -> None:
        """Write the table."""
        rows = ([_plain(value) for value in row] for row in self._all_rows)
        write_parquet(rows, list((self._columns or COLUMNS).items()), self._stream, self._name)


def _plain(value: str | float | tuple[str, ...] | None) -> str | float | list[str] | None:
    if isinstance(value, tuple):
        return [_text(item) for item in value]
    return _text(value) if isinstance(value, str) else value


def _text(text: str) -> str:
    """A text without lone surrogates, which UTF-8 cannot encode."""
    return text.encode("utf-8", "backslashreplace").decode()

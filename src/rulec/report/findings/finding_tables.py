"""Rows as JSON Lines, CSV and Parquet: of findings, of drives and rules, of moments."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from math import inf
from typing import IO, Any

from rulec.report.findings.verdict_finding import COLUMNS, EMPTY_CELLS, RecordingFindings
from rulec.report.text.outgoing import csv_text
from rulec.trace.formats.arrow.parquet import arrow, write_parquet


class RowWriter:
    """Writes rows of ``columns`` (name -> type of its values) as ``jsonl``, ``csv`` or ``parquet``.

    JSON has a line for each row, CSV (RFC 4180) a line of names before them; in Parquet tuples of
    texts are lists, and rows are stored until the end. Raises RulecError R0706.
    """

    def __init__(
        self, form: str, stream: IO[bytes], name: str, columns: Mapping[str, type]
    ) -> None:
        if form == "parquet":
            arrow(name)  # a missing package is reported before anything is judged
        self._form, self._stream, self._name = form, stream, name
        self._columns = columns
        self._empty = [(column, EMPTY_CELLS.get(kind)) for column, kind in columns.items()]
        self._waiting: list[list[Any]] = []
        if form == "csv":
            stream.write(csv_text([columns]).encode())

    def add(self, rows: Iterable[Mapping[str, object]]) -> None:
        """Write rows; a column that one lacks, and a number beyond all floats, is empty."""
        cells = [
            [
                nothing if (value := row.get(name, nothing)) == inf else value
                for name, nothing in self._empty
            ]
            for row in rows
        ]
        if self._form == "csv":
            self._stream.write(csv_text(cells).encode())
        elif self._form == "parquet":
            self._waiting += cells
        else:
            for row in cells:
                line = {"version": 1, **dict(zip(self._columns, row, strict=True))}
                text = json.dumps(line, ensure_ascii=False)
                # A lone surrogate, which UTF-8 cannot encode, is written as JSON escapes it.
                self._stream.write(f"{text}\n".encode("utf-8", "backslashreplace"))

    def close(self) -> None:
        """Write the end of the table."""
        if self._form == "parquet":
            rows = ([_plain(value) for value in row] for row in self._waiting)
            write_parquet(rows, list(self._columns.items()), self._stream, self._name)


class FindingTable:
    """Findings as a table, or rows of drives, rules and findings if they have ``columns``."""

    def __init__(
        self, form: str, stream: IO[bytes], name: str, columns: Mapping[str, type] | None
    ) -> None:
        self._writer = RowWriter(form, stream, name, columns or COLUMNS)
        self._has_rows = columns is not None

    def add(self, recording: RecordingFindings) -> None:
        """Write a line for each finding or row."""
        rows = (
            recording.rows if self._has_rows else (finding.row() for finding in recording.findings)
        )
        self._writer.add(rows)

    def close(self) -> None:
        """Write the end of the table."""
        self._writer.close()


def _plain(value: str | float | tuple[str, ...] | None) -> str | float | list[str] | None:
    if isinstance(value, tuple):
        return [_text(item) for item in value]
    return _text(value) if isinstance(value, str) else value


def _text(text: str) -> str:
    """A text without lone surrogates, which UTF-8 cannot encode."""
    return text.encode("utf-8", "backslashreplace").decode()

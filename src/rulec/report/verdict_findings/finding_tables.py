"""Findings as JSON Lines, CSV and Parquet, a line or a row for each."""

from __future__ import annotations

import csv
import io
from typing import IO

from rulec.report.text.terminal_text import visible
from rulec.report.verdict_findings.verdict_finding import (
    COLUMNS,
    FoundInRecording,
    VerdictFinding,
    as_json,
)
from rulec.trace.formats.arrow.parquet import arrow, write_parquet

_FORMULA = ("=", "+", "-", "@")
"""What a cell begins with that spreadsheets take for a formula."""


class JsonLinesWriter:
    """Findings as JSON Lines."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream

    def add(self, found: FoundInRecording) -> None:
        """Write a line for each finding."""
        for finding in found.findings:
            # What no file may hold in UTF-8, half a surrogate pair, JSON writes in the same way.
            self._stream.write(f"{as_json(finding)}\n".encode("utf-8", "backslashreplace"))

    def close(self) -> None:
        """Nothing comes at the end."""


class CsvWriter:
    """Findings as CSV (RFC 4180), with a line of names."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream = stream
        self._write([list(COLUMNS)])

    def add(self, found: FoundInRecording) -> None:
        """Write a row for each finding."""
        self._write([[_cell(getattr(one, name)) for name in COLUMNS] for one in found.findings])

    def close(self) -> None:
        """Nothing comes at the end."""

    def _write(self, rows: list[list[str]]) -> None:
        text = io.StringIO()
        csv.writer(text, lineterminator="\r\n").writerows(rows)
        self._stream.write(text.getvalue().encode())


def _cell(value: str | float | tuple[str, ...] | None) -> str:
    """A cell; a text that a spreadsheet would compute gets an apostrophe before it."""
    if value is None:
        return ""
    if isinstance(value, float):
        return repr(value)
    text = visible("; ".join(value) if isinstance(value, tuple) else value)
    return f"'{text}" if text.startswith((*_FORMULA, "'")) else text


class ParquetWriter:
    """Findings as Parquet; several others, and what a rule is open on, are lists."""

    def __init__(self, stream: IO[bytes], name: str) -> None:
        arrow(name)  # what is missing is said before anything is judged
        self._stream = stream
        self._name = name
        self._found: list[VerdictFinding] = []

    def add(self, found: FoundInRecording) -> None:
        """Keep the findings."""
        self._found += found.findings

    def close(self) -> None:
        """Write the table."""
        rows = ([_plain(getattr(one, name)) for name in COLUMNS] for one in self._found)
        write_parquet(rows, list(COLUMNS.items()), self._stream, self._name)


def _plain(value: str | float | tuple[str, ...] | None) -> str | float | list[str] | None:
    if isinstance(value, tuple):
        return [_text(item) for item in value]
    return _text(value) if isinstance(value, str) else value


def _text(text: str) -> str:
    """A text in UTF-8, which has no halves of surrogate pairs."""
    return text.encode("utf-8", "backslashreplace").decode()

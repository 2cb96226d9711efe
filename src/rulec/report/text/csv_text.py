"""Rows as CSV (RFC 4180) in which spreadsheets evaluate nothing."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable

from rulec.report.text.outgoing import spreadsheet_text
from rulec.report.text.terminal_text import visible


def csv_text(rows: Iterable[Iterable[object]], line_end: str = "\r\n") -> str:
    """Lines of texts and numbers; items of a tuple are separated by semicolons, None is empty."""
    text = io.StringIO()
    csv.writer(text, lineterminator=line_end).writerows(map(_cell, row) for row in rows)
    return text.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, tuple):
        value = "; ".join(value)
    return spreadsheet_text(visible(value)) if isinstance(value, str) else repr(value)

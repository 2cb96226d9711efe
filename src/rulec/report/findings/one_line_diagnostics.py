"""Diagnostics as a line each, ``file:line:column: code message``, as editors read them."""

from __future__ import annotations

from collections.abc import Iterable

from rulec.diagnostics import Diagnostic
from rulec.report.text.terminal_text import visible


def as_lines(diagnostics: Iterable[Diagnostic]) -> str:
    """A line for each; what has no place has no prefix either."""
    return "\n".join(
        visible(f"{_where(diagnostic)}{diagnostic.code} {diagnostic.message}")
        for diagnostic in diagnostics
    )


def _where(diagnostic: Diagnostic) -> str:
    place = diagnostic.place
    if place is None:
        return ""
    parts = [place.file, place.line, place.column]
    return ":".join(str(part) for part in parts if part is not None) + ": "

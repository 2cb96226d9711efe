"""Diagnostics as JSON, as docs/commands.md describes it."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from rulec.diagnostics import Diagnostic, SourceLocation


def as_json(found: Iterable[Diagnostic]) -> str:
    """A list with an object for each diagnostic."""
    return json.dumps([as_data(one) for one in found], ensure_ascii=False, indent=2)


def as_data(one: Diagnostic) -> dict[str, Any]:
    """All that a diagnostic says, as what JSON can hold."""
    return {
        "code": one.code,
        "severity": one.severity,
        "message": one.message,
        "place": place_as_data(one.place),
        "expected": one.expected,
        "help": one.help,
        "labels": [
            {"place": place_as_data(label.place), "message": label.message} for label in one.labels
        ],
        "notes": list(one.notes),
    }


def place_as_data(place: SourceLocation | None) -> dict[str, Any] | None:
    """A place in numbers, counted from 1 in Unicode code points; ``end_column`` is behind it."""
    if place is None:
        return None
    return {
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "end_line": place.end_line,
        "end_column": place.end_column,
    }

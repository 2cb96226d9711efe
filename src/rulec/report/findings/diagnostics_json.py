"""Diagnostics as JSON, as docs/commands.md describes it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.report.json_document import JsonDocument, JsonPart, as_indented


class PlaceData(JsonPart, frozen=True, kw_only=True):
    """A place in a file, counted from 1 in Unicode code points; ``end_column`` is behind it."""

    file: str
    line: int | None
    column: int | None
    end_line: int | None
    end_column: int | None


class LabelData(JsonPart, frozen=True, kw_only=True):
    """A further place worth looking at."""

    place: PlaceData | None
    message: str


class FindingData(JsonDocument, frozen=True, kw_only=True):
    """A mistake or a warning; what it does not have is empty."""

    code: str
    severity: Literal["error", "warning"]
    message: str
    place: PlaceData | None
    expected: str
    help: str
    labels: Sequence[LabelData]
    notes: Sequence[str]


def as_json(diagnostics: Iterable[Diagnostic]) -> str:
    """Write a list with an object for each diagnostic."""
    return as_indented([_finding(diagnostic) for diagnostic in diagnostics])


def _finding(diagnostic: Diagnostic) -> FindingData:
    return FindingData(
        code=diagnostic.code,
        severity=diagnostic.severity,
        message=diagnostic.message,
        place=place_data(diagnostic.place),
        expected=diagnostic.expected,
        help=diagnostic.help,
        labels=[
            LabelData(place=place_data(label.place), message=label.message)
            for label in diagnostic.labels
        ],
        notes=diagnostic.notes,
    )


def place_data(place: SourceLocation | None) -> PlaceData | None:
    """A place in numbers."""
    if place is None:
        return None
    return PlaceData(
        file=place.file,
        line=place.line,
        column=place.column,
        end_line=place.end_line,
        end_column=place.end_column,
    )

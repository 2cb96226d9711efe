"""Diagnostics and codes as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from rulec.diagnostics import Diagnostic
from rulec.report.findings.code_registry import CodeExplanation, ExampleKind
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled


class PlaceData(JsonPart, frozen=True, kw_only=True):
    """A place, counted from 1 in Unicode code points; ``end_column`` is exclusive."""

    file: str
    line: int | None
    column: int | None
    end_line: int | None
    end_column: int | None


class LabelData(JsonPart, frozen=True, kw_only=True):
    """A further place worth showing."""

    place: PlaceData | None
    message: str


class FixData(JsonPart, frozen=True, kw_only=True):
    """An edit that corrects a mistake: the text at ``place`` is replaced by ``text``."""

    place: PlaceData
    text: str


class FindingData(JsonDocument, frozen=True, kw_only=True):
    """A mistake or a warning; fields that do not apply are empty."""

    code: str
    severity: Literal["error", "warning"]
    message: str
    place: PlaceData | None
    expected: str
    help: str
    labels: Sequence[LabelData]
    notes: Sequence[str]
    fix: FixData | None = None


class CodeData(JsonDocument, frozen=True, kw_only=True):
    """A message's code with its explanation; examples may be empty."""

    code: str
    title: str
    why: str
    kind: ExampleKind
    bad: str
    good: str


def as_json(diagnostics: Iterable[Diagnostic]) -> str:
    """Write a list with an object for each diagnostic."""
    return as_indented([filled(FindingData, diagnostic) for diagnostic in diagnostics])


def codes_as_json(codes: Iterable[CodeExplanation]) -> str:
    """Write a list with an object for each code."""
    return as_indented([filled(CodeData, code) for code in codes])

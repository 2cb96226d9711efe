"""Explanations of codes as JSON."""

from __future__ import annotations

from collections.abc import Iterable

from rulec.diagnostics.code import Code, ExampleKind
from rulec.report.json_document import JsonDocument, as_indented


class CodeData(JsonDocument, frozen=True, kw_only=True):
    """A message's code with its explanation; examples may be empty."""

    code: str
    title: str
    why: str
    kind: ExampleKind
    bad: str
    good: str


def as_json(codes: Iterable[Code]) -> str:
    """Write a list with an object for each code."""
    return as_indented(
        [
            CodeData(
                code=code.code,
                title=code.title,
                why=code.why,
                kind=code.kind,
                bad=code.bad,
                good=code.good,
            )
            for code in codes
        ]
    )

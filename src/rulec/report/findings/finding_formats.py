"""The formats of findings, and those of findings about rulebooks with one line for each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Protocol

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.diagnostic import address
from rulec.files.read_files import from_here
from rulec.report.text.terminal_text import visible

if TYPE_CHECKING:
    from rulec.report.findings.verdict_finding import RecordingFindings

FORMATS = ("full", "concise", "json", "github", "sarif")


ENDINGS: Mapping[str, tuple[str, ...]] = {
    "jsonl": (".jsonl", ".ndjson"),
    "csv": (".csv",),
    "parquet": (".parquet", ".pq"),
    "junit": (".xml",),
    "sarif": (".sarif", ".sarif.json"),
    "mcap": (".mcap",),
}
"""Name of a format -> the endings of its files."""


class FindingWriter(Protocol):
    """Writes findings to a stream: recording by recording, then the end."""

    def add(self, recording: RecordingFindings) -> None:
        """Add the findings of a recording. Raises RulecError."""

    def close(self) -> None:
        """Write the end. Raises RulecError."""


def as_lines(diagnostics: Iterable[Diagnostic]) -> str:
    """``file:line:column: code message``; no prefix if there is no place."""
    return "\n".join(
        visible(
            f"{'' if diagnostic.place is None else f'{address(diagnostic.place)}: '}"
            f"{diagnostic.code} {diagnostic.message}"
        )
        for diagnostic in diagnostics
    )


def as_annotations(diagnostics: Iterable[Diagnostic]) -> str:
    """A GitHub workflow command per finding, shown beside the lines of a change.

    https://docs.github.com/en/actions/reference/workflows-and-actions/workflow-commands
    """
    return "\n".join(_command(diagnostic) for diagnostic in diagnostics)


def _command(diagnostic: Diagnostic) -> str:
    properties: dict[str, object] = {}
    if diagnostic.place is not None:
        place = diagnostic.place
        properties = {"file": from_here(place.file), "line": place.line, "endLine": place.end_line}
        # GitHub accepts no columns for a place over several lines.
        if place.end_line in (None, place.line):
            properties |= {"col": place.column, "endColumn": place.end_column}
    properties["title"] = f"{diagnostic.code}: {diagnostic.message}"
    written = ",".join(
        f"{name}={_property(str(value))}" for name, value in properties.items() if value is not None
    )
    lines = [diagnostic.expected or diagnostic.message]
    lines += [f"help: {diagnostic.help}"] if diagnostic.help else []
    lines += [f"note: {note}" for note in diagnostic.notes]
    message = "\n".join(visible(line) for line in lines)
    return f"::{diagnostic.severity} {written}::{_data(message)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(visible(text)).replace(":", "%3A").replace(",", "%2C")

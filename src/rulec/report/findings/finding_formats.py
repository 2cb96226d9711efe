"""Findings about rulebooks in each output format; formats with one line per finding are here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.source_text import address
from rulec.files.read_files import from_here
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.report.text.terminal_text import visible

FORMATS = ("full", "concise", "json", "github", "sarif")


def render(
    diagnostics: Sequence[Diagnostic],
    output_format: str,
    *,
    color: bool,
    complete: bool,
    width: int = 0,
) -> str:
    """Render diagnostics in one of FORMATS.

    ``complete``: all inputs could be read; ``width`` is that of a terminal, 0 elsewhere.
    """
    match output_format:
        case "concise":
            return as_lines(diagnostics)
        case "json":
            # msgspec takes 8 ms.
            from rulec.report.findings.diagnostics_json import as_json

            return as_json(diagnostics)
        case "github":
            return as_annotations(diagnostics)
        case "sarif":
            # The explanations of all codes, and urllib: 6 ms.
            from rulec.report.findings.sarif import as_sarif

            return as_sarif(diagnostics, complete=complete)
        case _:
            return render_diagnostics(diagnostics, color, width=width).rstrip("\n")


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

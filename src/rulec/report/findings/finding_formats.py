"""Findings about rulebooks in each output format."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.diagnostics import Diagnostic

FORMATS = ("full", "concise", "json", "github", "sarif")


def render(diagnostics: Sequence[Diagnostic], wanted: str, *, color: bool, complete: bool) -> str:
    """Render diagnostics; empty if the format has nothing for none.

    Args:
        diagnostics: those to render.
        wanted: one of FORMATS.
        color: may there be ANSI colours?
        complete: was everything read that had to be?
    """
    match wanted:
        case "concise":
            # Every verb imports this file for FORMATS, and few write findings.
            from rulec.report.findings.one_line_diagnostics import as_lines

            return as_lines(diagnostics)
        case "json":
            # msgspec takes 8 ms.
            from rulec.report.findings.diagnostics_json import as_json

            return as_json(diagnostics)
        case "github":
            # As above: for FORMATS alone nothing is imported.
            from rulec.report.findings.one_line_diagnostics import as_annotations

            return as_annotations(diagnostics)
        case "sarif":
            # The explanations of all codes, and urllib: 6 ms.
            from rulec.report.findings.sarif import as_sarif

            return as_sarif(diagnostics, complete=complete)
        case _:
            # As above.
            from rulec.report.findings.diagnostics_text import render_diagnostics

            return render_diagnostics(diagnostics, color).rstrip("\n")

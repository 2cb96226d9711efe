"""The difference of two rulebooks, in the format that somebody asked for."""

from __future__ import annotations

from rulec.analysis.diff.rulebook_comparison import RulebookDiff
from rulec.report.rulebooks.diff_csv import as_csv
from rulec.report.rulebooks.diff_json import as_json
from rulec.report.rulebooks.diff_markdown import as_markdown
from rulec.report.rulebooks.diff_text import as_text

FORMATS = ("text", "markdown", "json", "html", "csv")


def render(diff: RulebookDiff, output_format: str) -> str:
    """Write the difference in one of ``FORMATS``."""
    match output_format:
        case "json":
            return as_json(diff)
        case "html":
            # markdown-it and Pygments take 0.1 s.
            from rulec.report.text.html_page import as_html

            title = f"{diff.first.name} compared to {diff.second.name}"
            return as_html(as_markdown(diff), title, "")
        case "markdown":
            return as_markdown(diff)
        case "csv":
            return as_csv(diff)
        case _:
            return as_text(diff)

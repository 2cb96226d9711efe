"""``rulec doc``: a rulebook as a document for lawyers."""

from __future__ import annotations

from pathlib import Path

import click

from rulec.cli.options.shared_options import at_option, only_sources
from rulec.cli.options.shell_completion import complete_rulebooks

FORMATS = ("html", "markdown")

SUFFIXES = {".md": "markdown", ".markdown": "markdown"}

OTHERS = (".pdf", ".doc", ".docx", ".odt", ".rtf")
"""Ends of names that promise what is not written."""


@click.command()
@click.argument("rulebook", shell_complete=complete_rulebooks)
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False), metavar="FILE", help="Write to FILE."
)
@click.option(
    "--format",
    "output_format",
    type=click.Choice(FORMATS),
    help="One page for a browser and for paper, or Markdown.  [default: markdown for a FILE that "
    "ends in .md, else html]",
)
@at_option
def command(rulebook: str, output: str | None, output_format: str | None, at: str) -> None:
    """Write a RULEBOOK (a name, or the path of a source) as a document for lawyers.

    It has every rule with its provision, in plain English, as a formula and by its examples; what
    was changed of inherited rules and what was left out; values, definitions, words and an index.
    """
    from rulec.analysis.lineage.book_lineage import read_with_lineage
    from rulec.report.rulebooks.book_document import CONTENTS, as_markdown, title_of
    from rulec.report.text.console import print_diagnostics, put_result
    from rulec.report.text.html_page import as_html
    from rulec.settings import search_path

    only_sources([rulebook], "be made a document of")
    if output_format is None:
        if Path(output or "").suffix.lower() in OTHERS:
            raise click.UsageError(
                f"{output} would be HTML: write FILE.html, which a browser prints and saves as PDF"
            )
        output_format = SUFFIXES.get(Path(output or "").suffix, "html")
    loaded, inherited = read_with_lineage(rulebook, search_path(), at)
    print_diagnostics(loaded.warnings)
    text = as_markdown(loaded, inherited)
    if output_format == "html":
        text = as_html(text, title_of(loaded.rulebook), CONTENTS)
    put_result(text, output)

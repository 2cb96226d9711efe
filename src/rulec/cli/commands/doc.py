"""``rulec doc``: a rulebook as a document for lawyers."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeAlias, get_args

import click

from rulec.cli.options import shared_options as shared
from rulec.cli.output import open_session
from rulec.report.text.console import put_result

Format: TypeAlias = Literal["html", "markdown"]

SUFFIXES: dict[str, Format] = {".md": "markdown", ".markdown": "markdown"}

OTHERS = (".pdf", ".doc", ".docx", ".odt", ".rtf")
"""Ends of names that promise what is not written."""


@click.command()
@shared.rulebook_argument
@shared.text_output_option()
@click.option(
    "--format",
    "output_format",
    type=click.Choice(get_args(Format)),
    help="One page for a browser and for paper, or Markdown.  [default: markdown for a FILE that "
    "ends in .md, else html]",
)
@shared.at_option
def command(rulebook: str, output: str | None, output_format: Format | None, at: str) -> None:
    """Write a RULEBOOK (a name, or the path of a source) as a document for lawyers.

    It has every rule with its provision, in plain English, as a formula and by its examples; what
    was changed of inherited rules and what was left out; values, definitions, words and an index.
    """
    shared.only_sources([rulebook], "cannot be made a document of")
    if output_format is None:
        if Path(output or "").suffix.lower() in OTHERS:
            raise click.UsageError(
                f"{output} would be HTML: write FILE.html, which a browser prints and saves as PDF"
            )
        output_format = SUFFIXES.get(Path(output or "").suffix, "html")
    put_result(open_session(at).doc(rulebook, output_format), output)

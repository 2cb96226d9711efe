"""``rulec doc``: a rulebook as a document for lawyers."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeAlias, cast

import click

from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import chosen_format, output_options
from rulec.cli.output import open_session
from rulec.report.text.console import put_result

Format: TypeAlias = Literal["html", "markdown"]

_FORMATS = {"html": (".html", ".htm"), "markdown": (".md", ".markdown")}

_PRINTED = (".pdf", ".doc", ".docx", ".odt", ".rtf")
"""Ends of names that promise what a browser can make of the page."""


@click.command()
@shared.rulebook_argument
@output_options(_FORMATS, "the document", former="--format")
@shared.at_option
def command(rulebook: str, output: str | None, output_format: Format | None, at: str) -> None:
    """Write a RULEBOOK (a name, or the path of a source) as a document for lawyers.

    It has every rule with its provision, in plain English, as a formula and by its examples; what
    was changed of inherited rules and what was left out; values, definitions, words and an index.
    """
    shared.only_sources([rulebook], "cannot be made a document of")
    if output_format is None and Path(output or "").suffix.lower() in _PRINTED:
        raise click.UsageError(
            f"{output} would be HTML: write FILE.html, which a browser prints and saves as PDF"
        )
    form = cast("Format", chosen_format(_FORMATS, output, output_format))
    put_result(open_session(at).doc(rulebook, form), output)

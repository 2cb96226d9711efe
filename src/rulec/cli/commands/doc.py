"""``rulec doc``: a rulebook as a document for lawyers."""

from __future__ import annotations

from typing import Literal, TypeAlias, cast

import click

from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.output import open_session, put_answer
from rulec.logic.sentences.language import LANGUAGES, LanguageCode

Format: TypeAlias = Literal["html", "markdown"]


@click.command()
@shared.rulebook_argument
@output_options(
    endings_of("html", "markdown"),
    "the document",
    former="--format",
    instead="A browser prints the page and saves it as PDF.",
)
@click.option(
    "--language",
    type=click.Choice(LANGUAGES),
    default="en",
    show_default=True,
    help="The language of its sentences and headings. What an author wrote stays as it is.",
)
@shared.at_option
def command(rulebook: str, to: Output, language: str, at: str) -> None:
    """Write a RULEBOOK (a name, or the path of a source) as a document for lawyers.

    It has every rule with its provision, in plain language, as a formula and by its examples, in
    the page with pictures; what was changed of inherited rules and what was left out; values,
    definitions, words and an index.
    """
    shared.only_sources([rulebook], "cannot be made a document of")
    session = open_session(at)
    put_answer(session.doc(rulebook, cast("Format", to.form), cast("LanguageCode", language)), to)

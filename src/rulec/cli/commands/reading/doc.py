"""``rulec doc``: a rulebook as a document for lawyers."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, TypeAlias, cast

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import option, verb
from rulec.cli.output import errors_told, open_session, put_answer, sources_of_rulebooks, told_apart
from rulec.files.written_files import make_folder
from rulec.logic.sentences.language import LANGUAGES, LanguageCode

Format: TypeAlias = Literal["html", "markdown"]


_ENDINGS = endings_of("html", "markdown")


@verb
def command(
    *,
    rulebooks: tuple[str, ...] = shared.rulebooks_argument(),
    to: Output = output_options(
        _ENDINGS,
        "the document",
        former=["--format"],
        instead="A browser prints the page and saves it as PDF.",
        folders=True,
    ),
    language: str = option(
        "--language",
        type=click.Choice(LANGUAGES),
        default="en",
        show_default=True,
        help="The language of headings and generated sentences. What the author wrote is kept as "
        "is.",
    ),
    at: str = shared.at_option,
) -> int:
    """Write each RULEBOOK (a name, or the path of a source) as a document for lawyers.

    It contains every rule with its provision, in plain language, as a formula, and with its
    examples (in HTML with pictures); which inherited rules were changed or left out; and values,
    definitions, words and an index. For several rulebooks, `-o DIR/` writes one DIR/NAME.html each.
    """
    books = sources_of_rulebooks(rulebooks, "cannot be made a document of")
    form, tongue = cast("Format", to.form), cast("LanguageCode", language)
    if not to.is_folder:
        if len(books) > 1:
            raise click.UsageError(
                f"a document describes one rulebook, and these are {len(books)}: give a folder for "
                "their documents, as in `-o laws/`"
            )
        put_answer(open_session(at).doc(books[0], form, tongue), to)
        return ExitStatus.OK
    folder = Path(to.path)
    make_folder(folder)
    written = 0
    for name, book in told_apart(books).items():
        with errors_told():
            path = str(folder / f"{name}{_ENDINGS[form][0]}")
            put_answer(open_session(at).doc(book, form, tongue), Output(path, form))
            written += 1
    return ExitStatus.after(answered=written == len(books), failed=False)

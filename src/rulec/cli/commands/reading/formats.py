"""``rulec list formats``: the formats of recordings and maps, and the signals they can provide."""

from __future__ import annotations

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import put_answer
from rulec.diagnostics import did_you_mean
from rulec.report.text.console import page_width


@verb
def command(
    *,
    names: tuple[str, ...] = argument(nargs=-1, metavar="[NAME]..."),
    words: bool = option(
        "--words",
        is_flag=True,
        help="Also list which words of the vocabulary `road` each format can provide.",
    ),
    to: Output = output_options(endings_of("text", "markdown", "json"), "the list"),
) -> None:
    """List the supported formats of recorded traffic and of maps, or describe NAME.

    With --words also the words that each format can provide to a rulebook. A particular file may
    provide fewer; `rulec show --audit R --source FILE` lists those.
    """
    every = rulec.formats()
    known = list(dict.fromkeys(format_.name for format_ in every))
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known)
            raise click.UsageError(f"there is no format `{name}`{f'; {hint}' if hint else '.'}")
    listed = [format_ for format_ in every if not names or format_.name in names]
    order = lazy.format_listing.words_in_order()
    match to.form:
        case "json":
            text = lazy.format_listing.as_json(listed)
        case "markdown":
            text = lazy.format_listing.as_markdown(listed, order, words=words)
        case _:
            text = lazy.format_listing.as_text(listed, order, words=words, width=page_width())
    put_answer(text, to)

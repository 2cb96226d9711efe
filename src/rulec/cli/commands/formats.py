"""``rulec formats``: the formats of recordings and maps, and what each can tell."""

from __future__ import annotations

import click

import rulec
from rulec.cli.options.output_options import chosen_format, output_options
from rulec.diagnostics import did_you_mean
from rulec.report.text.console import put_result

_FORMATS = {"text": (".txt",), "markdown": (".md",), "json": (".json",)}


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option(
    "--words",
    is_flag=True,
    help="Say also which words of the vocabulary `road` some file of each format can tell.",
)
@output_options(_FORMATS, "the list", json=True)
def command(
    names: tuple[str, ...],
    words: bool,
    output: str | None,
    output_format: str | None,
    json_output: bool,
) -> None:
    """List the formats of recorded traffic, and of maps, that are read; all of them, or NAME.

    With --words also what they can tell: which words a rulebook may be judged by. A particular file
    may tell less; `rulec audit R --source FILE` says what it does.
    """
    # Words that are derived from recordings, and msgspec, 250 ms: not for --help.
    from rulec.report.recordings import format_listing

    form = chosen_format(_FORMATS, output, output_format, json_output=json_output)
    every = rulec.formats()
    known = list(dict.fromkeys(one.name for one in every))
    for name in names:
        if name not in known:
            hint = did_you_mean(name, known)
            raise click.UsageError(f"there is no format `{name}`{f'; {hint}' if hint else '.'}")
    listed = [one for one in every if not names or one.name in names]
    order = format_listing.words_in_order()
    match form:
        case "json":
            text = format_listing.as_json(listed)
        case "markdown":
            text = format_listing.as_markdown(listed, order, words=words)
        case _:
            text = format_listing.as_text(listed, order, words=words)
    put_result(text, output)

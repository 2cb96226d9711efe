"""``rulec list``: the available rulebooks, vocabularies, scenarios and codes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, get_args

import click

import rulec
from rulec.api.rulebook_questions import Kind
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import Verb
from rulec.cli.output import open_session, put_answer

if TYPE_CHECKING:
    from rulec.report.text.listing import Listed

KINDS: tuple[Kind, ...] = get_args(Kind)


@click.command(cls=Verb)
@click.argument("kind", type=click.Choice(KINDS), required=False)
@output_options(endings_of("text", "json"), "the list")
def command(kind: Kind | None, to: Output) -> None:
    """List everything that can be named, with its title; without KIND all kinds except codes."""
    # Late import, not for --help: msgspec (7 ms).
    from rulec.report.text.listing import as_json, as_text

    def session(kind: Kind) -> rulec.Session:
        # Scenarios and codes are listed even if the project's settings have a mistake.
        return open_session() if kind in ("rulebooks", "vocabularies") else rulec.Session()

    kinds = KINDS[:-1] if kind is None else (kind,)
    lists: dict[str, Sequence[Listed]] = {kind: session(kind).list(kind) for kind in kinds}
    put_answer(as_json(lists) if to.form == "json" else as_text(lists), to)

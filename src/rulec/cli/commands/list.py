"""``rulec list``: the rulebooks, vocabularies, scenarios and codes that there are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, get_args

import click

import rulec
from rulec.api.rulebook_verbs import Kind
from rulec.cli.options.shared_options import json_option
from rulec.cli.output import open_session
from rulec.report.text.console import print_result

if TYPE_CHECKING:
    from rulec.report.text.listing import Listed

KINDS: tuple[Kind, ...] = get_args(Kind)


@click.command()
@click.argument("kind", type=click.Choice(KINDS), required=False)
@json_option
def command(kind: Kind | None, json_output: bool) -> None:
    """List what can be asked for by name, with a title; without KIND all of it but the codes."""
    # msgspec, 7 ms: not for --help.
    from rulec.report.text.listing import as_json, as_text

    def session(kind: Kind) -> rulec.Session:
        # A mistake in the project's settings hides neither scenarios nor codes.
        return open_session() if kind in ("rulebooks", "vocabularies") else rulec.Session()

    kinds = KINDS[:-1] if kind is None else (kind,)
    lists: dict[str, Sequence[Listed]] = {kind: session(kind).list(kind) for kind in kinds}
    print_result(as_json(lists) if json_output else as_text(lists))

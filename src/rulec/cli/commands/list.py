"""``rulec list``: the rulebooks, vocabularies, scenarios and codes that there are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from rulec.cli.options.shared_options import json_option

if TYPE_CHECKING:
    from rulec.report.text.listing import Listed

KINDS = ("rulebooks", "vocabularies", "scenarios", "codes")


@click.command()
@click.argument("kind", type=click.Choice(KINDS), required=False)
@json_option
def command(kind: str | None, json_output: bool) -> None:
    """List what can be asked for by name, with a title; without KIND all of it but the codes."""
    from rulec.report.text import listing
    from rulec.report.text.console import print_result

    kinds = KINDS[:-1] if kind is None else (kind,)
    listed = {kind: _listed(kind) for kind in kinds}
    print_result(listing.as_json(listed) if json_output else listing.as_text(listed))


def _listed(kind: str) -> Sequence[Listed]:
    from rulec.api.listing import listed
    from rulec.settings import search_path

    return listed(kind, search_path() if kind in ("rulebooks", "vocabularies") else ())

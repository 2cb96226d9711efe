"""``rulec list``: the rulebooks, vocabularies, scenarios and codes that there are."""

from __future__ import annotations

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


def _listed(kind: str) -> list[Listed]:
    from rulec.report.text.listing import Listed

    match kind:
        case "rulebooks":
            from rulec.rulebook.files.catalogue import list_rulebooks
            from rulec.settings import search_path

            entries = list_rulebooks(search_path())
            return [Listed(entry.name, entry.title, str(entry.path)) for entry in entries]
        case "vocabularies":
            from rulec.rulebook.files.catalogue import list_vocabularies
            from rulec.settings import search_path

            return [
                Listed(vocabulary.name, vocabulary.title, str(vocabulary.path))
                for vocabulary in list_vocabularies(search_path())
            ]
        case "scenarios":
            from rulec.resources import scenarios_folder
            from rulec.scenario import available_scenarios, load_scenario

            return [
                Listed(
                    name,
                    " ".join(load_scenario(name).about.split()),
                    str(scenarios_folder() / f"{name}.toml"),
                )
                for name in available_scenarios()
            ]
        case _:
            from rulec.report.findings.code_registry import all_codes

            return [Listed(text, code.title) for text, code in all_codes().items()]

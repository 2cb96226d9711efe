"""``rulec help``: the text of `--help` for a verb given by name."""

from __future__ import annotations

import click
from click.shell_completion import CompletionItem

from rulec.cli.options.verb_class import Verb
from rulec.cli.verb_table import VERBS
from rulec.diagnostics import nearest_name


def _verbs(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    return [
        CompletionItem(verb, help=about)
        for verb, about in VERBS.items()
        if verb.startswith(incomplete)
    ]


@click.command(cls=Verb)
@click.argument("words", nargs=-1, metavar="[COMMAND]", shell_complete=_verbs)
@click.pass_context
def command(context: click.Context, words: tuple[str, ...]) -> None:
    """Show the help of COMMAND, such as `check` or `draw drive`; without COMMAND list all."""
    here = context.find_root()
    for word in words:
        known = here.command.list_commands(here) if isinstance(here.command, click.Group) else []
        subcommand = None
        if isinstance(here.command, click.Group):
            subcommand = here.command.get_command(here, word)
        if subcommand is None:
            near = nearest_name(word, known)
            way_out = f"did you mean `{near}`?" if near else "`rulec help` lists them"
            raise click.UsageError(f"there is no command `{word}`; {way_out}")
        here = click.Context(subcommand, here, word)
    click.echo(here.get_help())

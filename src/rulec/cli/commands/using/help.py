"""``rulec help``: the text of `--help` for a verb given by name."""

from __future__ import annotations

from pathlib import Path

import click
from click.shell_completion import CompletionItem

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.verb_class import Verb, argument, asking
from rulec.cli.verb_table import FORMER, VERBS, called
from rulec.diagnostics import nearest_name
from rulec.report.findings.code_registry import all_codes
from rulec.settings import search_path


def _verbs(_: click.Context, __: click.Parameter, incomplete: str) -> list[CompletionItem]:
    return [
        CompletionItem(verb, help=about)
        for verb, about in VERBS.items()
        if verb.startswith(incomplete)
    ]


@click.command(cls=Verb, context_settings={"ignore_unknown_options": True})
@asking
@click.pass_context
def command(
    context: click.Context,
    *,
    words: tuple[str, ...] = argument(nargs=-1, metavar="[COMMAND]", shell_complete=_verbs),
) -> None:
    """Show the help of COMMAND, such as `check` or `draw drive`; without COMMAND list all."""
    here = context.find_root()
    if words and words[0] in (*VERBS, *FORMER):
        name, rest = called(words)
        words = (name, *rest)
    for word in words:
        known = here.command.list_commands(here) if isinstance(here.command, click.Group) else []
        subcommand = None
        if isinstance(here.command, click.Group):
            subcommand = here.command.get_command(here, word)
        if subcommand is None:
            near = nearest_name(word, known)
            way_out = f"did you mean `{near}`?" if near else _way_out(word)
            raise click.UsageError(f"there is no command `{word}`; {way_out}")
        here = click.Context(subcommand, here, word)
    click.echo(here.get_help())


def _way_out(word: str) -> str:
    """Where something else of this name is explained, or where commands are listed."""
    places = (*search_path(), Path())
    if word.upper() in all_codes() or lazy.find_word(word, places):
        return f"`rulec explain {word}` explains it"
    if books := lazy.rulebooks_with_rule(word, places):
        return f"it is a rule, which `rulec show {books[0]} {word}` explains"
    return "`rulec help` lists them"

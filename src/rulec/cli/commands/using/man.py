"""``rulec help --man``: all commands as a manual page."""

from __future__ import annotations

import click

from rulec.cli.manual_page import manual_page
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.verb_class import Verb
from rulec.cli.output import put_answer


@click.command(cls=Verb)
@output_options(endings_of("roff"), "the page")
@click.pass_context
def command(context: click.Context, to: Output) -> None:
    """Write the manual page rulec(1), with every command and its options.

    \b
    rulec help --man -o ~/.local/share/man/man1/rulec.1    for `man rulec`
    rulec help --man | man -l -                            to read it at once
    """  # noqa: D301 - click reads the backspace
    put_answer(manual_page(context.find_root()), to)

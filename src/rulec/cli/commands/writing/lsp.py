"""``rulec lsp``: the language server, for editors."""

from __future__ import annotations

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.verb_class import Verb
from rulec.language_server.editor_settings import EDITORS, editor_settings
from rulec.language_server.language_server_messages import no_pygls


@click.command(cls=Verb)
@click.option(
    "--settings",
    "editor",
    type=click.Choice([*EDITORS]),
    help="Print the settings for this editor, and exit.",
)
@click.option(
    "--stdio", is_flag=True, help="Accepted because some editors pass it; it has no effect."
)
def command(*, editor: str | None, stdio: bool) -> int:  # noqa: ARG001 - it does so anyway
    """Serve an editor: diagnostics, completion, renaming and more.

    The editor starts this command and speaks the Language Server Protocol with it over standard
    input and output; `--settings` prints the configuration for each editor. Serving needs the extra
    `lsp`: in a checkout `.venv/bin/python -m pip install -e '.[lsp]'`.
    """
    if editor is not None:
        click.echo(editor_settings(editor), nl=False)
        return ExitStatus.OK
    try:
        serve = lazy.serve
    except ModuleNotFoundError as problem:
        if (problem.name or "").partition(".")[0] not in ("pygls", "lsprotocol", "cattrs"):
            raise
        raise no_pygls() from None
    return serve()

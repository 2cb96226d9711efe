"""``rulec lsp``: the language server, for editors."""

from __future__ import annotations

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.verb_class import Verb
from rulec.language_server.editor_settings import EDITORS, editor_settings


@click.command(cls=Verb)
@click.option(
    "--settings",
    "editor",
    type=click.Choice([*EDITORS]),
    help="Print what to put into this editor's settings, and end.",
)
@click.option("--stdio", is_flag=True, help="What some editors add, and what it does anyway.")
def command(*, editor: str | None, stdio: bool) -> int:  # noqa: ARG001 - it does so anyway
    """Answer an editor: diagnostics, completion, renaming and the like.

    Editors start it themselves and speak the Language Server Protocol with it, over standard input
    and output; `--settings` prints how each is told. To answer, not to print, it takes the extra
    `lsp`: in a checkout `.venv/bin/python -m pip install -e '.[lsp]'`.
    """
    if editor is not None:
        click.echo(editor_settings(editor), nl=False)
        return ExitStatus.OK
    # The message, 5 ms: not for --help.
    from rulec.language_server.language_server_messages import no_pygls

    try:
        # The server and the protocol's types, 200 ms: not for --help.
        from rulec.language_server.server import serve
    except ModuleNotFoundError as problem:
        if (problem.name or "").partition(".")[0] not in ("pygls", "lsprotocol", "cattrs"):
            raise
        raise no_pygls() from None
    return serve()

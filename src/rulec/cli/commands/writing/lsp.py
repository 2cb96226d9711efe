"""``rulec lsp``: the language server, for editors."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import click

from rulec import resources
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.verb_class import option, verb
from rulec.language_server.language_server_messages import no_pygls


def editor_settings(editor: str) -> str:
    """The settings text for an editor of ``EDITORS``, with this rulec's paths."""
    return EDITORS[editor](_command())


def _command() -> list[str]:
    """The command that starts this rulec from any folder: its script if there is one."""
    script = Path(sys.executable).with_name("rulec")
    return [str(script)] if script.is_file() else [sys.executable, "-m", "rulec"]


def _neovim(command: list[str]) -> str:
    words = ", ".join(map(_quoted, [*command, "lsp"]))
    return f"""\
vim.filetype.add({{ extension = {{ rules = "rulec" }} }})
local function rulec(at) vim.lsp.start({{ name = "rulec", cmd = {{ {words} }}, root_dir = \
vim.fs.dirname(vim.fs.find({{ "rulec.toml", ".git" }}, {{ upward = true, path = \
vim.api.nvim_buf_get_name(at.buf) }})[1]) }}) end
vim.api.nvim_create_autocmd("FileType", {{ pattern = "rulec", callback = rulec }})
"""


def _emacs(command: list[str]) -> str:
    words = " ".join(map(_quoted, [*command, "lsp"]))
    return f"""\
(load {_quoted(str(resources.emacs_mode()))})
(with-eval-after-load 'eglot (add-to-list 'eglot-server-programs '(rulec-mode . ({words}))))
(add-hook 'rulec-mode-hook #'eglot-ensure)
"""


def _helix(command: list[str]) -> str:
    program, *rest = command
    return f"""\
[language-server.rulec]
command = {_quoted(program)}
args = [{", ".join(map(_quoted, [*rest, "lsp"]))}]

[[language]]
name = "rulec"
scope = "source.rulec"
file-types = ["rules"]
roots = ["rulec.toml"]
comment-token = "#"
language-servers = ["rulec"]
auto-format = true
"""


def _vscode(command: list[str]) -> str:
    return f'"rulec.command": {json.dumps(command, ensure_ascii=False)}\n'


def _quoted(text: str) -> str:
    """A string literal valid in Lua, Emacs Lisp and TOML."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


EDITORS: dict[str, Callable[[list[str]], str]] = {
    "neovim": _neovim,
    "emacs": _emacs,
    "helix": _helix,
    "vscode": _vscode,
}
"""Editors by name, each with the function that writes its settings for a command."""


@verb
def command(
    *,
    editor: str | None = option(
        "--settings",
        type=click.Choice([*EDITORS]),
        help="Print the settings for this editor, and exit.",
    ),
    stdio: bool = option(  # noqa: ARG001 - it does so anyway
        "--stdio", is_flag=True, help="Accepted because some editors pass it; it has no effect."
    ),
) -> int:
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

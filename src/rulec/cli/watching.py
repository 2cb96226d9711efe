"""A verb run again whenever a source changes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from time import sleep
from typing import NoReturn

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.verb_class import option
from rulec.cli.output import errors_told
from rulec.diagnostics import RulecError
from rulec.report.text.console import print_remark
from rulec.report.text.terminal_text import counted
from rulec.rulebook.files.source_walk import rules_files
from rulec.settings import FILE_NAME, exclusion, search_path

_LOOK_EVERY_S = 0.5

_CLEAR = "\x1b[2J\x1b[3J\x1b[H"
"""Clears a terminal and its scrollback, and moves the cursor to the top."""

watch_option = option(
    "--watch",
    is_flag=True,
    help="Keep running, and repeat whenever a source changes; Ctrl-C stops.",
)


def watch(run: Callable[[], object], references: Sequence[str]) -> NoReturn:
    """Run something now, and again after each change of files that the references depend on.

    Raises:
        click.UsageError: standard input is among them.
    """
    if "-" in references:
        raise click.UsageError("`-` is standard input and does not change; give a file")
    while True:
        before = _state(references)
        if sys.stdout.isatty():
            click.echo(_CLEAR, nl=False)
        with errors_told():
            run()
        print_remark(f"watching {counted(len(before), 'file')}; Ctrl-C ends it")
        while _state(references) == before:
            sleep(_LOOK_EVERY_S)


def _state(references: Sequence[str]) -> dict[Path, tuple[int, int]]:
    """The relevant files, each with the time of its last change (ns) and its size."""
    state: dict[Path, tuple[int, int]] = {}
    for path in _files(references):
        with suppress(OSError):
            status = path.stat()
            state[path] = status.st_mtime_ns, status.st_size
    return state


def _files(references: Sequence[str]) -> Iterable[Path]:
    """The sources referred to, those beside them and on the search path, and the settings."""
    folders: dict[Path, None] = {}
    excluded = None
    with suppress(RulecError):
        folders |= dict.fromkeys(search_path())
        excluded = exclusion()
    for reference in references:
        with suppress(RulecError):
            for path in lazy.find_sources(reference, tuple(folders), excluded).paths:
                folders[path.parent] = None
                yield path
    for folder in folders:
        yield from rules_files(folder)
    yield from (folder / FILE_NAME for folder in (Path.cwd(), *Path.cwd().parents))

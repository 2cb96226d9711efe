"""Where text goes: results to standard output, the rest to standard error, colour to terminals."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

import click

from rulec.diagnostics import Diagnostic
from rulec.report.diagnostics import render_diagnostics

if TYPE_CHECKING:
    from rich.progress import Progress


def wants_color(stream: TextIO) -> bool:
    """Is the stream a terminal, and has the user not asked for plain text (no-color.org)?"""
    return stream.isatty() and not os.environ.get("NO_COLOR")


def print_result(text: str) -> None:
    """A line of the answer."""
    if _bar is not None and sys.stdout.isatty():
        _print_above(text)
    else:
        click.echo(text, color=wants_color(sys.stdout))


def print_diagnostics(diagnostics: Sequence[Diagnostic]) -> None:
    """Errors and warnings, on standard error; nothing if there are none."""
    if not diagnostics:
        return
    text = render_diagnostics(diagnostics, color=wants_color(sys.stderr)).rstrip("\n")
    if _bar is not None:
        _print_above(text)
    else:
        click.echo(text, err=True, color=True)


_bar: Progress | None = None


def _print_above(text: str) -> None:
    """A terminal shows the bar and the text at once; so the bar has to make room."""
    from rich.text import Text

    assert _bar is not None
    _bar.console.print(Text.from_ansi(text), soft_wrap=True)


@contextmanager
def progress(what: str, total: float | None) -> Iterator[Callable[[float], None]]:
    """A progress bar on a terminal, nothing at all elsewhere.

    Args:
        what: what is going on.
        total: how much there is to do; None if that is not known.

    Yields:
        A function that is told how much is done so far.
    """
    global _bar
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        _bar = bar
        try:
            yield lambda done: bar.update(task, completed=done)
        finally:
            _bar = None

"""Results on standard output, the rest on standard error, colour for terminals."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

import click

from rulec.report.text.outgoing import outgoing
from rulec.report.text.patience import doing
from rulec.report.text.terminal_text import visible, wants_color

if TYPE_CHECKING:
    from rulec.report.text.progress_bar import ProgressBar


PAGE_WIDTH = 80
"""The width of a text that is not shown on a terminal."""


def page_width(stream: TextIO | None = None) -> int:
    """The width of a text on a stream in characters, by default on standard output."""
    if not (stream or sys.stdout).isatty():
        return PAGE_WIDTH
    # Archives and compression, 3 ms: only for a terminal.
    from shutil import get_terminal_size

    return max(40, get_terminal_size((PAGE_WIDTH, 24)).columns)


def print_line(text: str) -> None:
    """Print one line of the answer; any names in it are made visible."""
    print_result(visible(text))


def print_result(text: str, form: str = "text") -> None:
    """Print a part of the answer in a format."""
    text = outgoing(text, form, color=wants_color(sys.stdout))
    if _bar is not None and sys.stdout.isatty():
        _bar.show(text)
    else:
        click.echo(text, color=wants_color(sys.stdout))


def print_remark(text: str) -> None:
    """Print one line on standard error; any names in it are made visible."""
    print_aside(visible(text))


def print_aside(text: str) -> None:
    """Print text on standard error, above the progress bar if there is one."""
    text = outgoing(text, color=True)
    # If standard error cannot be written, the exit status has to suffice.
    with suppress(OSError):
        if _bar is not None:
            _bar.show(text)
        else:
            click.echo(text, err=True, color=True)


_bar: ProgressBar | None = None


@contextmanager
def progress(task: str, total: float | None) -> Iterator[Callable[[float], None]]:
    """A progress bar on a terminal, elsewhere a line now and then.

    ``total`` is None if unknown; then the bar shows a count. Yields a function to be called with
    the amount done so far.
    """
    global _bar
    if not sys.stderr.isatty():
        with doing(task, total) as tell:
            yield tell
        return
    # rich takes 40 ms, and is only needed on terminals.
    from rulec.report.text.progress_bar import progress_bar

    with doing(""), progress_bar(task, total) as _bar:
        try:
            yield _bar.tell
        finally:
            _bar = None

"""Results on standard output, the rest on standard error, colour for terminals."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, TextIO

import click

from rulec.report.text.outgoing import outgoing
from rulec.report.text.patience import doing
from rulec.report.text.terminal_text import visible, wants_color

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


REFRESH_S = 0.2

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


class _Bar:
    """A progress bar, and text that scrolls above it.

    A terminal shows both, so the bar is redrawn below the text. That happens a few times a second,
    however many lines there are.
    """

    def __init__(self, bar: Progress, task: TaskID) -> None:
        self._bar = bar
        self._task = task
        self._lines: list[str] = []
        self._flushed = 0.0

    def show(self, text: str) -> None:
        self._lines.append(text)
        if monotonic() - self._flushed > REFRESH_S:
            self.flush()

    def tell(self, done: float) -> None:
        self._bar.update(self._task, completed=done)

    def flush(self) -> None:
        # rich takes 40 ms, and is only needed on terminals.
        from rich.text import Text

        if self._lines:
            self._bar.console.print(Text.from_ansi("\n".join(self._lines)), soft_wrap=True)
        self._lines.clear()
        self._flushed = monotonic()


_bar: _Bar | None = None


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
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress

    columns = Progress.get_default_columns()
    if total is None:
        columns = (*columns[:2], MofNCompleteColumn())
    with doing(""), Progress(*columns, console=Console(stderr=True), transient=True) as live:
        _bar = _Bar(live, live.add_task(task, total=total))
        try:
            yield _bar.tell
        finally:
            _bar.flush()
            _bar = None

"""Results on standard output, the rest on standard error, colour for terminals.

What long work is doing: a line on standard error after a second, then every one and a half.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, TextIO

import click

from rulec.report.text.outgoing import outgoing
from rulec.report.text.terminal_text import cut, visible, wants_color

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


QUIET = "RULEC_QUIET"
"""The environment variable that turns the lines off, whatever its value."""

_FIRST_S, _AGAIN_S = 1.0, 1.5
_IDLE = frozenset({"lsp", "monitor", "--watch", "-q", "--quiet"})
"""Verbs and options with which a command waits for somebody else, or says nothing."""

_tasks: list[str] = []
"""What is being done, the innermost task last; one without a name shows itself, as a bar does."""


@contextmanager
def patience(arguments: Sequence[str]) -> Iterator[None]:
    """Say what a command with these arguments is doing while it takes long.

    A timer interrupts the program, since a thread would have to be imported at each start. What is
    written goes to the file descriptor at once: a text stream may be in the middle of a line.
    """
    if QUIET in os.environ or not hasattr(signal, "setitimer") or _IDLE.intersection(arguments):
        yield
        return
    begun = monotonic()

    def tell(*_: object) -> None:
        if not _tasks[-1]:
            return
        text = visible(f"rulec: {_tasks[-1]}, for {monotonic() - begun:.0f} s")
        with suppress(OSError):
            os.write(2, f"{text}\n".encode(errors="backslashreplace"))

    before = signal.signal(signal.SIGALRM, tell)
    with doing(f"at work on `{cut(' '.join(('rulec', *arguments)), PAGE_WIDTH // 2)}`"):
        signal.setitimer(signal.ITIMER_REAL, _FIRST_S, _AGAIN_S)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)


@contextmanager
def doing(task: str, total: float | None = None) -> Iterator[Callable[[float], None]]:
    """Name what is being done in a block; yields a function that is told how much is done."""
    place = len(_tasks)
    _tasks.append(task)

    def tell(done: float) -> None:
        _tasks[place] = f"{task}: {f'{done / total:.0%}' if total else f'{done:,.0f} so far'}"

    try:
        yield tell
    finally:
        del _tasks[place:]

"""What long work is doing: a line on standard error after a second, then every one and a half."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from time import monotonic

from rulec.report.text.terminal_text import visible

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
    signal.setitimer(signal.ITIMER_REAL, _FIRST_S, _AGAIN_S)
    try:
        with doing(f"at work on `rulec {' '.join(arguments)}`"):
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

"""A progress bar on a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic

from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress, TaskID
from rich.text import Text

REFRESH_S = 0.2


class ProgressBar:
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
        """Print text above the bar, soon."""
        self._lines.append(text)
        if monotonic() - self._flushed > REFRESH_S:
            self.flush()

    def tell(self, done: float) -> None:
        """Show the amount done so far."""
        self._bar.update(self._task, completed=done)

    def flush(self) -> None:
        """Print at once what has been shown."""
        if self._lines:
            self._bar.console.print(Text.from_ansi("\n".join(self._lines)), soft_wrap=True)
        self._lines.clear()
        self._flushed = monotonic()


@contextmanager
def progress_bar(task: str, total: float | None) -> Iterator[ProgressBar]:
    """A bar on standard error; with a count if the total is unknown."""
    columns = Progress.get_default_columns()
    if total is None:
        columns = (*columns[:2], MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as live:
        bar = ProgressBar(live, live.add_task(task, total=total))
        try:
            yield bar
        finally:
            bar.flush()

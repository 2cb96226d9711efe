"""Work in another thread that is given up between two of its steps."""

from collections.abc import Callable
from contextvars import ContextVar

is_wanted: ContextVar[Callable[[], bool]] = ContextVar("is_wanted", default=lambda: True)
"""Whether the work of this thread still is; a thread that can be cancelled sets it first."""


class CancelledError(Exception):
    """The work is not wanted any more."""


def step() -> None:
    """One of many steps of long work begins. Raises CancelledError."""
    if not is_wanted.get()():
        raise CancelledError

"""Work in another thread that is given up once nobody waits for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar


class CancelledError(Exception):
    """The work is not wanted any more."""


def _wanted() -> bool:
    return True


_is_wanted: ContextVar[Callable[[], bool]] = ContextVar("_is_wanted", default=_wanted)


@contextmanager
def while_wanted(is_wanted: Callable[[], bool]) -> Iterator[None]:
    """Let the work in the block be given up, with CancelledError, between its steps."""
    token = _is_wanted.set(is_wanted)
    try:
        yield
    finally:
        _is_wanted.reset(token)


def step() -> None:
    """One of many steps of long work begins. Raises CancelledError."""
    if not _is_wanted.get()():
        raise CancelledError

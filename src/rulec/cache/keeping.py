"""Whether files of the cache are used: a command line does, who imports rulec does not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_is_on: ContextVar[bool] = ContextVar("_is_on", default=False)


def is_keeping() -> bool:
    """Tell whether trees and machines come from the cache, and go there."""
    return _is_on.get()


@contextmanager
def keeping(*, on: bool = True) -> Iterator[None]:
    """Let trees and machines come from the cache in the block, and go there; or let them not."""
    token = _is_on.set(on)
    try:
        yield
    finally:
        _is_on.reset(token)

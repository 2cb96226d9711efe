"""Whether trees, rulebooks, machines and answers are kept, which only the command line does."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_is_keeping: ContextVar[bool] = ContextVar("_is_keeping", default=False)


def is_keeping() -> bool:
    """Whether they are read from the cache and written to it."""
    return _is_keeping.get()


@contextmanager
def keeping(*, on: bool = True) -> Iterator[None]:
    """Let them be kept in the block, or not."""
    token = _is_keeping.set(on)
    try:
        yield
    finally:
        _is_keeping.reset(token)

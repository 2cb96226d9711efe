"""Whether trees and machines are cached: only by the command line.

What ships with rulec is read by both: nothing is written for that.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal, TypeAlias

Recalled: TypeAlias = Literal["all", "shipped", "none"]

_recalled: ContextVar[Recalled] = ContextVar("_recalled", default="shipped")


def recalled() -> Recalled:
    """What is recalled here: what was kept and what ships, the latter alone, or nothing."""
    return _recalled.get()


def is_keeping() -> bool:
    """Tell whether trees and machines come from the cache, and go there."""
    return recalled() == "all"


def knows_shipped() -> bool:
    """Tell whether trees and machines may be those that ship."""
    return recalled() != "none"


@contextmanager
def recalling(cached: Recalled) -> Iterator[None]:
    """Let trees and machines in the block come from these."""
    token = _recalled.set(cached)
    try:
        yield
    finally:
        _recalled.reset(token)


@contextmanager
def keeping(*, on: bool = True) -> Iterator[None]:
    """Let trees and machines come from the cache in the block, and go there; or from nowhere."""
    with recalling("all" if on else "none"):
        yield

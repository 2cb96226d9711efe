"""Whether trees and machines are cached, which only the command line does.

Entries that ship with rulec are read in any case; for them nothing is written.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Literal, TypeAlias

Recalled: TypeAlias = Literal["all", "shipped", "none"]

_recalled: ContextVar[Recalled] = ContextVar("_recalled", default="shipped")


def recalled() -> Recalled:
    """What may be recalled here: cached and shipped entries, only shipped ones, or nothing."""
    return _recalled.get()


def is_keeping() -> bool:
    """Whether trees and machines are read from the cache and written to it."""
    return recalled() == "all"


def knows_shipped() -> bool:
    """Whether trees and machines may be read from what ships with rulec."""
    return recalled() != "none"


@contextmanager
def recalling(cached: Recalled) -> Iterator[None]:
    """Set what trees and machines may be recalled from in the block."""
    token = _recalled.set(cached)
    try:
        yield
    finally:
        _recalled.reset(token)


@contextmanager
def keeping(*, on: bool = True) -> Iterator[None]:
    """Let trees and machines be cached in the block, or, if not ``on``, recalled from nowhere."""
    with recalling("all" if on else "none"):
        yield

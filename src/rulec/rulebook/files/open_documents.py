"""Sources that are open in an editor and replace the files at their paths."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import MappingProxyType

_NONE: Mapping[str, bytes] = MappingProxyType({})
_IN_FORCE: ContextVar[Mapping[str, bytes]] = ContextVar("open_documents", default=_NONE)


@contextmanager
def shown(documents: Mapping[str, bytes]) -> Iterator[None]:
    """Read sources as they are in an editor; maps real paths to their text."""
    before = _IN_FORCE.set(documents)
    try:
        yield
    finally:
        _IN_FORCE.reset(before)


def open_text(path: Path) -> bytes | None:
    """The text of a file that is open in an editor; None if it is not open."""
    documents = _IN_FORCE.get()
    try:
        return documents.get(os.path.realpath(path)) if documents else None
    except ValueError:  # a null character in it
        return None

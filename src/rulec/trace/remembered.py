"""Results that are kept, to be found once."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Key = TypeVar("Key")
Found = TypeVar("Found")

MOST = 1 << 14
"""How many results are kept, unless otherwise said, before all are discarded."""


class Remembered(dict[Key, Found]):
    """Results by their keys, each found when it is first asked for.

    With ``most`` of them (None for any number) all are discarded, which changes only the time.
    """

    __slots__ = ("_find", "_most")

    def __init__(self, find: Callable[[Key], Found], most: int | None = MOST) -> None:
        self._find, self._most = find, most

    def __missing__(self, key: Key) -> Found:
        found = self._find(key)
        if len(self) == self._most:
            self.clear()
        self[key] = found
        return found

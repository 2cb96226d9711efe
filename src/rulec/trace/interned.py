"""Keys that compare values by identity, for values that exist once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Interned(Generic[T]):
    """A key equal to other keys of the very same object, which it keeps alive.

    The value is never inspected: hashing a layer of a graph by its nodes would take long.
    """

    value: T

    def __hash__(self) -> int:
        return id(self.value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Interned) and self.value is other.value

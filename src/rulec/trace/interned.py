"""Values told apart by identity, where equal ones are one object."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Interned(Generic[T]):
    """A key that equals those of the same object, which it keeps alive.

    It takes no look into the value: to hash a layer of a graph by its nodes takes long.
    """

    value: T

    def __hash__(self) -> int:
        return id(self.value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Interned) and self.value is other.value

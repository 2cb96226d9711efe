"""Columns of traces that stand one after the other in the same arrays, a part for each trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class SharedColumns(Mapping[str, Any]):
    """A trace's part of columns, arrays or pairs of such, which is cut out when it is asked for.

    ``states`` is the part of columns with a value for each state, ``cells`` that of those in
    ``about``, which have some for each object.
    """

    columns: Mapping[str, Any]
    about: frozenset[str]
    states: slice
    cells: slice

    def __getitem__(self, name: str) -> Any:
        own = self.cells if name in self.about else self.states
        column = self.columns[name]
        return (column[0][own], column[1][own]) if isinstance(column, tuple) else column[own]

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __reduce__(self) -> tuple[Any, ...]:
        # Elsewhere the other traces are not wanted
        return dict, (dict(self),)

    def with_next(self, other: Mapping[str, Any]) -> SharedColumns | None:
        """Both parts together, if the other one follows in the same columns."""
        if not isinstance(other, SharedColumns) or other.columns is not self.columns:
            return None
        if self.states.stop != other.states.start or self.cells.stop != other.cells.start:
            return None
        return SharedColumns(
            self.columns,
            self.about,
            slice(self.states.start, other.states.stop),
            slice(self.cells.start, other.cells.stop),
        )

"""Columns of traces that stand one after the other in the same arrays, a part for each trace."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
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

    def is_before(self, other: Mapping[str, Any]) -> bool:
        """Whether the other part follows in the same columns."""
        return (
            isinstance(other, SharedColumns)
            and other.columns is self.columns
            and self.states.stop == other.states.start
            and self.cells.stop == other.cells.start
        )

    def up_to(self, last: SharedColumns) -> SharedColumns:
        """This part and all up to a later one of the same columns."""
        states = slice(self.states.start, last.states.stop)
        return replace(self, states=states, cells=slice(self.cells.start, last.cells.stop))

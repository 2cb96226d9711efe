"""Traces stored one after another in the same arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class SharedColumns(Mapping[str, Any]):
    """One trace's part of shared columns (arrays or pairs of arrays), sliced on access.

    ``states`` is its part of columns with a value per state, ``cells`` its part of those in
    ``about``, which have values per object and state.
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
        # Another process needs only this trace's part
        return dict, (dict(self),)

    def is_before(self, other: Mapping[str, Any]) -> bool:
        """Whether ``other`` is the part that follows this one in the same columns."""
        return (
            type(other) is SharedColumns
            and other.columns is self.columns
            and self.states.stop == other.states.start
            and self.cells.stop == other.cells.start
        )

    def up_to(self, last: SharedColumns) -> SharedColumns:
        """This part and all parts up to a later one of the same columns."""
        states = slice(self.states.start, last.states.stop)
        return replace(self, states=states, cells=slice(self.cells.start, last.cells.stop))

"""Arrow columns of lists: vectors of a fixed length, and lists of any length."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy import int64
from numpy.typing import NDArray

NestedKind = Literal["number", "whole", "text", "bytes"]
"""What the values of a column are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Nested:
    """A column to read: ``listed`` if each row holds a list.

    ``width`` of vectors, 0 for scalars.
    """

    name: str
    kind: NestedKind
    listed: bool = False
    width: int = 0


@dataclass(frozen=True, eq=False, slots=True)
class NestedColumn:
    """The values of all rows of a column, concatenated, and the position where each row begins.

    ``values`` have the type of the column's kind; for vectors, they are the rows of an array.
    """

    starts: NDArray[int64]
    values: Any

    @property
    def row_of(self) -> NDArray[int64]:
        """The row number of each value."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))


class OddColumnError(Exception):
    """A column is not of its kind; ``row`` is the first wrong one, counted from 1."""

    def __init__(self, why: str, row: int | None = None) -> None:
        self.why, self.row = why, row


def nested_column(
    wanted: Nested,
    column: Any,
    arrow: Any,
    readers: Mapping[NestedKind, Callable[[str, Any, Any], Any]],
) -> NestedColumn:
    """The values of a column, converted by the reader of its kind. Raises OddColumnError."""
    array = column.combine_chunks()
    starts = np.arange(len(array) + 1)
    if wanted.listed:
        if not arrow.types.is_list(array.type):
            raise OddColumnError(f"its column `{wanted.name}` has no lists in it")
        _whole(wanted.name, array)
        starts = array.offsets.to_numpy().astype(int64)
        starts, array = starts - starts[0], array.flatten()
    if wanted.width:
        kind = array.type
        if not (arrow.types.is_fixed_size_list(kind) and kind.list_size == wanted.width):
            raise OddColumnError(f"its column `{wanted.name}` has no vectors of {wanted.width}")
        _whole(wanted.name, array)
        array = array.flatten()
    try:
        values = readers[wanted.kind](wanted.name, arrow.chunked_array([array]), arrow)
    except OddColumnError as reason:
        at = None if reason.row is None else (reason.row - 1) // max(wanted.width, 1)
        row = None if at is None else int(np.searchsorted(starts, at, side="right"))
        raise OddColumnError(reason.why, row) from None
    return NestedColumn(starts, values.reshape(-1, wanted.width) if wanted.width else values)


def _whole(name: str, array: Any) -> None:
    if array.null_count:
        row = int(np.argmax(array.is_null().to_numpy(zero_copy_only=False))) + 1
        raise OddColumnError(f"`{name}` has no value", row)

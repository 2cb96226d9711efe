"""A file of a text and rows of integers, which are decoded when asked for.

The file begins with a header: its kind, and the length of the text. The text follows, then the
rows, each with integers of the smallest width that fits, in the byte order of the machine that
wrote it. A file in another byte order has another header.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain
from struct import Struct, error
from typing import Literal, TypeAlias, TypeVar, get_args

_Entry = TypeVar("_Entry", int, bool)

_HEAD = Struct("<16sQ")
_KIND = f"rulec tables 2 {sys.byteorder[0]}".encode()
_ALIGNED = 8
Width: TypeAlias = Literal["B", "b", "h", "i", "q"]
"""Type codes of ``array``: unsigned bytes, and signed integers of 1, 2, 4 and 8 bytes."""

_WIDTHS: tuple[Width, ...] = get_args(Width)

RowPlace: TypeAlias = tuple[Width, int, int]
"""The place of a row: type code, first byte after the text, number of integers."""


@dataclass(slots=True)
class TableWriter:
    """Rows placed one after the other; equal rows share one place."""

    _bytes: bytearray = field(default_factory=bytearray)
    _known: dict[tuple[Width, bytes], RowPlace] = field(default_factory=dict)

    def place(self, row: Iterable[int]) -> RowPlace:
        """Place a row of integers of at most 64 bits."""
        numbers = tuple(row)
        least, most = min(numbers, default=0), max(numbers, default=0)
        code = next(code for code in _WIDTHS if _holds(code, least) and _holds(code, most))
        data = array(code, numbers).tobytes()
        if (code, data) not in self._known:
            self._known[code, data] = code, len(self._bytes), len(numbers)
            self._bytes += data + bytes(-len(data) % _ALIGNED)
        return self._known[code, data]

    def place_rows(self, rows: Iterable[Iterable[int]]) -> RowPlace:
        """Place rows, one after the other."""
        return self.place(chain.from_iterable(rows))

    def file(self, text: bytes) -> bytes:
        """The whole file."""
        rest = text + bytes(-len(text) % _ALIGNED) + self._bytes
        return _HEAD.pack(_KIND, len(text)) + rest


def _holds(code: Width, number: int) -> bool:
    if code == "B":
        return 0 <= number < 1 << 8
    bits = 8 * array(code).itemsize - 1
    return -(1 << bits) <= number < 1 << bits


class RowTables:
    """A file's text, and its rows by their places.

    ``data`` is the whole file. Raises ValueError if it is not such a file.
    """

    def __init__(self, data: bytes) -> None:
        view = memoryview(data)
        try:
            kind, length = _HEAD.unpack_from(view)
        except error:
            raise ValueError("it is too short") from None
        rest = view[_HEAD.size :]
        if kind.rstrip(b"\0") != _KIND:
            raise ValueError("it is not what was written")
        self.text = bytes(rest[:length])
        self._rows = rest[length + -length % _ALIGNED :]
        self._known: dict[RowPlace, tuple[int, ...]] = {}

    def row(self, place: RowPlace) -> tuple[int, ...]:
        """The integers at a place; the same object each time. ValueError for an invalid place."""
        if place not in self._known:
            self._known[place] = tuple(self.view(place).tolist())
        return self._known[place]

    def rows(self, place: RowPlace, width: int) -> tuple[tuple[int, ...], ...]:
        """The rows at a place, all of this width. Raises ValueError if they do not fit."""
        return _of_width(self.row(place), width)

    def truths(self, place: RowPlace, width: int) -> tuple[tuple[bool, ...], ...]:
        """Rows of truth values, written as 0 and 1."""
        return _of_width(tuple(map(bool, self.row(place))), width)

    def view(self, place: RowPlace) -> memoryview[int]:
        """The integers at a place, without a copy. Raises ValueError for an invalid place."""
        code, first, count = place
        if first < 0 or count < 0:
            raise ValueError("a row has no place")
        last = first + count * array(code).itemsize
        if last > len(self._rows):
            raise ValueError("a row is cut off")
        return self._rows[first:last].cast(code)


def _of_width(row: Sequence[_Entry], width: int) -> tuple[tuple[_Entry, ...], ...]:
    if width <= 0 or len(row) % width:
        raise ValueError("rows do not fit their width")
    return tuple([tuple(row[start : start + width]) for start in range(0, len(row), width)])

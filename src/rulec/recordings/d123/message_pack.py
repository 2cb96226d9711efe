"""MessagePack (https://github.com/msgpack/msgpack/blob/master/spec.md), read without running any.

Values are those of Python; arrays are lists. Times and other extensions are refused: nothing that
is read here has them.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

DEEPEST = 16
"""Values within values; what is read here has four levels."""


class OddPackError(Exception):
    """The bytes are no MessagePack, or of a kind that is not read."""


def unpacked(data: bytes) -> Any:
    """The only value in the bytes. Raises OddPackError."""
    reader = _Reader(data)
    try:
        value = reader.value(0)
    except (struct.error, IndexError, UnicodeDecodeError):
        raise OddPackError from None
    if reader.at != len(data):
        raise OddPackError
    return value


class _Reader:
    def __init__(self, data: bytes) -> None:
        self._data = data
        self.at = 0

    def value(self, depth: int) -> Any:
        kind = self._data[self.at]
        self.at += 1
        if kind <= 0x7F:
            return kind
        if kind >= 0xE0:
            return kind - 0x100
        if kind in _CONSTANTS:
            return _CONSTANTS[kind]
        if kind in _NUMBERS:
            return self._number(_NUMBERS[kind])
        length, read = self._length_of(kind)
        return read(self, length, depth)

    def _length_of(self, kind: int) -> tuple[int, Callable[[_Reader, int, int], Any]]:
        for first, last, read in _SHORT:
            if first <= kind <= last:
                return kind - first, read
        if kind not in _LONG:
            raise OddPackError
        form, read = _LONG[kind]
        return int(self._number(form)), read

    def _number(self, form: str) -> Any:
        (found,) = struct.unpack_from(form, self._data, self.at)
        self.at += struct.calcsize(form)
        return found

    def text(self, length: int, _: int) -> str:
        return self.binary(length, 0).decode()

    def binary(self, length: int, _: int) -> bytes:
        found = self._data[self.at : self.at + length]
        if len(found) < length:
            raise OddPackError
        self.at += length
        return found

    def array(self, length: int, depth: int) -> list[Any]:
        self._check(length, depth)
        return [self.value(depth + 1) for _ in range(length)]

    def map(self, length: int, depth: int) -> dict[str | bytes | int, Any]:
        self._check(2 * length, depth)
        found: dict[str | bytes | int, Any] = {}
        for _ in range(length):
            key = self.value(depth + 1)
            if not isinstance(key, str | bytes | int):
                raise OddPackError
            found[key] = self.value(depth + 1)
        return found

    def _check(self, length: int, depth: int) -> None:
        """Each value takes a byte, so that there cannot be more of them than bytes."""
        if depth >= DEEPEST or length > len(self._data) - self.at:
            raise OddPackError


_CONSTANTS = {0xC0: None, 0xC2: False, 0xC3: True}
_NUMBERS = {
    0xCA: ">f",
    0xCB: ">d",
    0xCC: ">B",
    0xCD: ">H",
    0xCE: ">I",
    0xCF: ">Q",
    0xD0: ">b",
    0xD1: ">h",
    0xD2: ">i",
    0xD3: ">q",
}
_SHORT: tuple[tuple[int, int, Callable[[_Reader, int, int], Any]], ...] = (
    (0x80, 0x8F, _Reader.map),
    (0x90, 0x9F, _Reader.array),
    (0xA0, 0xBF, _Reader.text),
)
"""First and last byte of kinds that have their length within."""

_LONG: dict[int, tuple[str, Callable[[_Reader, int, int], Any]]] = {
    0xC4: (">B", _Reader.binary),
    0xC5: (">H", _Reader.binary),
    0xC6: (">I", _Reader.binary),
    0xD9: (">B", _Reader.text),
    0xDA: (">H", _Reader.text),
    0xDB: (">I", _Reader.text),
    0xDC: (">H", _Reader.array),
    0xDD: (">I", _Reader.array),
    0xDE: (">H", _Reader.map),
    0xDF: (">I", _Reader.map),
}
"""Kind -> how its length is written."""

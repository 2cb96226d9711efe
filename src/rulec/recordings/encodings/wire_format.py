"""Protocol Buffers' wire format, decoded by tables of fields, safe against malicious files.

See https://protobuf.dev/programming-guides/encoding/. Only fields in the tables are decoded.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat

MOST_VALUES = 1_000_000
"""Limit on the values in one field of the outermost message, about 300 MB of memory."""

DEEPEST = 64
"""Limit on the depth of nested messages."""

_LONGEST_VARINT = 10
_GOES_ON = 0x80
_ALL_BITS = (1 << 64) - 1
_VARINT, _EIGHT_BYTES, _COUNTED, _FOUR_BYTES = 0, 1, 2, 5
_SIZES: Mapping[int, int] = {_EIGHT_BYTES: 8, _FOUR_BYTES: 4}

Kind = Literal["int", "uint", "sint", "bool", "double", "float", "text", "bytes"]
_WIRE_TYPES: Mapping[Kind, int] = {
    "int": _VARINT,
    "uint": _VARINT,
    "sint": _VARINT,
    "bool": _VARINT,
    "double": _EIGHT_BYTES,
    "float": _FOUR_BYTES,
    "text": _COUNTED,
    "bytes": _COUNTED,
}
_DOUBLE, _FLOAT = struct.Struct("<d"), struct.Struct("<f")


class Words(NamedTuple):
    """An enumeration: words by number, and the word for ``other`` numbers if these are allowed."""

    by_number: Mapping[int, str]
    other: str = ""


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message: its name, its content, and whether it is repeated (``many``)."""

    name: str
    holds: Kind | Words | Table
    many: bool = False


Table: TypeAlias = Mapping[int, Field]
"""A message type: its wanted fields by number."""


@dataclass(frozen=True, slots=True)
class Message:
    """The fields of a message, in the order of the file."""

    fields: tuple[WireField, ...]


Value: TypeAlias = "int | float | bool | str | bytes | Message"


class WireField(NamedTuple):
    """A value of a field, and the byte where it begins."""

    field: Field
    value: Value
    place: int


@dataclass(slots=True)
class WireFile:
    """A file's bytes, or those from byte ``begin`` on. Its methods raise RulecError R0610."""

    data: bytes
    path: Path
    form: BinaryFormat
    begin: int = 0
    _n_values: int = 0

    def fields(self, table: Table) -> Iterator[WireField]:
        """The fields of the outermost message, in order."""
        return self._fields(table, 0, len(self.data), 0)

    def wrong(self, why: str, place: int, expected: str = "") -> RulecError:
        """The error at a byte."""
        expected = expected and f"expected {expected}"
        return self.form.refused(self.path, why, self.begin + place, expected=expected)

    def _fields(self, table: Table, place: int, end: int, depth: int) -> Iterator[WireField]:
        if depth > DEEPEST:
            raise self.wrong(f"a message lies in more than {DEEPEST} others", place)
        known: set[int] = set()
        while place < end:
            begin = place
            key, place = self._varint(place, end)
            number, wire_type = divmod(key, 8)
            place, stop = self._content(wire_type, place, end, begin)
            field = table.get(number)
            if field is not None:
                if depth == 0:
                    self._n_values = 0
                if number in known and not field.many:
                    raise self.wrong(f"a message has a second field {number}", begin)
                known.add(number)
                if not _fits(field, wire_type):
                    expected = str(_wire_type(field.holds))
                    raise self.wrong(
                        f"field {number} has the wire type {wire_type}", begin, expected
                    )
                yield from self._values(field, wire_type, place, stop, depth)
            elif number == 0:
                raise self.wrong("there is a field of the number 0, which none has", begin)
            place = stop

    def _content(self, wire_type: int, place: int, end: int, begin: int) -> tuple[int, int]:
        """The positions where the value of a field begins and ends."""
        if wire_type == _VARINT:
            return place, self._varint(place, end)[1]
        if wire_type == _COUNTED:
            count, place = self._varint(place, end)
        elif wire_type in _SIZES:
            count = _SIZES[wire_type]
        else:
            raise self.wrong(f"a field has the wire type {wire_type}", begin, "0, 1, 2 or 5")
        if count > end - place:
            raise self._ends_early(begin)
        return place, place + count

    def _values(
        self, field: Field, wire_type: int, place: int, stop: int, depth: int
    ) -> Iterator[WireField]:
        begin, holds = place, field.holds
        packed = wire_type != _wire_type(holds)
        # A packed value may be empty
        while not packed or place < stop:
            self._n_values += 1
            if self._n_values > MOST_VALUES:
                raise self.wrong(f"a message has more than {MOST_VALUES:,} values in it", begin)
            if isinstance(holds, Mapping):
                fields = tuple(self._fields(holds, place, stop, depth + 1))
                yield WireField(field, Message(fields), place)
                return
            value, after = self._value(field, place, stop)
            yield WireField(field, value, place)
            place = after
            if not packed:
                return

    def _value(self, field: Field, place: int, stop: int) -> tuple[Value, int]:
        match field.holds:
            case "bytes":
                return self.data[place:stop], stop
            case "text":
                return self._text(field, place, stop), stop
            case "double" | "float" as kind:
                number = _DOUBLE if kind == "double" else _FLOAT
                if stop - place < number.size:
                    raise self._ends_early(place)
                return number.unpack_from(self.data, place)[0], place + number.size
        bits, after = self._varint(place, stop)
        match field.holds:
            case "bool":
                return bits != 0, after
            case "uint":
                return bits, after
            case "sint":
                return (bits >> 1) ^ -(bits & 1), after
            case Words(by_number, other):
                word = by_number.get(_signed(bits), other)
                if not word:
                    why = f"`{field.name}` has the unknown value {_signed(bits)}"
                    raise self.wrong(why, place, f"one of {', '.join(map(str, by_number))}")
                return word, after
        return _signed(bits), after

    def _text(self, field: Field, place: int, stop: int) -> str:
        try:
            return self.data[place:stop].decode()
        except UnicodeDecodeError as reason:
            why = f"the text of `{field.name}` is not UTF-8"
            raise self.wrong(why, place + reason.start) from None

    def _varint(self, place: int, end: int) -> tuple[int, int]:
        """The 64-bit number that begins at a byte, and the position after it."""
        if place < end and self.data[place] < _GOES_ON:
            return self.data[place], place + 1
        value = shift = 0
        for at in range(place, min(end, place + _LONGEST_VARINT)):
            byte = self.data[at]
            value |= (byte & 0x7F) << shift
            if byte < _GOES_ON:
                return value & _ALL_BITS, at + 1
            shift += 7
        if place + _LONGEST_VARINT <= end:
            raise self.wrong(f"a number has more than {_LONGEST_VARINT} bytes", place)
        raise self._ends_early(place)

    def _ends_early(self, place: int) -> RulecError:
        why = "a value begins that has more bytes than are left; it has been cut short, or is none"
        return self.wrong(why, place)


def wire_file(path: Path, form: BinaryFormat) -> WireFile:
    """The bytes of a file.

    Raises RulecError R0610 if it is empty or too large, R0701 if it cannot be read.
    """
    data = form.content(path)
    if not data:
        raise form.refused(path, "it is empty")
    return WireFile(data, path, form)


def _wire_type(holds: Kind | Words | Table) -> int:
    if isinstance(holds, str):
        return _WIRE_TYPES[holds]
    return _VARINT if isinstance(holds, Words) else _COUNTED


def _fits(field: Field, wire_type: int) -> bool:
    """Whether a wire type is the field's own, or that of many numbers packed into one value."""
    return wire_type == _wire_type(field.holds) or (field.many and wire_type == _COUNTED)


def _signed(bits: int) -> int:
    """A number in two's complement, as signed."""
    return bits - (bits >> 63 << 64)

"""Protocol Buffers' wire format, decoded by tables of fields, safe against malicious files.

See https://protobuf.dev/programming-guides/encoding/. Only fields in the tables are decoded.

Tables are made from a short form of schemas. A message is ``Name: 1 field Type, 2 other Type*``:
numbers, names and types, with ``*`` for a repeated field, and ``-`` for the name of a field that
belongs to the message itself. The name of a message alone stands for its fields. An enumeration is
``Name = word word``, numbered from 0 with ``-`` for unused numbers, or ``Name = 3 word, 7 word``.
Indented lines go on with the one before.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat

_ENTRY = re.compile(r"(\w+)(:| =) ?(.*)", re.DOTALL)

MOST_VALUES = 1_000_000
"""Limit on the values in one field of the outermost message, about 300 MB of memory."""

DEEPEST = 64
"""Limit on the depth of nested messages."""

_LONGEST_VARINT = 10
_GOES_ON = 0x80
_ALL_BITS = (1 << 64) - 1
_VARINT, _EIGHT_BYTES, _COUNTED, _FOUR_BYTES = 0, 1, 2, 5

Kind = Literal["int", "uint", "sint", "bool", "double", "float", "text", "bytes"]
_WIRE_TYPES: Mapping[Kind, int] = {
    **dict.fromkeys(get_args(Kind), _VARINT),
    "double": _EIGHT_BYTES,
    "float": _FOUR_BYTES,
    "text": _COUNTED,
    "bytes": _COUNTED,
}
_NUMBERS = {_EIGHT_BYTES: struct.Struct("<d"), _FOUR_BYTES: struct.Struct("<f")}


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
    wire_type: int = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        wire_type = _VARINT if isinstance(self.holds, Words) else _COUNTED
        if isinstance(self.holds, str):
            wire_type = _WIRE_TYPES[self.holds]
        object.__setattr__(self, "wire_type", wire_type)


Table: TypeAlias = Mapping[int, Field]
"""A message type: its wanted fields by number."""


@dataclass(frozen=True, slots=True)
class Message:
    """The fields of a message, in the order of the file."""

    fields: tuple[WireField, ...]


Value: TypeAlias = "int | float | bool | str | bytes | Message"


Fields: TypeAlias = Mapping[str, Any]
"""Field -> its value; a list if the field is repeated, and no entry if it is empty."""


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
            number, wire_type = key >> 3, key & 7
            bits, place, stop = self._content(wire_type, place, end, begin)
            field = table.get(number)
            if field is None:
                if number == 0:
                    raise self.wrong("there is a field of the number 0, which none has", begin)
                place = stop
                continue
            if depth == 0:
                self._n_values = 0
            if number in known and not field.many:
                raise self.wrong(f"a message has a second field {number}", begin)
            known.add(number)
            if wire_type == field.wire_type:
                self._count(place)
                yield WireField(field, self._value(field, bits, place, stop, depth), place)
            elif field.many and wire_type == _COUNTED:
                yield from self._packed(field, place, stop)
            else:
                expected = str(field.wire_type)
                raise self.wrong(f"field {number} has the wire type {wire_type}", begin, expected)
            place = stop

    def _content(self, wire_type: int, place: int, end: int, begin: int) -> tuple[int, int, int]:
        """The bits of a number of variable length, and where a value begins and ends."""
        if wire_type == _VARINT:
            bits, stop = self._varint(place, end)
            return bits, place, stop
        if wire_type == _COUNTED:
            count, place = self._varint(place, end)
        elif wire_type in _NUMBERS:
            count = _NUMBERS[wire_type].size
        else:
            raise self.wrong(f"a field has the wire type {wire_type}", begin, "0, 1, 2 or 5")
        if count > end - place:
            raise self._ends_early(begin)
        return 0, place, place + count

    def _count(self, begin: int) -> None:
        self._n_values += 1
        if self._n_values > MOST_VALUES:
            raise self.wrong(f"a message has more than {MOST_VALUES:,} values in it", begin)

    def _packed(self, field: Field, place: int, stop: int) -> Iterator[WireField]:
        """Many numbers in one value."""
        begin = place
        while place < stop:
            self._count(begin)
            bits = 0
            if field.wire_type == _VARINT:
                bits, after = self._varint(place, stop)
            elif (after := place + _NUMBERS[field.wire_type].size) > stop:
                raise self._ends_early(place)
            yield WireField(field, self._value(field, bits, place, after, 0), place)
            place = after

    def _value(self, field: Field, bits: int, place: int, stop: int, depth: int) -> Value:
        holds, wire_type = field.holds, field.wire_type
        if wire_type in _NUMBERS:
            number: float = _NUMBERS[wire_type].unpack_from(self.data, place)[0]
            return number
        if isinstance(holds, Words):
            word = holds.by_number.get(_signed(bits), holds.other)
            if not word:
                why = f"`{field.name}` has the unknown value {_signed(bits)}"
                raise self.wrong(why, place, f"one of {', '.join(map(str, holds.by_number))}")
            return word
        if wire_type == _COUNTED:
            if not isinstance(holds, str):
                return Message(tuple(self._fields(holds, place, stop, depth + 1)))
            return self.data[place:stop] if holds == "bytes" else self._text(field, place, stop)
        match holds:
            case "bool":
                return bits != 0
            case "uint":
                return bits
            case "sint":
                return (bits >> 1) ^ -(bits & 1)
        return _signed(bits)

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


def fields_of(items: Iterable[WireField]) -> dict[str, Any]:
    """The fields of a message."""
    fields: dict[str, Any] = {}
    for item in items:
        value: Any = item.value
        if isinstance(value, Message):
            value = fields_of(value.fields)
        if item.field.many:
            fields.setdefault(item.field.name, []).append(value)
        else:
            fields[item.field.name] = value
    return fields


def _signed(bits: int) -> int:
    """A number in two's complement, as signed."""
    return bits - (bits >> 63 << 64)


def tables_of(schema: str, other: str, more: Mapping[str, Words]) -> Mapping[str, Table]:
    """The messages of a schema by name.

    ``other`` is the word for numbers that an enumeration lacks, empty if these are errors; ``more``
    are enumerations that the schema refers to. Raises ValueError or KeyError for a faulty schema.
    """
    types: dict[str, Kind | Words | Table] = {kind: kind for kind in get_args(Kind)}
    types |= more
    messages: dict[str, dict[int, Field]] = {}
    contents = {}
    for entry in re.split(r"\n(?=\S)", schema.strip()):
        match = _ENTRY.fullmatch(entry)
        if match is None:
            raise ValueError(entry)
        name, mark, content = match.groups()
        if mark == ":":
            contents[name], types[name] = content, messages.setdefault(name, {})
        else:
            types[name] = words_of(content, other)
    for name, content in contents.items():
        for part in content.split(","):
            match part.split():
                case [number, field, kind]:
                    holds, many = types[kind.removesuffix("*")], kind.endswith("*")
                    messages[name][int(number)] = Field(field.strip("-"), holds, many)
                case [included]:
                    messages[name] |= messages[included]
                case [_, *_]:
                    raise ValueError(part)
    return messages


def words_of(content: str, other: str) -> Words:
    """An enumeration from what stands behind its name."""
    if content[:1].isdigit():
        pairs = (pair.split() for pair in content.split(","))
        return Words({int(number): word for number, word in pairs}, other)
    words = enumerate(content.split())
    return Words({number: word for number, word in words if word != "-"}, other)

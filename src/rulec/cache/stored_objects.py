"""Serialisation of frozen objects: JSON with rows of integers beside it.

A file is a list of parts, each after the parts that it consists of; equal parts are stored once.
Plain values are apart from them, and have negative numbers.
Reading makes objects of the listed kinds and nothing else, and checks no more than their number of
parts: what is read has to be what this rulec wrote.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from fractions import Fraction
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.row_tables import RowTables, TableWriter
from rulec.garbage_collection import no_garbage_collection

DAMAGED = (ValueError, TypeError, LookupError, ArithmeticError, RecursionError)
"""What reading may raise if a file is not what was written."""


@dataclass(frozen=True, slots=True)
class ObjectKind:
    """How objects of one kind are split into parts, and rebuilt from them."""

    parts: Callable[[Any], Iterable[object]]
    make: Callable[..., object]


def kind_of_fields(cls: type, without: Sequence[str] = ()) -> ObjectKind:
    """The kind of a dataclass; fields ``without`` are left out, come last and have defaults."""
    own = [field for field in fields(cls) if field.init and field.name not in without]
    named = [field.name for field in own if field.kw_only]
    names = [*(field.name for field in own if not field.kw_only), *named]
    first = len(names) - len(named)

    def with_names(*parts: object) -> object:
        return cls(*parts[:first], **dict(zip(named, parts[first:], strict=True)))

    make = with_names if named else cls
    if len(names) == 1:
        return ObjectKind(lambda item: (getattr(item, names[0]),), make)
    return ObjectKind(attrgetter(*names), make)


def kinds_of_fields(classes: Iterable[type]) -> dict[type, ObjectKind]:
    """The kinds of dataclasses that are stored with all their fields."""
    return {cls: kind_of_fields(cls) for cls in classes}


_BUILT_IN: dict[type, ObjectKind] = {
    tuple: ObjectKind(tuple, lambda *items: items),
    dict: ObjectKind(
        lambda item: [part for pair in item.items() for part in pair],
        lambda *items: dict(zip(items[::2], items[1::2], strict=True)),
    ),
    frozenset: ObjectKind(sorted, lambda *items: frozenset(items)),
    bytes: ObjectKind(lambda item: [tuple(item)], bytes),
    Fraction: ObjectKind(attrgetter("numerator", "denominator"), Fraction),
}
_PLAIN = frozenset({type(None), bool, int, float, str})


class ObjectCodec:
    """Writes and reads objects of the given kinds, of built-in ones, and plain values."""

    def __init__(self, kinds: Mapping[type, ObjectKind]) -> None:
        all_kinds = {**_BUILT_IN, **kinds}
        self._kinds = {
            cls: (number, kind.parts) for number, (cls, kind) in enumerate(all_kinds.items())
        }
        # A read-only view of a dictionary is read back as one: views cannot be pickled.
        self._kinds[MappingProxyType] = self._kinds[dict]
        self._make = [kind.make for kind in all_kinds.values()]

    def written(self, item: object, given: Sequence[object] = ()) -> bytes:
        """The file of an object. It must be read with equal ``given`` objects.

        Raises TypeError for an object of another kind.
        """
        with no_garbage_collection():
            return _Writer(self._kinds, given).file(item)

    def read(self, tables: RowTables, given: Sequence[object] = ()) -> Any:
        """The object in a file. Raises one of ``DAMAGED`` if there is none."""
        text = json.loads(tables.text)
        first, n_made, numbers = len(given), text["made"], tables.row(tuple(text["parts"]))
        if text["given"] != first or not 0 < n_made <= len(numbers):
            raise ValueError("it was written with other objects")
        values = [_value(value, tables) for value in text["values"]]
        made = [*given, *[None] * n_made, *values[::-1]]
        part, place = made.__getitem__, 0
        with no_garbage_collection():
            for number in range(first, first + n_made):
                end = place + numbers[place]
                make = self._make[numbers[place + 1]]
                made[number] = make(*map(part, numbers[place + 2 : end]))
                place = end
        return made[first + n_made - 1]


@dataclass(frozen=True, slots=True)
class KeptObjects:
    """Objects in the cache."""

    files: KeptBytes
    codec: ObjectCodec

    def recall(self, key: str, given: Sequence[object] = ()) -> Any:
        """The object cached under a key; None if there is none."""
        data = self.files.recall(key)
        if data is not None:
            with suppress(*DAMAGED):
                return self.codec.read(RowTables(data), given)
        return None

    def keep(self, contents: Mapping[str, object], given: Sequence[object] = ()) -> None:
        """Cache an object under each key, if possible."""
        if self.files.can_be:
            with suppress(TypeError, RecursionError):
                written = self.codec.written
                self.files.keep({key: written(item, given) for key, item in contents.items()})


def _value(value: Any, tables: RowTables) -> object:
    match value:
        case [code, first, count]:
            return tables.row((code, first, count))
        case [code, first, count, width, are_truths]:
            return (tables.truths if are_truths else tables.rows)((code, first, count), width)
    return value


class _Writer:
    """The parts placed so far: plain values, and objects built from parts."""

    def __init__(
        self,
        kinds: Mapping[type, tuple[int, Callable[[Any], Iterable[object]]]],
        given: Sequence[object],
    ) -> None:
        self._kinds = kinds
        self._n_given = len(given)
        self._given = {id(part): number for number, part in enumerate(given)}
        self._tables = TableWriter()
        # Values are numbered from the end, by negative numbers.
        self._values: dict[tuple[type, object], int] = {}
        self._parts: dict[tuple[int, ...], int] = {}

    def file(self, item: object) -> bytes:
        """The whole file."""
        if self._number(item) < 0:
            raise TypeError("a plain value")
        numbers: list[int] = []
        for part in self._parts:
            numbers += (len(part) + 1, *part)
        text = {
            "given": self._n_given,
            "made": len(self._parts),
            "values": [value for _, value in self._values],
            "parts": self._tables.place(numbers),
        }
        return self._tables.file(json.dumps(text, separators=(",", ":")).encode())

    def _number(self, item: Any) -> int:
        cls = type(item)
        if cls in _PLAIN:
            return self._value(cls, item)
        if id(item) in self._given:
            return self._given[id(item)]
        if cls is tuple and (rows := self._rows(item)) is not None:
            return self._value(tuple, rows)
        known = self._kinds.get(cls)
        if known is None:
            raise TypeError(f"a {cls.__name__}")
        number, parts = known
        values, own = self._values, [number]
        for part in parts(item):
            kind = type(part)
            # As ``_value``, without a call for each of many thousands.
            own.append(
                values.setdefault((kind, part), ~len(values))
                if kind in _PLAIN
                else self._number(part)
            )
        return self._parts.setdefault(tuple(own), self._n_given + len(self._parts))

    def _value(self, cls: type, value: object) -> int:
        return self._values.setdefault((cls, value), ~len(self._values))

    def _rows(self, item: tuple[Any, ...]) -> tuple[object, ...] | None:
        """The place of a tuple's integers, or of rows of integers or Booleans; None if neither."""
        if not item:
            return None
        if type(item[0]) is int:
            return self._tables.place(item) if {*map(type, item)} == {int} else None
        if type(item[0]) is not tuple or not item[0]:
            return None
        if not all(type(inner) is tuple and len(inner) == len(item[0]) for inner in item):
            return None
        kinds = {type(entry) for row in item for entry in row}
        if kinds == {int} or kinds == {bool}:
            return (*self._tables.place_rows(item), len(item[0]), kinds == {bool})
        return None

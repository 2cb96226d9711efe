"""Serialisation of cached compiled rulebooks: JSON with rows of integers beside it.

A file is a list of parts, each after the parts that it consists of; equal parts are stored once,
since rules share most of them. Nothing is checked except that this rulec wrote the file.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from operator import attrgetter
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.bundle.mapped_tables import MappedTables, TableWriter
from rulec.automata.bundle.stored_prefixes import CutTables, StoredPrefixes
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.diagnostics import Diagnostic, Fix, Label, Offer, SourceLocation
from rulec.logic import formula as ltl
from rulec.rulebook import rulebook_model as model
from rulec.rulebook.files.search_path import Dependency
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary


@dataclass(frozen=True, slots=True)
class Compilation:
    """The content of a file: its dependencies, the warnings, and the rulebook.

    ``stamp`` is a digest of the source and of the compiler. ``day`` is the day whose law applies,
    if it is today by default; empty if the source or the user sets it.
    """

    stamp: str
    day: str
    dependencies: tuple[Dependency, ...]
    warnings: tuple[Diagnostic, ...] = ()
    rulebook: CompiledRulebook | None = None


@dataclass(frozen=True, slots=True)
class _Kind:
    """How objects of one kind are split into parts, and rebuilt from them."""

    parts: Callable[[Any], Iterable[object]]
    make: Callable[..., object]


def _of_fields(cls: type, without: Sequence[str] = ()) -> _Kind:
    """The kind of a dataclass; fields ``without`` are left out, come last and have defaults."""
    names = [field.name for field in fields(cls) if field.init and field.name not in without]
    if len(names) == 1:
        return _Kind(lambda item: (getattr(item, names[0]),), cls)
    return _Kind(attrgetter(*names), cls)


def _rulebook(*parts: Any) -> CompiledRulebook:
    """A rulebook from its stored parts, with the machines for cut traces as the last one."""
    return replace(CompiledRulebook(*parts[:-1]), prefixes=parts[-1])


_RULEBOOK = _of_fields(CompiledRulebook, ["origin", "recompile", "too_large"])
_KINDS: dict[type, _Kind] = {
    tuple: _Kind(tuple, lambda *items: items),
    dict: _Kind(
        lambda item: [part for pair in item.items() for part in pair],
        lambda *items: dict(zip(items[::2], items[1::2], strict=True)),
    ),
    frozenset: _Kind(sorted, lambda *items: frozenset(items)),
    bytes: _Kind(lambda item: [tuple(item)], bytes),
    Fraction: _Kind(attrgetter("numerator", "denominator"), Fraction),
    ltl.UnaryOperator: _Kind(lambda item: [item.value], ltl.UnaryOperator),
    ltl.BinaryOperator: _Kind(lambda item: [item.value], ltl.BinaryOperator),
    ltl.Bound: _of_fields(ltl.Bound, ["span"]),
    CompiledRulebook: _Kind(_RULEBOOK.parts, _rulebook),
    **{
        cls: _of_fields(cls)
        for cls in (
            *(ltl.Atom, ltl.QuantityTerm, ltl.Count, ltl.Comparison, ltl.Same, ltl.Constant),
            *(ltl.Unary, ltl.Binary, Read, Threshold, NumberRead, MealyMonitor),
            *(CompiledRule, CompiledAxiom, CutTables, StoredPrefixes, Compilation, Dependency),
            *(model.Variable, model.Exemption, model.RuleParts, model.SourceFile),
            *(ObjectType, Enumeration, Signal, Quantity, Vocabulary),
            *(SourceLocation, Label, Fix, Offer, Diagnostic),
        )
    },
}
_NUMBERS = {cls: number for number, cls in enumerate(_KINDS)}
_MAKE = [kind.make for kind in _KINDS.values()]


def written(known: Compilation, given: Sequence[object] = ()) -> bytes:
    """The file of a compilation. It must be read with equal ``given`` objects."""
    return _Writer(given).file(known)


def compilation_in(tables: MappedTables, given: Sequence[object] = ()) -> Compilation:
    """The compilation in a file. Raises ValueError, TypeError or LookupError if there is none."""
    text = json.loads(tables.text)
    made = [*given, *[_value(value, tables) for value in text["values"]]]
    numbers, part, place = tables.row(tuple(text["parts"])), made.__getitem__, 0
    while place < len(numbers):
        end = place + numbers[place]
        made.append(_MAKE[numbers[place + 1]](*map(part, numbers[place + 2 : end])))
        place = end
    compilation = made[-1]
    if not isinstance(compilation, Compilation):
        raise ValueError("it says nothing of a rulebook")
    return compilation


def _value(value: Any, tables: MappedTables) -> object:
    match value:
        case [code, first, count]:
            return tables.row((code, first, count))
        case [code, first, count, width, are_truths]:
            return (tables.truths if are_truths else tables.rows)((code, first, count), width)
    return value


class _Writer:
    """The parts placed so far: plain values, which come first, and objects built from parts."""

    def __init__(self, given: Sequence[object]) -> None:
        self._n_given = len(given)
        self._given = {id(part): number for number, part in enumerate(given)}
        self._tables = TableWriter()
        # Values have negative numbers until their total count is known.
        self._values: dict[tuple[type, object], int] = {}
        self._parts: dict[tuple[int, ...], int] = {}

    def file(self, known: Compilation) -> bytes:
        """The whole file."""
        self._number(known)
        n_values = len(self._values)
        numbers: list[int] = []
        for kind, *parts in self._parts:
            own = [self._n_given + ~n if n < 0 else self._behind(n, n_values) for n in parts]
            numbers += [len(own) + 2, kind, *own]
        text = {
            "values": [value for _, value in self._values],
            "parts": self._tables.place(numbers),
        }
        return self._tables.file(json.dumps(text, separators=(",", ":")).encode())

    def _behind(self, number: int, n_values: int) -> int:
        return number if number < self._n_given else number + n_values

    def _number(self, item: object) -> int:
        if id(item) in self._given:
            return self._given[id(item)]
        if item is None or isinstance(item, bool | int | float | str):
            return self._value(type(item), item)
        if isinstance(item, tuple) and (rows := self._rows(item)) is not None:
            return self._value(tuple, rows)
        cls = type(item) if type(item) in _KINDS else dict  # else a view of a dict
        part = (_NUMBERS[cls], *map(self._number, _KINDS[cls].parts(item)))
        return self._parts.setdefault(part, self._n_given + len(self._parts))

    def _value(self, cls: type, value: object) -> int:
        return self._values.setdefault((cls, value), ~len(self._values))

    def _rows(self, item: tuple[Any, ...]) -> tuple[object, ...] | None:
        """The place of a tuple's integers, or of rows of integers or Booleans; None if neither."""
        if not item:
            return None
        if all(type(entry) is int for entry in item):
            return self._tables.place(item)
        if not all(type(inner) is tuple and inner and len(inner) == len(item[0]) for inner in item):
            return None
        kinds = {type(entry) for row in item for entry in row}
        if kinds == {int} or kinds == {bool}:
            return (*self._tables.place_rows(item), len(item[0]), kinds == {bool})
        return None

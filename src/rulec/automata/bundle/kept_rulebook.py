"""Serialisation of cached compiled rulebooks.

It is a list of parts, each behind those that it is made of, and equal ones are there once: rules
share most of what they speak of.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from itertools import accumulate
from operator import attrgetter
from typing import Any, TypeAlias

import msgspec

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.bundle.stored_prefixes import CutTables, StoredPrefixes
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.diagnostics import Diagnostic, Fix, Label, SourceLocation
from rulec.logic import formula as ltl
from rulec.rulebook import rulebook_model as model
from rulec.rulebook.files.search_path import Dependency
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary


@dataclass(frozen=True, slots=True)
class Compilation:
    """What is kept: what it depends on, what there was to be said, and the rulebook.

    ``stamp`` is a digest of what it was compiled from and by. ``day`` is the one whose law it is,
    if nothing else says that; empty if something does. ``problems`` say why there is no rulebook.
    """

    stamp: str
    day: str
    dependencies: tuple[Dependency, ...]
    warnings: tuple[Diagnostic, ...] = ()
    problems: tuple[Diagnostic, ...] = ()
    rulebook: CompiledRulebook | None = None


@dataclass(frozen=True, slots=True)
class _Kind:
    """How what is of one kind is taken apart, and made of its parts again."""

    parts: Callable[[Any], Iterable[object]]
    make: Callable[..., object]


def _of_fields(cls: type, without: Sequence[str] = ()) -> _Kind:
    """The kind of a dataclass; fields that are left out come last, and have defaults."""
    names = [field.name for field in fields(cls) if field.init and field.name not in without]
    if len(names) == 1:
        return _Kind(lambda item: (getattr(item, names[0]),), cls)
    return _Kind(attrgetter(*names), cls)


def _rulebook(*parts: Any) -> CompiledRulebook:
    """A rulebook of what is kept of it, with the machines for cut traces last."""
    return replace(CompiledRulebook(*parts[:-1]), prefixes=parts[-1])


_RULEBOOK = _of_fields(CompiledRulebook, ["source", "recompile", "too_large"])
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
            *(SourceLocation, Label, Fix, Diagnostic),
        )
    },
}
_NUMBERS = {cls: number for number, cls in enumerate(_KINDS)}
_MAKE = [kind.make for kind in _KINDS.values()]


_Row: TypeAlias = tuple[int, ...]


class _Packed(msgspec.Struct, array_like=True):
    """Values, rows and tables of numbers, and parts that are made of these.

    A part has the number of its kind and those of what it is made of: what both sides are given
    comes first, then come the values, the rows, the tables of integers and of truth values, and the
    parts themselves.
    """

    values: list[bool | int | float | str | None]
    rows: list[_Row]
    tables: list[tuple[_Row, ...]]
    truths: list[tuple[tuple[bool, ...], ...]]
    parts: list[_Row]


_GIVEN, _VALUES, _ROWS, _TABLES, _TRUTHS, _PARTS = range(6)


def written(known: Compilation, given: Sequence[object] = ()) -> bytes:
    """The bytes of a compilation; ``compilation_in`` takes the same ``given`` objects.

    Raises ValueError for a text that is none.
    """
    return _Writer(given).written(known)


def compilation_in(data: bytes, given: Sequence[object] = ()) -> Compilation:
    """The compilation that bytes say. Raises ValueError, TypeError or LookupError for others."""
    packed = msgspec.json.decode(data, type=_Packed)
    made = [*given, *packed.values, *packed.rows, *packed.tables, *packed.truths]
    part = made.__getitem__
    for kind, *numbers in packed.parts:
        made.append(_MAKE[kind](*map(part, numbers)))
    found = made[-1]
    if not isinstance(found, Compilation):
        raise ValueError("it says nothing of a rulebook")
    return found


class _Writer:
    """What has been met, each with its place: a group of ``_Packed`` and a number in it."""

    def __init__(self, given: Sequence[object]) -> None:
        self._given = {id(part): number for number, part in enumerate(given)}
        self._met: list[dict[Any, int]] = [{} for _ in range(_PARTS + 1)]

    def written(self, known: Compilation) -> bytes:
        """All that a compilation is made of."""
        self._place(known)
        _, values, rows, tables, truths, parts = self._met
        sizes = [len(self._given), *map(len, self._met[_VALUES:])]
        starts = list(accumulate(sizes, initial=0))
        packed = _Packed(
            [value for _, value in values],
            list(rows),
            list(tables),
            list(truths),
            [(kind, *[starts[group] + number for group, number in own]) for kind, *own in parts],
        )
        return msgspec.json.encode(packed)

    def _place(self, item: object) -> tuple[int, int]:
        if id(item) in self._given:
            return _GIVEN, self._given[id(item)]
        if item is None or isinstance(item, bool | int | float | str):
            return self._known(_VALUES, (type(item), item))
        if isinstance(item, tuple) and (group := _group_of(item)) is not None:
            return self._known(group, item)
        cls = type(item) if type(item) in _KINDS else dict  # a view of one, else
        return self._known(_PARTS, (_NUMBERS[cls], *map(self._place, _KINDS[cls].parts(item))))

    def _known(self, group: int, key: object) -> tuple[int, int]:
        met = self._met[group]
        return group, met.setdefault(key, len(met))


def _group_of(item: tuple[Any, ...]) -> int | None:
    """Where a tuple of integers is, or of rows of them or of truth values; None for others."""
    kinds = set(map(type, item))
    if kinds == {int}:
        return _ROWS
    if kinds != {tuple} or not all(item):
        return None
    kinds = {type(entry) for row in item for entry in row}
    return _TABLES if kinds == {int} else _TRUTHS if kinds == {bool} else None

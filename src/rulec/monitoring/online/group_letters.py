"""The letters of rule groups for states of one shape, by binding.

The letters for one state of the world, and for some values, are computed once and kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.monitoring.online.encoding import encoded_values
from rulec.monitoring.online.encoding.encoded_values import (
    Encoded,
    MonitorInput,
    digits_between,
)
from rulec.monitoring.online.encoding.state_shape import Items, StateShape
from rulec.monitoring.online.rule_group import RuleGroup
from rulec.monitoring.state_view import StateView, value_in
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.monitoring.uncertainty.state_letters.read_digits import read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.trace import State
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN

MOST = 1 << 12
"""How many states of the world, and letters of each group, are kept before all are discarded."""

_ReadColumn: TypeAlias = Callable[[State, Sequence[Encoded]], Sequence[Any]]
"""Maps a state and its parts to the encoded values of an input, for each of several bindings."""

_ReadKeys: TypeAlias = Callable[[State, Sequence[Encoded]], Iterable[Any]]
"""Maps a state and its parts to the key of the letter, for each of several bindings."""


class GroupLetters:
    """A reader of the letters of groups with bindings, for one shape.

    Raises LookupError or TypeError if such states need closer inspection.
    """

    def __init__(
        self, shape: StateShape, groups: Sequence[tuple[RuleGroup, Sequence[Items]]]
    ) -> None:
        self.shape = shape
        self._readers = [_GroupReader(group, bindings, shape) for group, bindings in groups]
        read = set[tuple[str, Items]]().union(*[reader.read for reader in self._readers])
        # Values are checked when they first become part of a letter.
        self._unread = list[tuple[int, slice, frozenset[object]]]()
        for (name, items), (part, place) in shape.places.items():
            declaration = shape.vocabulary.declarations[name]
            if isinstance(declaration, Enumeration) and (name, items) not in read:
                values = frozenset([*declaration.values, encoded_values.MISSING, UNKNOWN])
                self._unread.append((part, slice(place, place + 1), values))
        self._keys = [reader.keys for reader in self._readers]
        self._by_world: dict[tuple[Encoded, ...], list[_LetterTable]] = {}

    def letters(self, state: State, parts: tuple[Encoded, ...]) -> list[int]:
        """The letter of each binding of each group, one after the other.

        Raises LookupError or TypeError if the state needs closer inspection.
        """
        for part, places, values in self._unread:
            if not values.issuperset(parts[part][places]):
                raise LookupError
        world = parts[: self.shape.n_world]
        letters: list[int] = []
        tables = self._by_world.get(world) or self._in_world(world)
        for keys, known in zip(self._keys, tables, strict=True):
            letters += map(known.__getitem__, keys(state, parts))
        return letters

    def _in_world(self, world: tuple[Encoded, ...]) -> list[_LetterTable]:
        in_world = self._by_world.get(world)
        if in_world is None:
            if len(self._by_world) >= MOST:
                self._by_world.clear()
            in_world = [reader.in_world(world) for reader in self._readers]
            self._by_world[world] = in_world
        return in_world


class _LetterTable(dict[Any, int]):
    """The letters of a group by the encoded values of its own inputs.

    The key is the encoded value of a single input, or a tuple for several.
    """

    __slots__ = ("_breakpoints", "_group", "_others", "_own")

    def __init__(
        self,
        group: RuleGroup,
        own: Sequence[MonitorInput],
        others: Mapping[MonitorInput, Any],
        breakpoints: encoded_values.Breakpoints,
    ) -> None:
        self._group = group
        self._own = own
        self._others = others
        self._breakpoints = breakpoints

    def __missing__(self, key: Any) -> int:
        letter = self._group.letter_of(self._digits(key))
        if len(self) >= MOST:
            self.clear()
        self[key] = letter
        return letter

    def _digits(self, key: Any) -> Mapping[MonitorInput, Any]:
        own = self._own
        if not own:
            return self._others
        encoded = (key,) if len(own) == 1 else key
        digits = dict(self._others)
        for read, value in zip(own, encoded, strict=True):
            digits[read] = read.digit(value, self._breakpoints)
        return digits


class _GroupReader:
    """A reader of a group's letters for ``n_bindings``; ``read`` are the values that it uses.

    ``keys`` are those of the letters that are kept; it raises like ``letters``.
    """

    def __init__(self, group: RuleGroup, bindings: Sequence[Items], shape: StateShape) -> None:
        self.read = set[tuple[str, Items]]()
        self._group = group
        self._breakpoints = shape.breakpoints
        self.n_bindings = len(bindings)
        self._not_given: dict[MonitorInput, Any] = {}
        self._world: list[tuple[MonitorInput, int, int]] = []
        self._own: list[MonitorInput] = []
        self._columns: list[_ReadColumn] = []
        # The parts that are used as columns directly; None for columns built from a state.
        whole: list[int | None] = []
        for read in (*group.world, *group.own):
            about = [tuple([binding[place] for place in read.places]) for binding in bindings]
            if read.name is None:
                self._own.append(read)
                self._columns.append(_sum_column(read, about, shape))
                whole.append(None)
                continue
            if read.name not in shape.names:
                declaration = shape.vocabulary.declarations[read.name]
                default = encoded_values.encoded_default(declaration, shape.breakpoints)
                self._not_given[read] = read.digit(default, shape.breakpoints)
                continue
            self.read.update((read.name, items) for items in about)
            places = [shape.places[read.name, items] for items in about]
            if read.places:
                part = _whole_part(places, shape)
                self._own.append(read)
                self._columns.append(_values_column(places) if part is None else _part_column(part))
                whole.append(part)
            else:
                self._world.append((read, *places[0]))
        self.keys = self._read_keys(whole)

    def in_world(self, world: Sequence[Encoded]) -> _LetterTable:
        """The letters of all bindings, for one world state."""
        digits = {
            read: read.digit(world[part][place], self._breakpoints)
            for read, part, place in self._world
        }
        others = {**self._not_given, **digits}
        return _LetterTable(self._group, self._own, others, self._breakpoints)

    def _read_keys(self, whole: Sequence[int | None]) -> _ReadKeys:
        columns, n_bindings = self._columns, self.n_bindings
        if not columns:
            return lambda *_: [()] * n_bindings
        if len(columns) == 1:
            return columns[0]
        if None not in whole:
            pick = itemgetter(*whole)
            return lambda _, parts: zip(*pick(parts), strict=True)
        return lambda state, parts: zip(*[column(state, parts) for column in columns], strict=True)


def _whole_part(places: Sequence[tuple[int, int]], shape: StateShape) -> int | None:
    part = places[0][0]
    return part if places == [(part, place) for place in range(shape.sizes[part])] else None


def _part_column(part: int) -> _ReadColumn:
    return lambda _, parts: parts[part]


def _values_column(places: Sequence[tuple[int, int]]) -> _ReadColumn:
    part, pick = places[0][0], values_at([place for _, place in places])
    return lambda _, parts: pick(parts[part])


def _sum_column(read: MonitorInput, about: Sequence[Items], shape: StateShape) -> _ReadColumn:
    number = read.number
    assert number is not None
    ready = read_digits(number)
    bindings = [dict(zip(read.variables, items, strict=True)) for items in about]
    summands = [
        [
            (name, tuple([binding[x] for x in own]), shape.vocabulary.declarations[name])
            for name, own in ready.summands
        ]
        for binding in bindings
    ]

    def column(state: State, _: Sequence[Encoded]) -> Sequence[Any]:
        view = StateView(state, shape.objects, shape.vocabulary)
        digits: list[int | range] = []
        for binding, own in zip(bindings, summands, strict=True):
            possible = ready.of_sum([value_in(state, *one) for one in own]) if own else None
            if possible is None:
                # Exact numbers are needed.
                try:
                    possible = ready.in_state(binding, view)
                except MissingValueError:
                    raise LookupError from None
            lowest = (possible & -possible).bit_length() - 1
            digits.append(digits_between(lowest, possible.bit_length() - 1))
        return digits

    return column

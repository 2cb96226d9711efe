"""The letters of rule groups for states of one shape, by binding.

The letters for one state of the world, and for some values, are computed once and kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.monitoring.online.encoding import encoded_values
from rulec.monitoring.online.encoding.encoded_values import Encoded
from rulec.monitoring.online.encoding.state_shape import Items, StateShape
from rulec.monitoring.online.prepared_rule import ReadSource
from rulec.monitoring.online.rule_group import RuleGroup
from rulec.monitoring.state_view import StateView, value_in
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import MissingValueError
from rulec.trace import State
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN

MOST = 1 << 12
"""How many states of the world, and letters of each group, are kept before all are discarded."""

_LetterTable: TypeAlias = Remembered[Any, int]
"""The letters of a group by the encoded values of its sources that are about variables.

The key is the encoded value of a single source, or a tuple for several.
"""

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
        self._by_world: Remembered[tuple[Encoded, ...], list[_LetterTable]] = Remembered(
            lambda world: [reader.in_world(world) for reader in self._readers], MOST
        )

    def letters(self, state: State, parts: tuple[Encoded, ...]) -> list[int]:
        """The letter of each binding of each group, one after the other.

        Raises LookupError or TypeError if the state needs closer inspection.
        """
        for part, places, values in self._unread:
            if not values.issuperset(parts[part][places]):
                raise LookupError
        world = parts[: self.shape.n_world]
        letters: list[int] = []
        for keys, known in zip(self._keys, self._by_world[world], strict=True):
            letters += map(known.__getitem__, keys(state, parts))
        return letters


class _GroupReader:
    """A reader of a group's letters for ``n_bindings``; ``read`` are the values that it uses.

    ``keys`` are those of the letters that are kept; it raises like ``letters``.
    """

    def __init__(self, group: RuleGroup, bindings: Sequence[Items], shape: StateShape) -> None:
        self.read = set[tuple[str, Items]]()
        self._group = group
        self.n_bindings = len(bindings)
        self._given: list[Any] = [None] * len(group.reads.sources)
        self._world: list[tuple[int, int, int]] = []
        self._own: list[int] = []
        self._columns: list[_ReadColumn] = []
        # The parts that are used as columns directly; None for columns built from a state.
        whole: list[int | None] = []
        for number, source in enumerate(group.reads.sources):
            about = [tuple([binding[place] for place in source.places]) for binding in bindings]
            if source.name is None:
                self._own.append(number)
                self._columns.append(_sum_column(source, about, shape))
                whole.append(None)
                continue
            if source.name not in shape.names:
                declaration = shape.vocabulary.declarations[source.name]
                self._given[number] = encoded_values.encoded_default(declaration, shape.breakpoints)
                continue
            self.read.update((source.name, items) for items in about)
            places = [shape.places[source.name, items] for items in about]
            if source.places:
                part = _whole_part(places, shape)
                self._own.append(number)
                self._columns.append(_values_column(places) if part is None else _part_column(part))
                whole.append(part)
            else:
                self._world.append((number, *places[0]))
        self.keys = self._read_keys(whole)

    def in_world(self, world: Sequence[Encoded]) -> _LetterTable:
        """The letters of all bindings, for one world state."""
        group, own, given = self._group, self._own, list(self._given)
        for number, part, place in self._world:
            given[number] = world[part][place]

        def letter(key: Any) -> int:
            values = list(given)
            for place, value in zip(own, (key,) if len(own) == 1 else key, strict=True):
                values[place] = value
            return group.letter_read(group.reads.classes(values))

        return Remembered(letter, MOST)

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


def _sum_column(source: ReadSource, about: Sequence[Items], shape: StateShape) -> _ReadColumn:
    ready = source.sum
    assert ready is not None, "it has no name"
    bindings = [dict(zip(ready.variables, items, strict=True)) for items in about]
    summands = [
        [
            (name, tuple([binding[x] for x in own]), shape.vocabulary.declarations[name])
            for name, own in ready.summands
        ]
        for binding in bindings
    ]

    def column(state: State, _: Sequence[Encoded]) -> Sequence[Any]:
        view = StateView(state, shape.objects, shape.vocabulary)
        digits = []
        for binding, own in zip(bindings, summands, strict=True):
            possible = ready.of_sum([value_in(state, *one) for one in own]) if own else None
            if possible is None:
                # Exact numbers are needed.
                try:
                    possible = ready.in_state(binding, view)
                except MissingValueError:
                    raise LookupError from None
            digits.append(possible)
        return digits

    return column

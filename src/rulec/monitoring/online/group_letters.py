"""The letters that teams read of states of one outline, binding by binding.

What the world's state and some values come to is worked out once and remembered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.logic.kleene import Unknown, weighted_sum
from rulec.monitoring.online.breakpoints import Floors
from rulec.monitoring.online.encoded_values import MISSING, Told, default_told, values_of
from rulec.monitoring.online.letter_inputs import Input
from rulec.monitoring.online.rule_group import RuleGroup
from rulec.monitoring.online.state_shape import Items, StateShape
from rulec.monitoring.state_view import StateView
from rulec.trace import State
from rulec.vocabulary import Enumeration, Vocabulary

MOST = 1 << 12
"""So much is remembered before it is forgotten again."""

_Column: TypeAlias = Callable[[State, Sequence[Told]], Sequence[Any]]
"""Of a state and its parts what is told of an input, for each of several bindings."""

_Read: TypeAlias = Callable[[State, Sequence[Told]], Iterable[int]]
"""Of a state and its parts the letter of each of several bindings. Raises as ``letters``."""


class GroupLetters:
    """Reads states of an outline, for teams with their bindings, of which each has some.

    Raises:
        LookupError, TypeError: such states need a closer look.
    """

    def __init__(
        self,
        outline: StateShape,
        teams: Sequence[tuple[RuleGroup, Sequence[Items]]],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
        floors: Floors,
    ) -> None:
        self.outline = outline
        self._teams = [
            _OfTeam(team, bindings, outline, objects, vocabulary, floors)
            for team, bindings in teams
        ]
        read = set[tuple[str, Items]]().union(*[one.read for one in self._teams])
        # Whatever is read is looked at when a letter is made of it for the first time.
        self._unread = list[tuple[int, slice, frozenset[object]]]()
        for (name, items), (part, place) in outline.places.items():
            declaration = vocabulary.declarations[name]
            if isinstance(declaration, Enumeration) and (name, items) not in read:
                values = frozenset([*declaration.values, MISSING])
                self._unread.append((part, slice(place, place + 1), values))
        self._known: dict[tuple[Told, ...], list[_Read]] = {}

    def letters(self, state: State, parts: tuple[Told, ...]) -> list[int]:
        """For each binding of each team, one after the other, the letter that it reads.

        Raises a LookupError or a TypeError if the state needs a closer look.
        """
        for part, places, values in self._unread:
            if not values.issuperset(parts[part][places]):
                raise LookupError
        world = parts[: self.outline.n_world]
        known = self._known.get(world)
        if known is None:
            if len(self._known) >= MOST:
                self._known.clear()
            known = self._known[world] = [one.in_world(world) for one in self._teams]
        found: list[int] = []
        for read in known:
            found += read(state, parts)
        return found


class _Letters(dict[Any, int]):
    """A team's letters by what is told of its own inputs, with the digits of all others.

    What is told of a single input stands for itself, of several it is a tuple.
    """

    def __init__(
        self, team: RuleGroup, own: Sequence[Input], others: Mapping[Input, Any], floors: Floors
    ) -> None:
        self._team = team
        self._own = own
        self._others = others
        self._floors = floors

    def __missing__(self, key: Any) -> int:
        told = (key,) if len(self._own) == 1 else key
        own = {
            one: one.digit(each, self._floors) for one, each in zip(self._own, told, strict=True)
        }
        found = self._team.letter_of({**self._others, **own})
        if len(self) >= MOST:
            self.clear()
        self[key] = found
        return found


class _OfTeam:
    """What reads the letters of a team; ``read`` are the values that it looks at."""

    def __init__(
        self,
        team: RuleGroup,
        bindings: Sequence[Items],
        outline: StateShape,
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
        floors: Floors,
    ) -> None:
        self.read = set[tuple[str, Items]]()
        self._team = team
        self._floors = floors
        self._n_bindings = len(bindings)
        self._not_given: dict[Input, Any] = {}
        self._world: list[tuple[Input, int, int]] = []
        self._own: list[Input] = []
        self._columns: list[_Column] = []
        # The parts that are columns as they are; None for what is to be made of a state first.
        whole: list[int | None] = []
        for one in (*team.world, *team.own):
            about = [tuple([binding[place] for place in one.places]) for binding in bindings]
            if one.name is None:
                self._own.append(one)
                self._columns.append(_summed(one, about, objects, vocabulary))
                whole.append(None)
                continue
            if one.name not in outline.names:
                default = default_told(vocabulary.declarations[one.name], floors)
                self._not_given[one] = one.digit(default, floors)
                continue
            self.read.update((one.name, items) for items in about)
            places = [outline.places[one.name, items] for items in about]
            if one.places:
                part = _whole_part(places, outline)
                self._own.append(one)
                self._columns.append(_given(places) if part is None else _all_of(part))
                whole.append(part)
            else:
                self._world.append((one, *places[0]))
        self._whole = None if None in whole else [part for part in whole if part is not None]

    def in_world(self, world: Sequence[Told]) -> _Read:
        """What reads a letter for each binding where the parts about the world are these."""
        digits = {
            one: one.digit(world[part][place], self._floors) for one, part, place in self._world
        }
        others = {**self._not_given, **digits}
        letter = _Letters(self._team, self._own, others, self._floors).__getitem__
        if not self._columns:
            return lambda *_: (letter(()),) * self._n_bindings
        if len(self._columns) == 1:
            (column,) = self._columns
            return lambda state, parts: map(letter, column(state, parts))
        if self._whole is not None:
            pick = itemgetter(*self._whole)
            return lambda _, parts: map(letter, zip(*pick(parts), strict=True))
        return lambda state, parts: map(
            letter, zip(*[column(state, parts) for column in self._columns], strict=True)
        )


def _whole_part(places: Sequence[tuple[int, int]], outline: StateShape) -> int | None:
    """The part whose values stand at just these places, in this order."""
    part = places[0][0]
    return part if places == [(part, place) for place in range(outline.sizes[part])] else None


def _all_of(part: int) -> _Column:
    return lambda _, parts: parts[part]


def _given(places: Sequence[tuple[int, int]]) -> _Column:
    """What is told at these places, which are all in one part."""
    part, pick = places[0][0], values_of([place for _, place in places])
    return lambda _, parts: pick(parts[part])


def _summed(
    one: Input, about: Sequence[Items], objects: Mapping[str, str], vocabulary: Vocabulary
) -> _Column:
    number = one.number
    assert number is not None
    bound = [dict(zip(one.variables, items, strict=True)) for items in about]

    def column(state: State, _: Sequence[Told]) -> Sequence[int]:
        moment = StateView(state, objects, vocabulary)
        found = [weighted_sum(number.terms, each, moment) for each in bound]
        if any(isinstance(each, Unknown) for each in found):
            raise LookupError
        return [number.digit(each) for each in found if not isinstance(each, Unknown)]

    return column

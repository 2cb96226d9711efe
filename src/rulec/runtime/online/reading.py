"""The letters that the bindings of a team read, by what is the case in the world.

What the world's state and some digits come to is worked out once and remembered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rulec.runtime.online.columns import Items, OneStateColumns
from rulec.runtime.online.inputs import Input
from rulec.runtime.online.team import Team

MOST = 1 << 12
"""So much is remembered before it is forgotten again."""


class _Letters(dict[Any, int]):
    """A team's letters in one state of the world, by the digits of its own inputs.

    A single digit stands for itself, several are a tuple.
    """

    def __init__(self, team: Team, world: dict[Input, Any]) -> None:
        self._team = team
        self._world = world

    def __missing__(self, own: Any) -> int:
        digits = (own,) if len(self._team.own) == 1 else own
        found = self._team.letter_of(
            {**self._world, **dict(zip(self._team.own, digits, strict=True))}
        )
        if len(self) >= MOST:
            self.clear()
        self[own] = found
        return found


class Reading:
    """What reads the letters of some bindings of a team, of which there are some."""

    def __init__(self, team: Team, bindings: Sequence[Items], columns: OneStateColumns) -> None:
        self._n_bindings = len(bindings)
        self._columns = [(columns.column_of(one, bindings), one.digits) for one in team.own]

    def letters(self, known: _Letters, columns: Sequence[Sequence[Any]]) -> Iterable[int]:
        """A letter for each binding. Raises a LookupError or a TypeError if a value is missing."""
        if not self._columns:
            return (known[()],) * self._n_bindings
        digits: list[Iterable[Any]] = [
            columns[place] if of is None else of(columns[place]) for place, of in self._columns
        ]
        if len(digits) == 1:
            return map(known.__getitem__, digits[0])
        return map(known.__getitem__, zip(*digits, strict=True))


class World:
    """What teams read of the world's state, and the letters that they read there."""

    def __init__(self, teams: Sequence[Team]) -> None:
        self._teams = teams
        inputs = list(dict.fromkeys(one for team in teams for one in team.world))
        self._plain = [one for one in inputs if one.number is None]
        self._numbers = [one for one in inputs if one.number is not None]
        self.names = [str(one.name) for one in (*self._plain, *self._numbers)]
        self._digits = [_one_digit(one) for one in self._numbers]
        self._known: dict[tuple[Any, ...], list[_Letters]] = {}

    def letters(self, values: Sequence[Any]) -> list[_Letters]:
        """For each team, where the world has these values of ``names``.

        Raises a TypeError if a number is missing.
        """
        key = tuple(values)
        if self._digits:
            n_plain = len(self._plain)
            digits = [of(value) for of, value in zip(self._digits, key[n_plain:], strict=True)]
            key = (*key[:n_plain], *digits)
        found = self._known.get(key)
        if found is None:
            world = dict(zip((*self._plain, *self._numbers), key, strict=True))
            found = [_Letters(team, world) for team in self._teams]
            if len(self._known) >= MOST:
                self._known.clear()
            self._known[key] = found
        return found


def _one_digit(one: Input) -> Callable[[Any], Any]:
    of = one.digits
    assert of is not None
    return lambda value: next(iter(of((value,))))

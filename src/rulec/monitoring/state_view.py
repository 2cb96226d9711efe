"""Views of single states: values, with the objects that are present.

A value that a state does not give and that has no default is unknown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from rulec.automata.thresholds import exact
from rulec.logic.kleene import Between, Unknown
from rulec.trace import State, Value
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, PartialValue


@dataclass(frozen=True, slots=True)
class StateView:
    """A state checked by ``check_state``, with the types of its present objects."""

    state: State
    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> Value | Unknown:
        """The value in the state, or the declared default."""
        # Same as value_in, inlined because this runs for every object in every state.
        value: Any = self.state.get(name)
        for item in items:
            if value is None or value is UNKNOWN:
                break
            value = value.get(item)
        if value is None:
            value = self.vocabulary.declarations[name].default
        if value is None or type(value) in UNKNOWN_TYPES:
            return Unknown(name, items)
        known: Value = value
        return known

    def given(self, name: str, items: tuple[str, ...]) -> PartialValue | None:
        """The value in the state, possibly partial, or the declared default."""
        return value_in(self.state, name, items, self.vocabulary.declarations[name])

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The quantity's value: exact, or its bounds."""
        value = self.value(name, items)
        assert not isinstance(value, str), "check_state has refused it"
        if not isinstance(value, Unknown):
            return exact(value)
        given = self.given(name, items)
        if type(given) is not Interval:
            return value
        return Between(name, items, exact(given.low), exact(given.high))


def with_values(
    state: State, values: Mapping[tuple[str, tuple[str, ...]], PartialValue | None]
) -> State:
    """The state with these values for names of objects."""
    if not values:
        return state
    changed: dict[str, Any] = dict(state)
    # The mappings that are copied already, by the names on the way to them
    copied: dict[tuple[str, ...], dict[str, Any]] = {(): changed}

    def copy_at(way: tuple[str, ...]) -> dict[str, Any]:
        if way not in copied:
            outer, key = copy_at(way[:-1]), way[-1]
            known = outer.get(key)
            copied[way] = outer[key] = dict(known) if isinstance(known, Mapping) else {}
        return copied[way]

    for (name, items), value in values.items():
        if items:
            way = name, *items[:-1]
            inner = copied.get(way)
            if inner is None:
                inner = copy_at(way)
            inner[items[-1]] = value
        else:
            changed[name] = value
    return changed


def put(given: Any, items: tuple[str, ...], value: object) -> Any:
    """The values of a name, extended by ``value`` for these objects."""
    if not items:
        return value
    first, *others = items
    known = given if isinstance(given, Mapping) else {}
    return {**known, first: put(known.get(first), tuple(others), value)}


def value_in(
    state: State, name: str, objects: Sequence[str], declaration: Declaration
) -> PartialValue | None:
    """The value in a state, or its default; None if there is neither.

    A name that is unknown as a whole is unknown for all objects.
    """
    value: Any = state.get(name)
    for item in objects:
        if value is None or value is UNKNOWN:
            break
        value = value.get(item)
    return declaration.default if value is None else value

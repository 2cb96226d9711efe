"""The values of one state, each of them fetched once, whatever rules and bindings ask for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.automata.machine import NumberRead
from rulec.logic.one_state import Unknown, total
from rulec.runtime.moment import Moment, value_in
from rulec.vocabulary import Vocabulary

Items: TypeAlias = tuple[str, ...]
Fetch: TypeAlias = Callable[[Mapping[str, Any]], Sequence[Any]]


class OneStateColumns:
    """Collects what is to be fetched while these objects are there, and fetches it.

    A column has the values of one thing for several objects; what is not said is None there. What
    is about no objects has a value instead of a column.
    """

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._values: dict[str, Any] = {}
        self._columns: dict[object, Fetch] = {}

    def value_of(self, name: str) -> int:
        """Where the value of a declaration will stand."""
        self._values[name] = self._vocabulary.declarations[name].default
        return list(self._values).index(name)

    def column_of(self, name: str, items: Sequence[Items]) -> int:
        """Where the column of a declaration will stand, with its values for these objects."""
        key = (name, tuple(items))
        if key not in self._columns:
            self._columns[key] = self._declared(name, items)
        return list(self._columns).index(key)

    def column_of_sum(
        self, read: NumberRead, variables: Sequence[str], items: Sequence[Items]
    ) -> int:
        """Where the column of a count or a sum will stand, with these objects for the variables."""
        key = (read, tuple(variables), tuple(items))
        if key not in self._columns:
            self._columns[key] = self._summed(read, variables, items)
        return list(self._columns).index(key)

    def fetched(self, state: Mapping[str, Any]) -> tuple[list[Any], list[Sequence[Any]]]:
        """The values and the columns of a state. Raises LookupError where a sum lacks a value."""
        get = state.get
        return (
            [get(name, default) for name, default in self._values.items()],
            [fetch(state) for fetch in self._columns.values()],
        )

    def _declared(self, name: str, items: Sequence[Items]) -> Fetch:
        declaration = self._vocabulary.declarations[name]
        if len(items[0]) > 1:
            return lambda state: [value_in(state, name, one, declaration) for one in items]
        default = declaration.default
        flat = [item for (item,) in items]
        # Of one key it gets no tuple; of two that are the same it does.
        pick = itemgetter(*flat, flat[0])

        def fetch(state: Mapping[str, Any]) -> Sequence[Any]:
            given = state.get(name)
            if given is None:
                return [default] * len(flat)
            try:
                return pick(given)[:-1]  # type: ignore[no-any-return]
            except KeyError:
                return [given.get(item, default) for item in flat]

        return fetch

    def _summed(self, read: NumberRead, variables: Sequence[str], items: Sequence[Items]) -> Fetch:
        bound = [dict(zip(variables, one, strict=True)) for one in items]

        def fetch(state: Mapping[str, Any]) -> Sequence[Any]:
            moment = Moment(state, self._objects, self._vocabulary)
            found = [total(read.terms, one, moment) for one in bound]
            if any(isinstance(one, Unknown) for one in found):
                raise LookupError
            return found

        return fetch

"""The values of one state, each of them fetched once, whatever rules and bindings ask for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.logic.one_state import Unknown, total
from rulec.runtime.moment import Moment, value_in
from rulec.runtime.online.inputs import Input
from rulec.vocabulary import Vocabulary

Items: TypeAlias = tuple[str, ...]
Fetch: TypeAlias = Callable[[Mapping[str, Any]], Sequence[Any]]


class OneStateColumns:
    """Collects what is to be fetched while these objects are there, and fetches it.

    A column has the values of an input for several bindings; what is not said is None there.
    """

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._places: dict[object, int] = {}
        self._columns: list[Fetch] = []

    def column_of(self, one: Input, bindings: Sequence[Items]) -> int:
        """Where the column of an input will stand, with its values for these bindings."""
        items = tuple([tuple([binding[place] for place in one.places]) for binding in bindings])
        key = (one.name or one, items)
        if key not in self._places:
            self._places[key] = len(self._columns)
            if one.name is None:
                self._columns.append(self._summed(one, items))
            else:
                self._columns.append(self._declared(one.name, items))
        return self._places[key]

    def fetched(self, state: Mapping[str, Any]) -> list[Sequence[Any]]:
        """The columns of a state. Raises LookupError where a sum lacks a value."""
        return [fetch(state) for fetch in self._columns]

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

    def _summed(self, one: Input, items: Sequence[Items]) -> Fetch:
        assert one.number is not None
        terms = one.number.terms
        bound = [dict(zip(one.variables, each, strict=True)) for each in items]

        def fetch(state: Mapping[str, Any]) -> Sequence[Any]:
            moment = Moment(state, self._objects, self._vocabulary)
            found = [total(terms, each, moment) for each in bound]
            if any(isinstance(each, Unknown) for each in found):
                raise LookupError
            return found

        return fetch

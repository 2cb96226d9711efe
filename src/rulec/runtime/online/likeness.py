"""By what a state is known again: a key that only states have which every rule reads alike.

A key is made for states of one outline: those that speak of the very same things. It is made of
values that cannot change, and far more quickly than a state is read.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Hashable, Mapping, Sequence
from operator import itemgetter
from typing import Any, TypeAlias

from rulec.automata.compiled import CompiledRulebook
from rulec.automata.facts import counts
from rulec.automata.machine import NumberRead
from rulec.runtime.numbers import EXACT_IN_FLOATS, scale
from rulec.runtime.terms import names_in
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

Key: TypeAlias = Callable[[Any], Hashable]
"""The key of a state.

Raises a LookupError or a TypeError if the state has another outline, or needs a closer look.
"""

Floors: TypeAlias = Mapping[str, tuple[float, ...] | None]
"""What rules compare quantities with, as ``floor_of`` says it; None if every value matters."""

_Values: TypeAlias = Callable[[Any], Sequence[Any]]

_TRUTHS = frozenset({bool})
_NUMBERS = frozenset({int, float})


def floors_of(rulebook: CompiledRulebook) -> Floors:
    """What all rules together compare quantities with."""
    floors: dict[str, set[float]] = {}
    all_matter = set[str]()
    for rule in rulebook.rules:
        for read in rule.machine.reads:
            if isinstance(read, NumberRead):
                about = scale(read)
                if about.quantity is None:
                    all_matter.update(about.names)
                else:
                    floors.setdefault(about.quantity.name, set()).update(about.floors)
    if any(counts(fact.formula) for fact in rulebook.facts):
        all_matter.update(name for fact in rulebook.facts for name in names_in(fact.formula))
    found: dict[str, tuple[float, ...] | None]
    found = {name: tuple(sorted(those)) for name, those in floors.items()}
    return found | dict.fromkeys(all_matter)


def key_like(sample: Mapping[str, Any], vocabulary: Vocabulary, floors: Floors) -> Key:
    """What makes the keys of all states with the outline of this one, which fits the vocabulary."""
    about = [vocabulary.declarations[name] for name in sample]
    if len(about) == 1 and isinstance(about[0], Enumeration) and len(about[0].parameters) == 1:
        return _of_one_relation(about[0].name, tuple(sample[about[0].name]))
    parts: list[Key] = []
    for kind in (Enumeration, Signal):
        alike = [one for one in about if isinstance(one, kind) and not one.parameters]
        if alike:
            parts.append(_told(_values_of([one.name for one in alike]), alike[0], floors))
    for one in about:
        if one.parameters:
            told = _told_of_each(sample[one.name], len(one.parameters), one, floors)
            parts.append(_inside(one.name, told))
        elif isinstance(one, Quantity):
            parts.append(_told(_values_of([one.name]), one, floors))
    n_names = len(about)

    def key(state: Any) -> Hashable:
        if type(state) is not dict or len(state) != n_names:
            raise LookupError
        return tuple([part(state) for part in parts])

    return key


def _of_one_relation(name: str, objects: Sequence[str]) -> Key:
    """As ``key_like``, where an enumeration about objects is all that there is: in one go."""
    n_objects = len(objects)
    values_of = itemgetter(*objects) if objects else _values_of(objects)

    def key(state: Any) -> Hashable:
        if type(state) is dict and len(state) == 1:
            given = state[name]
            if type(given) is dict and len(given) == n_objects:
                return values_of(given)
        raise LookupError

    return key


def _inside(name: str, told: Key) -> Key:
    return lambda given: told(given[name])


def _told_of_each(
    sample: Mapping[str, Any], n_parameters: int, declaration: Declaration, floors: Floors
) -> Key:
    """What is told of the objects that the sample tells of, or of these and others."""
    n_objects = len(sample)
    if n_parameters == 1:
        told = _told(_values_of(tuple(sample)), declaration, floors)
    else:
        told = _together(
            [
                _inside(name, _told_of_each(one, n_parameters - 1, declaration, floors))
                for name, one in sample.items()
            ]
        )

    def told_of_each(given: Any) -> Hashable:
        if type(given) is dict and len(given) == n_objects:
            return told(given)
        raise LookupError

    return told_of_each


def _together(parts: Sequence[Key]) -> Key:
    return lambda given: tuple([part(given) for part in parts])


def _values_of(names: Sequence[str]) -> _Values:
    if len(names) > 1:
        return itemgetter(*names)
    if names:
        (name,) = names
        return lambda given: (given[name],)
    return lambda _: ()


def _told(values_of: _Values, declaration: Declaration, floors: Floors) -> Key:
    match declaration:
        case Enumeration():
            return values_of
        case Signal():
            return lambda given: _truths(values_of(given))
        case Quantity(name):
            those = floors.get(name, ())
            if those is None:
                return lambda given: _numbers(values_of(given))
            bounds = those
            return lambda given: _digits(bounds, values_of(given))


def _truths(values: Sequence[Any]) -> Hashable:
    # As keys 1 and true are the same; as values of a signal they are not.
    if _TRUTHS.issuperset(map(type, values)):
        return values
    raise LookupError


def _numbers(values: Sequence[Any]) -> Sequence[Any]:
    # Whole numbers and floats of this size that are equal have the same decimals. nan has no size.
    for value in values:
        if not -EXACT_IN_FLOATS <= value <= EXACT_IN_FLOATS or type(value) not in _NUMBERS:
            raise LookupError
    return values


def _digits(floors: Sequence[float], values: Sequence[Any]) -> Hashable:
    return tuple([bisect_right(floors, value) for value in _numbers(values)])

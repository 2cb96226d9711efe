"""A quick look at a state: does it plainly fit the vocabulary?

What passes here passes ``check_state``. Whatever does not is looked at there, which knows the rare
cases and says what is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, TypeAlias

from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

Look: TypeAlias = Callable[[Any], bool]

_NUMBERS = frozenset({int, float})
_TRUTHS = frozenset({bool})


class FastValidator:
    """Looks at states in which these objects, of types that the vocabulary knows, are there."""

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        fitting = {
            kind: frozenset(
                name for name, own in objects.items() if vocabulary.is_subtype(own, kind)
            )
            for kind in vocabulary.types
        }
        self._looks = {
            name: _look(one, [fitting[kind] for kind in one.parameters])
            for name, one in vocabulary.declarations.items()
        }

    def passes(self, state: Any) -> bool:
        """Does it plainly fit?"""
        looks = self._looks
        try:
            if type(state) is not dict:
                return False
            return all([looks[name](value) for name, value in state.items()])  # noqa: C419 - faster
        except (LookupError, TypeError, OverflowError):
            return False


def _look(declaration: Declaration, fitting: list[frozenset[str]]) -> Look:
    if not fitting:
        return _one_value(declaration)
    values = _many_values(declaration)
    if len(fitting) == 1:
        (objects,) = fitting
        return lambda given: (
            type(given) is dict and objects.issuperset(given) and values(given.values())
        )
    objects, inner = fitting[0], _look(declaration, fitting[1:])
    return lambda given: (
        type(given) is dict and objects.issuperset(given) and all(map(inner, given.values()))
    )


def _one_value(declaration: Declaration) -> Look:
    match declaration:
        case Enumeration():
            return frozenset(declaration.values).__contains__
        case Signal():
            return lambda value: type(value) is bool
        case Quantity():
            return lambda value: type(value) in _NUMBERS and isfinite(value)


def _many_values(declaration: Declaration) -> Look:
    match declaration:
        case Enumeration():
            return frozenset(declaration.values).issuperset
        case Signal():
            return lambda values: _TRUTHS.issuperset(map(type, values))
        case Quantity():
            return lambda values: (
                _NUMBERS.issuperset(map(type, values)) and all(map(isfinite, values))
            )

"""Validation of objects and states against a vocabulary.

Incomplete or invalid states get no verdict. ``StateValidator`` first does a quick check; states
that fail it go to ``check_state``, which knows the rare types and reports what is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from rulec.diagnostics import SourceLocation
from rulec.monitoring.monitoring_messages import UNDECLARED_NAME, UNFITTING_VALUE
from rulec.monitoring.unfitting_values import (
    misfit,
    shown,
    similar_type,
    suggested,
    way_out_of,
    way_out_of_name,
)
from rulec.resource_limits import OBJECTS
from rulec.trace import State
from rulec.trace.trace_messages import UNKNOWN_OBJECT
from rulec.value_display import brief
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, UnknownValue

NUMBERS = frozenset({int, float})
TRUTHS = frozenset({bool})
"""The plain types of signals; checking others, such as a library's types, takes longer."""

_PLAIN = NUMBERS | TRUTHS | {str}

_Look: TypeAlias = Callable[[Any], bool]


class StateValidator:
    """A validator of states with these objects, whose types are known."""

    def __init__(self, vocabulary: Vocabulary, objects: Mapping[str, str]) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._looks = _Looks(vocabulary, objects)
        self._partial_looks = _Looks(vocabulary, objects, partial=True)

    def check(
        self,
        states: Iterable[State],
        where: Callable[[int], str],
        place: SourceLocation | None = None,
    ) -> bool:
        """Check each state as ``check_state`` does; ``where`` names it by its number.

        Returns whether some value is only partly known.
        """
        looks = self._looks
        for number, state in enumerate(states):
            if _passes(state, looks):
                continue
            # If something is unknown in one state, it usually is in the others, too.
            if looks is self._looks and _passes(state, self._partial_looks):
                looks = self._partial_looks
                continue
            check_state(state, self._objects, self._vocabulary, where(number), place)
            if has_partial_values(state):
                looks = self._partial_looks
        return looks is self._partial_looks


class _Looks(dict[str, _Look]):
    """Quick checks of values by name, compiled on first use; ``partial`` values may be allowed."""

    def __init__(
        self, vocabulary: Vocabulary, objects: Mapping[str, str], *, partial: bool = False
    ) -> None:
        self._vocabulary = vocabulary
        self._objects = objects
        self._partial = partial

    def __missing__(self, name: str) -> _Look:
        vocabulary = self._vocabulary
        declaration = vocabulary.declarations[name]
        fitting = [
            frozenset(
                item for item, own in self._objects.items() if vocabulary.is_subtype(own, kind)
            )
            for kind in declaration.parameters
        ]
        self[name] = _look(declaration, fitting, partial=self._partial)
        return self[name]


def _passes(state: Any, looks: _Looks) -> bool:
    """Quick check that a state fits; False means that a full check is needed."""
    try:
        if type(state) is not dict:
            return False
        return all([looks[name](value) for name, value in state.items()])  # noqa: C419 - faster
    except (LookupError, TypeError, OverflowError):
        return False


def check_objects(
    objects: Mapping[str, str], vocabulary: Vocabulary, place: SourceLocation | None = None
) -> None:
    """Check that the vocabulary knows all objects' types, and that there are not too many.

    Raises RulecError R0505, R0718.
    """
    OBJECTS.within(len(objects), place)
    for name, kind in objects.items():
        if not isinstance(kind, str) or kind not in vocabulary.types:
            said = kind if isinstance(kind, str) else brief(kind)
            raise UNKNOWN_OBJECT.error(
                place,
                f"object `{name}` is of type `{said}`, which `{vocabulary.name}` does not know",
                help=similar_type(said, vocabulary.types) or suggested(said, vocabulary.types),
            )


def check_told(
    told: Iterable[str] | None, vocabulary: Vocabulary, place: SourceLocation | None = None
) -> None:
    """Check that the vocabulary declares all the names, values or types. Raises R0502."""
    declarations, values = vocabulary.declarations, vocabulary.enumeration_of
    for name in told or ():
        if name not in declarations and name not in values and name not in vocabulary.types:
            raise UNDECLARED_NAME.error(
                place,
                f"`told` has `{name}`, which `{vocabulary.name}` does not know",
                help=way_out_of_name(name, vocabulary, (*declarations, *values)),
            )


def has_partial_values(state: Mapping[str, Any]) -> bool:
    """Whether a state has values that are unknown, or intervals."""
    for value in state.values():
        kind = type(value)
        if kind in UNKNOWN_TYPES:
            return True
        # Checking whether an object other than a dict is a mapping is slow.
        is_mapping = kind is dict or (kind not in _PLAIN and isinstance(value, Mapping))
        if is_mapping and has_partial_values(value):
            return True
    return False


def partial_names(states: Iterable[Mapping[str, Any]]) -> set[str]:
    """The names with a value, in some state, that is unknown or an interval."""
    names: set[str] = set()
    for state in states:
        for name, value in state.items():
            if name in names:
                continue
            kind = type(value)
            if kind in UNKNOWN_TYPES or (kind not in _PLAIN and has_partial_values({name: value})):
                names.add(name)
    return names


def check_state(
    state: State,
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    where: str,
    place: SourceLocation | None = None,
) -> None:
    """Check that every name and value of a state fits its declaration.

    ``where`` names the state in messages. Raises RulecError R0502, R0503 or R0505.
    """
    about = _About(objects, vocabulary, where, place)
    for name, value in state.items():
        declaration = vocabulary.declarations.get(name)
        if declaration is None:
            raise UNDECLARED_NAME.error(
                place,
                f"{where} speaks of `{name}`, which `{vocabulary.name}` does not know",
                help=way_out_of_name(name, vocabulary, vocabulary.declarations),
            )
        _check_value(value, declaration, declaration.parameters, about)


class _About(NamedTuple):
    """What values are checked against, and what messages call their state."""

    objects: Mapping[str, str]
    vocabulary: Vocabulary
    where: str
    place: SourceLocation | None


def _check_value(
    value: Any, declaration: Declaration, parameters: Sequence[str], about: _About
) -> None:
    objects, vocabulary, where, place = about
    name = declaration.name
    if not parameters:
        if expected := misfit(value, declaration):
            way_out = way_out_of(value, declaration)
            message = f"{where} says `{name}` is {shown(value)}; {expected}"
            if isinstance(value, Mapping):
                message = f"{where} gives `{name}` by object; {expected}, and about no object"
                way_out = f'write {{"{name}": VALUE}}'
            raise UNFITTING_VALUE.error(place, message, help=way_out)
        return
    if value is UNKNOWN:
        return  # of all objects
    # Checking for a mapping is far slower than checking for a dict.
    if type(value) is not dict and not isinstance(value, Mapping):
        message = f"{where} gives `{name}` one value; it is about each `{parameters[0]}`"
        way_out = f'write {{"{name}": {{"OBJECT": VALUE}}}}'
        raise UNFITTING_VALUE.error(place, message, help=way_out)
    for item, inner in value.items():
        if item not in objects:
            message = f"{where} gives `{name}` for `{item}`, which is not among the objects"
            way_out = f'objects have types: write "objects": {{"{item}": "{parameters[0]}"}}'
            raise UNKNOWN_OBJECT.error(place, message, help=suggested(item, objects) or way_out)
        if not vocabulary.is_subtype(objects[item], parameters[0]):
            message = (
                f"{where} gives `{name}` for `{item}`, which is of type `{objects[item]}`; "
                f"`{name}` is about each `{parameters[0]}`"
            )
            raise UNKNOWN_OBJECT.error(place, message)
        _check_value(inner, declaration, parameters[1:], about)


def _look(declaration: Declaration, fitting: list[frozenset[str]], *, partial: bool) -> _Look:
    if not fitting:
        return _one_value(declaration, partial=partial)
    objects, *others = fitting
    if others:
        inner = _look(declaration, others, partial=partial)
        return lambda given: (
            type(given) is dict and objects.issuperset(given) and all(map(inner, given.values()))
        )
    values = _many_values(declaration, partial=partial)
    return lambda given: (
        type(given) is dict and objects.issuperset(given) and values(given.values())
    )


def _one_value(declaration: Declaration, *, partial: bool) -> _Look:
    match declaration:
        case Enumeration():
            known = frozenset([*declaration.values, *([UNKNOWN] if partial else [])])
            if not partial:
                return known.__contains__
            return lambda value: value in known or (type(value) is OneOf and value.values <= known)
        case Signal() if partial:
            return lambda value: type(value) is bool or value is UNKNOWN
        case Signal():
            return lambda value: type(value) is bool
        case Quantity() if partial:
            return lambda value: (
                type(value) in UNKNOWN_TYPES or (type(value) in NUMBERS and math.isfinite(value))
            )
        case Quantity():
            return lambda value: type(value) in NUMBERS and math.isfinite(value)


def _unknown_of(declaration: Declaration) -> Iterable[type]:
    """The types whose values always fit a declaration."""
    match declaration:
        case Signal():
            return (bool, UnknownValue)
        case Quantity():
            return UNKNOWN_TYPES
        case Enumeration():
            return (UnknownValue,)


def _many_values(declaration: Declaration, *, partial: bool) -> _Look:
    if partial:
        fits, unknown = _one_value(declaration, partial=True), frozenset(_unknown_of(declaration))
        # Most values are of the same kind
        return lambda values: unknown.issuperset(map(type, values)) or all(map(fits, values))
    match declaration:
        case Enumeration():
            return frozenset(declaration.values).issuperset
        case Signal():
            return lambda values: TRUTHS.issuperset(map(type, values))
        case Quantity():
            return lambda values: (
                NUMBERS.issuperset(map(type, values)) and all(map(math.isfinite, values))
            )

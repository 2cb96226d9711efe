"""Validation of objects and states against a vocabulary: invalid states get no verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

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
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES

NUMBERS = frozenset({int, float})
TRUTHS = frozenset({bool})
"""The plain types of signals; checking others, such as a library's types, takes longer."""

_PLAIN = NUMBERS | TRUTHS | {str}


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


def check_states(
    states: Sequence[State],
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    where: Callable[[int], str],
    place: SourceLocation | None = None,
) -> bool:
    """Check each state as ``check_state`` does; ``where`` names it by its number.

    Returns whether some value is only partly known.
    """
    for number, state in enumerate(states):
        check_state(state, objects, vocabulary, where(number), place)
    return any(map(has_partial_values, states))


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

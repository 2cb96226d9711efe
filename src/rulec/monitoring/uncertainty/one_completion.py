"""One completion of a trace, for showing what any of them would show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rulec.monitoring.state_validation import has_partial_values
from rulec.trace import Trace, Value
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, OneOf

_PLAIN = frozenset((bool, float, int, str))
"""Types of most values that are known."""


def completed(trace: Trace, vocabulary: Vocabulary) -> Trace:
    """The trace with defaults, or least values, for what is unknown, and the middles of bounds."""
    declarations = vocabulary.declarations
    states = tuple(
        {
            name: _known(value, declarations[name], len(declarations[name].parameters))
            for name, value in state.items()
        }
        if has_partial_values(state)
        else state
        for state in trace.states
    )
    return replace(trace, states=states, ends="complete", told=None)


def with_all_defaults(vocabulary: Vocabulary) -> Vocabulary:
    """The vocabulary in which each name has a default."""
    declarations = {
        name: replace(item, default=any_value(item))  # type: ignore[arg-type]
        for name, item in vocabulary.declarations.items()
    }
    return replace(vocabulary, declarations=declarations)


def _known(value: Any, declaration: Declaration, depth: int) -> Any:
    kind = type(value)
    if kind in _PLAIN and not depth:
        return value
    if kind is dict and depth == 1 and UNKNOWN_TYPES.isdisjoint(map(type, value.values())):
        return value
    if kind is dict or isinstance(value, Mapping):
        return {name: _known(inner, declaration, depth - 1) for name, inner in value.items()}
    if depth:
        return {}  # unknown of all objects
    if isinstance(value, Interval):
        return value.middle
    if isinstance(value, OneOf):
        return min(value.values)
    return any_value(declaration) if value is UNKNOWN else value


def any_value(declaration: Declaration) -> Value:
    """The default, or else the least value."""
    if declaration.default is not None:
        return declaration.default
    match declaration:
        case Enumeration():
            return declaration.values[0]
        case Signal():
            return False
    return 0.0

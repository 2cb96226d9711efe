"""One completion of a trace, for showing what any of them would show."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
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


def kindest_values(
    formula: ltl.Formula, vocabulary: Vocabulary, facts: Collection[ltl.Formula]
) -> dict[str, Value]:
    """By name, the value by which a formula is most likely to hold, for those that have one.

    Where it is violated nevertheless that rests on what is known. Words in facts have none, which
    might be contradicted; nor have those that a count reads, whose objects are many.
    """
    signs: dict[str, dict[str | None, set[bool]]] = {}
    excluded = {name for fact in facts for name in names_in(fact)}
    for proposition, sign in _signed(formula):
        if isinstance(proposition, ltl.Atom):
            own = signs.setdefault(proposition.name, {})
            own.setdefault(proposition.value, set()).add(sign)
        else:
            excluded.update(names_in(proposition))
    found: dict[str, Value] = {}
    for name in signs.keys() - excluded:
        declaration = vocabulary.declarations[name]
        values = declaration.values if isinstance(declaration, Enumeration) else (False, True)
        kind = [value for value in values if _is_kind(value, signs[name])]
        if kind:
            default = any_value(declaration)
            found[name] = default if default in kind else kind[0]
    return found


def _signed(formula: ltl.Formula) -> Iterator[tuple[ltl.Proposition, bool]]:
    """The propositions, each with whether the formula rather holds if it is true."""
    waiting = [(formula, True)]
    while waiting:
        part, sign = waiting.pop()
        match part:
            case ltl.Unary(ltl.UnaryOperator.NOT | ltl.UnaryOperator.NEVER, operand):
                waiting.append((operand, not sign))
            case ltl.Unary(_, operand):
                waiting.append((operand, sign))
            case ltl.Binary(operator, left, right):
                both = operator in (ltl.BinaryOperator.IFF, ltl.BinaryOperator.XOR)
                waiting += [(left, not sign), (right, not sign)] if both else []
                implies = operator is ltl.BinaryOperator.IMPLIES
                waiting += [(left, sign is not implies), (right, sign)]
            case ltl.Atom() | ltl.Comparison():
                yield part, sign


def _is_kind(value: str | bool, signs: Mapping[str | None, set[bool]]) -> bool:
    """Whether each atom is true, or false, as it should be if a name has this value."""
    return all(own == {value == (wanted or True)} for wanted, own in signs.items())


def with_defaults(vocabulary: Vocabulary, values: Mapping[str, Value]) -> Vocabulary:
    """The vocabulary in which names have these defaults."""
    if not values:
        return vocabulary
    declarations = {
        name: replace(item, default=values[name]) if name in values else item  # type: ignore[arg-type]
        for name, item in vocabulary.declarations.items()
    }
    return replace(vocabulary, declarations=declarations)


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

"""One completion of a trace, to show what every completion would show."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.monitoring.state_validation import has_partial_values
from rulec.trace import Trace, Value
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, OneOf
from rulec.vocabulary.vocabulary_model import default_value, values_of

End: TypeAlias = Literal["low", "high"]

_PLAIN = frozenset((bool, float, int, str))
"""The types of most known values."""


@dataclass(frozen=True, slots=True)
class Supposed:
    """Replacements for unknown values: values by name and, for bounded numbers, which end to take.

    Other names take their default or least value, and the middle of their bounds.
    """

    values: Mapping[str, Value] = field(default_factory=dict)
    ends: Mapping[str, End] = field(default_factory=dict)


def completed(trace: Trace, vocabulary: Vocabulary, supposed: Supposed) -> Trace:
    """The trace with unknown values replaced by the supposed ones."""
    declarations = vocabulary.declarations
    states = tuple(
        {
            name: _of_all(trace.objects, len(declarations[name].parameters), supposed.values[name])
            if value is UNKNOWN and name in supposed.values
            else _known(value, declarations[name], len(declarations[name].parameters), supposed)
            for name, value in state.items()
        }
        if has_partial_values(state)
        else state
        for state in trace.states
    )
    return replace(trace, states=states, ends="complete", told=None)


def _of_all(objects: Collection[str], depth: int, value: Value) -> Any:
    """A value of the world, or the same value for all objects, or for all pairs of them."""
    return value if not depth else dict.fromkeys(objects, _of_all(objects, depth - 1, value))


def favourable(
    formula: ltl.Formula, vocabulary: Vocabulary, facts: Collection[ltl.Formula]
) -> Supposed:
    """For each name the value by which a formula most likely holds, if all atoms agree on one.

    If the formula is violated nevertheless, that rests on known values. Nothing is supposed for
    names in axioms, which might be contradicted, nor for those that a count reads, which has many
    objects.
    """
    signs: dict[str, dict[str | None, set[bool]]] = {}
    ends: dict[str, set[End | None]] = {}
    excluded = {name for fact in facts for name in names_in(fact)}
    for proposition, sign in _signed(formula):
        if isinstance(proposition, ltl.Atom):
            own = signs.setdefault(proposition.name, {})
            own.setdefault(proposition.value, set()).add(sign)
            continue
        for factor, term in proposition.terms:
            if isinstance(term, ltl.Count):
                excluded.update(names_in(term))
            else:
                is_more = (proposition.relation in (">", ">=")) == (sign == (factor > 0))
                is_equation = proposition.relation in ("=", "==", "!=")
                ends.setdefault(term.name, set()).add(
                    None if is_equation else "high" if is_more else "low"
                )
    values: dict[str, Value] = {}
    for name in signs.keys() - excluded:
        declaration = vocabulary.declarations[name]
        best = [value for value in values_of(declaration) if _is_favourable(value, signs[name])]
        if best:
            default = default_value(declaration)
            values[name] = default if default in best else best[0]
    agreed = {name: own.pop() for name, own in ends.items() if len(own) == 1}
    return Supposed(
        values,
        {name: end for name, end in agreed.items() if end is not None and name not in excluded},
    )


def _signed(formula: ltl.Formula) -> Iterator[tuple[ltl.Proposition, bool]]:
    """The propositions, each with whether the formula tends to hold if it is true."""
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


def _is_favourable(value: str | bool, signs: Mapping[str | None, set[bool]]) -> bool:
    """Whether each atom has its favourable truth value if a name has this value."""
    return all(own == {value == (wanted or True)} for wanted, own in signs.items())


def with_all_defaults(
    vocabulary: Vocabulary, supposed: Supposed, untold: Collection[str]
) -> Vocabulary:
    """The vocabulary in which each name has a default: the supposed value for ``untold`` ones."""
    values = {name: supposed.values[name] for name in supposed.values.keys() & untold}
    declarations = {
        name: replace(item, default=values.get(name, default_value(item)))  # type: ignore[arg-type]
        for name, item in vocabulary.declarations.items()
    }
    return replace(vocabulary, declarations=declarations)


def _known(value: Any, declaration: Declaration, depth: int, supposed: Supposed) -> Any:
    kind = type(value)
    if kind in _PLAIN and not depth:
        return value
    if kind is dict and depth == 1 and UNKNOWN_TYPES.isdisjoint(map(type, value.values())):
        return value
    if kind is dict or isinstance(value, Mapping):
        return {
            name: _known(inner, declaration, depth - 1, supposed) for name, inner in value.items()
        }
    if depth:
        return {}  # unknown of all objects
    if isinstance(value, Interval):
        return number_at(value, supposed.ends.get(declaration.name))
    if isinstance(value, OneOf):
        return min(value.values)
    if value is not UNKNOWN:
        return value
    return supposed.values.get(declaration.name, default_value(declaration))


def number_at(bounds: Interval, end: End | None) -> float:
    """The number at an end of bounds, or their middle."""
    if end is None:
        return bounds.middle
    return bounds.low if end == "low" else bounds.high

"""One state as a rule reads it: who is there, what is the case, and what the numbers are.

A value that a state does not give, and that has no default, is unknown. What can be told without it
is told (`x = v or gap(x, v) < 5 m` holds for v itself, whatever its gap to itself may be); nothing
else is, as in Kleene's strong three-valued logic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from rulec.logic.comparing import stands
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Count,
    Formula,
    Quantity,
    Same,
    Term,
    Unary,
    UnaryOperator,
)
from rulec.runtime.numbers import exact
from rulec.trace import State, Value
from rulec.vocabulary import Declaration, Vocabulary

_NOT = UnaryOperator.NOT
_AND, _OR, _IMPLIES = BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES
_IFF, _XOR = BinaryOperator.IFF, BinaryOperator.XOR

Bound = Mapping[str, str]
"""Variable -> the object that it stands for."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that decides but is not known: a declaration's name, and the objects it is about."""

    name: str
    objects: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Moment:
    """A state that has passed ``check_state``, and the objects that are there, with their types."""

    state: State
    objects: Mapping[str, str]
    vocabulary: Vocabulary

    def value(self, name: str, items: tuple[str, ...]) -> Value | Unknown:
        """The value that the state gives, or the declared default."""
        found = value_in(self.state, name, items, self.vocabulary.declarations[name])
        return Unknown(name, items) if found is None else found


def value_in(
    state: State, name: str, objects: Sequence[str], declaration: Declaration
) -> Value | None:
    """The value that a state gives, or the declared default; None if there is neither."""
    value: Any = state.get(name)
    for item in objects:
        value = value.get(item) if value is not None else None
    return declaration.default if value is None else value


def total(
    terms: Sequence[tuple[Fraction, Term]], bound: Bound, moment: Moment
) -> Fraction | Unknown:
    """The sum of coefficient times term: exact."""
    found = Fraction(0)
    for coefficient, term in terms:
        number = number_of(term, bound, moment)
        if isinstance(number, Unknown):
            return number
        found += coefficient * number
    return found


def number_of(term: Term, bound: Bound, moment: Moment) -> Fraction | Unknown:
    """A quantity's value, or how many objects count."""
    match term:
        case Quantity(name, arguments):
            value = moment.value(name, tuple([bound[one] for one in arguments]))
            assert not isinstance(value, str), "check_state has refused it"
            return value if isinstance(value, Unknown) else exact(value)
        case Count():
            objects = counted(term, bound, moment)
            return objects if isinstance(objects, Unknown) else Fraction(len(objects))


def counted(count: Count, bound: Bound, moment: Moment) -> tuple[str, ...] | Unknown:
    """The objects that count."""
    found = []
    fitting: dict[str, bool] = {}
    inner = dict(bound)
    for name, kind in moment.objects.items():
        if kind not in fitting:
            fitting[kind] = moment.vocabulary.is_subtype(kind, count.type)
        if fitting[kind]:
            inner[count.variable] = name
            truth = holds(count.body, inner, moment)
            if isinstance(truth, Unknown):
                return truth
            if truth:
                found.append(name)
    return tuple(found)


def holds(formula: Formula, bound: Bound, moment: Moment) -> bool | Unknown:
    """Does a formula without temporal operators hold?"""
    match formula:
        case Atom(name, arguments, wanted):
            value = moment.value(name, tuple([bound[one] for one in arguments]))
            return value if isinstance(value, Unknown) else value == (wanted or True)
        case Comparison(terms, relation, limit):
            number = total(terms, bound, moment)
            return number if isinstance(number, Unknown) else stands(number, relation, limit)
        case Same(one, other):
            return bound[one] == bound[other]
        case Constant(truth):
            return truth
        case Unary(operator, operand) if operator is _NOT:
            return _not(holds(operand, bound, moment))
        case Binary(operator, left, right):
            first = holds(left, bound, moment)
            if operator is _AND:
                return _joined(first, right, bound, moment, settled_by=False)
            if operator is _OR:
                return _joined(first, right, bound, moment, settled_by=True)
            if operator is _IMPLIES:
                return _joined(_not(first), right, bound, moment, settled_by=True)
            if operator is _IFF:
                return _alike(first, holds(right, bound, moment))
            if operator is _XOR:
                return _not(_alike(first, holds(right, bound, moment)))
    raise TypeError("this formula does not speak of one state alone")


def _joined(
    first: bool | Unknown, right: Formula, bound: Bound, moment: Moment, *, settled_by: bool
) -> bool | Unknown:
    """``and``, which one operand that is false settles; or ``or``, which a true one does."""
    if first is settled_by:
        return settled_by
    second = holds(right, bound, moment)
    if second is settled_by:
        return settled_by
    return first if isinstance(first, Unknown) else second


def _alike(first: bool | Unknown, second: bool | Unknown) -> bool | Unknown:
    if isinstance(first, Unknown):
        return first
    return second if isinstance(second, Unknown) else first is second


def _not(truth: bool | Unknown) -> bool | Unknown:
    return truth if isinstance(truth, Unknown) else not truth

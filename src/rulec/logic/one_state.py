"""The value of a formula in one state, of which something may not be known.

What can be told without it is told (`x = v or gap(x, v) < 5 m` holds for v itself, whatever its gap
to itself may be); nothing else is, as in Kleene's strong three-valued logic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

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
from rulec.vocabulary import Vocabulary

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


class Situation(Protocol):
    """What is the case in a state, and who is there."""

    @property
    def objects(self) -> Mapping[str, str]:
        """The objects that are there, with their types."""

    @property
    def vocabulary(self) -> Vocabulary:
        """What can be said of them."""

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """The value of a signal or an enumeration."""

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The value of a quantity."""


def total(
    terms: Sequence[tuple[Fraction, Term]], bound: Bound, moment: Situation
) -> Fraction | Unknown:
    """The sum of coefficient times term: exact."""
    found = Fraction(0)
    for coefficient, term in terms:
        number = number_of(term, bound, moment)
        if isinstance(number, Unknown):
            return number
        found += coefficient * number
    return found


def number_of(term: Term, bound: Bound, moment: Situation) -> Fraction | Unknown:
    """A quantity's value, or how many objects count."""
    match term:
        case Quantity(name, arguments):
            return moment.number(name, tuple([bound[one] for one in arguments]))
        case Count():
            objects = counted(term, bound, moment)
            return objects if isinstance(objects, Unknown) else Fraction(len(objects))


def counted(count: Count, bound: Bound, moment: Situation) -> tuple[str, ...] | Unknown:
    """The objects that count."""
    found = []
    fitting: dict[str, bool] = {}
    inner = dict(bound)
    there = moment.objects
    same = _same_as(count.variable, count.body)
    candidates = there if same is None else [one for one in (bound[same],) if one in there]
    for name in candidates:
        kind = there[name]
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


def _same_as(variable: str, formula: Formula) -> str | None:
    """Another variable that stands for the same object wherever the formula holds, if one does."""
    match formula:
        case Same(one, other) if variable in (one, other) and one != other:
            return other if one == variable else one
        case Binary(operator, left, right) if operator is _AND:
            return _same_as(variable, left) or _same_as(variable, right)
    return None


def holds(formula: Formula, bound: Bound, moment: Situation) -> bool | Unknown:
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
    first: bool | Unknown, right: Formula, bound: Bound, moment: Situation, *, settled_by: bool
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

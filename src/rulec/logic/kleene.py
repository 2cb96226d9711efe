"""The value of a formula in one state, of which something may not be known.

What can be told without it is told (`x = v or gap(x, v) < 5 m` holds for v itself, whatever its gap
to itself may be); nothing else is, as in Kleene's strong three-valued logic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Protocol, TypeAlias

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Count,
    Formula,
    Quantity,
    Relation,
    Same,
    Term,
    Unary,
    UnaryOperator,
)
from rulec.logic.linear_comparison import stands
from rulec.vocabulary import Vocabulary

_NOT = UnaryOperator.NOT
_AND, _OR, _IMPLIES = BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES
_IFF, _XOR = BinaryOperator.IFF, BinaryOperator.XOR
_AT_ONCE = frozenset({_AND, _OR, _IMPLIES, _IFF, _XOR})

_MOST = 1 << 12
"""So many formulas are kept ready to be asked."""

Bound = Mapping[str, str]
"""Variable -> the object that it stands for."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that decides but is not known: a declaration's name, and the objects it is about."""

    name: str
    objects: tuple[str, ...]


class PartialState(Protocol):
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


_Judge: TypeAlias = Callable[[Bound, PartialState], bool | Unknown]


def total(
    terms: Sequence[tuple[Fraction, Term]], bound: Bound, moment: PartialState
) -> Fraction | Unknown:
    """The sum of coefficient times term: exact."""
    found = Fraction(0)
    for coefficient, term in terms:
        number = number_of(term, bound, moment)
        if isinstance(number, Unknown):
            return number
        found += coefficient * number
    return found


def number_of(term: Term, bound: Bound, moment: PartialState) -> Fraction | Unknown:
    """A quantity's value, or how many objects count."""
    match term:
        case Quantity(name, arguments):
            return moment.number(name, tuple([bound[one] for one in arguments]))
        case Count():
            objects = counted(term, bound, moment)
            return objects if isinstance(objects, Unknown) else Fraction(len(objects))


def counted(count: Count, bound: Bound, moment: PartialState) -> tuple[str, ...] | Unknown:
    """The objects that count."""
    found = []
    fitting: dict[str, bool] = {}
    inner = dict(bound)
    there = moment.objects
    same, judge = _same_as(count.variable, count.body), _judge_of(count.body)
    candidates = there if same is None else [one for one in (bound[same],) if one in there]
    for name in candidates:
        kind = there[name]
        if kind not in fitting:
            fitting[kind] = moment.vocabulary.is_subtype(kind, count.type)
        if fitting[kind]:
            inner[count.variable] = name
            truth = judge(inner, moment)
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


def holds(formula: Formula, bound: Bound, moment: PartialState) -> bool | Unknown:
    """Does a formula without temporal operators hold? TypeError if it has one."""
    return _judge_of(formula)(bound, moment)


@lru_cache(maxsize=_MOST)
def _judge_of(formula: Formula) -> _Judge:
    """What says whether a formula holds: it is asked of every object in every state."""
    match formula:
        case Atom(name, arguments, wanted):
            return _atom(name, arguments, wanted or True)
        case Comparison(terms, relation, limit):
            return _comparison(terms, relation, limit)
        case Same(one, other):
            return lambda bound, _: bound[one] == bound[other]
        case Constant(truth):
            return lambda _, __: truth
        case Unary(operator, operand) if operator is _NOT:
            return _negation(_judge_of(operand))
        case Binary(operator, left, right) if operator in _AT_ONCE:
            first, second = _judge_of(left), _judge_of(right)
            if operator is _AND:
                return _joined(first, second, settled_by=False)
            if operator is _OR:
                return _joined(first, second, settled_by=True)
            if operator is _IMPLIES:
                return _joined(_negation(first), second, settled_by=True)
            alike = _alike(first, second)
            return alike if operator is _IFF else _negation(alike)
    raise TypeError("this formula does not speak of one state alone")


def _atom(name: str, arguments: tuple[str, ...], wanted: bool | str) -> _Judge:
    if len(arguments) == 1:
        return _atom_of_one(name, arguments[0], wanted)

    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        value = moment.value(name, tuple([bound[one] for one in arguments]))
        return value if isinstance(value, Unknown) else value == wanted

    return judge


def _atom_of_one(name: str, argument: str, wanted: bool | str) -> _Judge:
    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        value = moment.value(name, (bound[argument],))
        return value if isinstance(value, Unknown) else value == wanted

    return judge


def _comparison(
    terms: Sequence[tuple[Fraction, Term]], relation: Relation, limit: Fraction
) -> _Judge:
    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        number = total(terms, bound, moment)
        return number if isinstance(number, Unknown) else stands(number, relation, limit)

    return judge


def _negation(operand: _Judge) -> _Judge:
    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        truth = operand(bound, moment)
        return truth if isinstance(truth, Unknown) else not truth

    return judge


def _joined(left: _Judge, right: _Judge, *, settled_by: bool) -> _Judge:
    """``and``, which one operand that is false settles; or ``or``, which a true one does."""

    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        first = left(bound, moment)
        if first is settled_by:
            return settled_by
        second = right(bound, moment)
        return second if second is settled_by or first is not_settled else first

    not_settled = not settled_by
    return judge


def _alike(left: _Judge, right: _Judge) -> _Judge:
    def judge(bound: Bound, moment: PartialState) -> bool | Unknown:
        first, second = left(bound, moment), right(bound, moment)
        if isinstance(first, Unknown):
            return first
        return second if isinstance(second, Unknown) else first is second

    return judge

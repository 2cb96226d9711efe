"""One interpretation of the operators over any algebra: the catamorphism of formulas.

An algebra defines the meaning of propositions, constants and a few operators in its values: sets of
letters as bits, Kleene's truth values, BDDs, Spot's formulas, columns. The derived operators follow
by the laws of Boolean algebra and the dualities of temporal logic (Manna, Pnueli, "The temporal
logic of reactive and concurrent systems", 1992). ``semantics`` does not use this module, since it
is the reference.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, MutableMapping
from dataclasses import dataclass
from functools import partial
from operator import and_, or_, xor
from typing import Generic, TypeAlias, TypeVar

from rulec.logic import formula as ltl
from rulec.logic.bounds import Range, range_of

Value = TypeVar("Value")

Join: TypeAlias = Callable[[Value, Value], Value]


@dataclass(frozen=True, slots=True, kw_only=True)
class Algebra(Generic[Value]):
    """The meaning of formulas, defined operator by operator.

    ``implication`` and ``difference`` (xor) are derived from the others if missing. Without
    ``identity`` a formula must not contain ``Same``; without ``operation``, which receives the
    operation and the fold of its operands, it must not contain a temporal operator. With
    ``is_false`` a right operand is left out beside a left one that settles the value.
    """

    proposition: Callable[[ltl.Proposition], Value]
    constant: Callable[[bool], Value]
    negation: Callable[[Value], Value]
    conjunction: Join[Value]
    disjunction: Join[Value]
    equivalence: Join[Value]
    implication: Join[Value] | None = None
    difference: Join[Value] | None = None
    identity: Callable[[ltl.Same], Value] | None = None
    operation: Callable[[ltl.Unary | ltl.Binary, Callable[[ltl.Formula], Value]], Value] | None = (
        None
    )
    is_false: Callable[[Value], bool] | None = None


def fold(
    formula: ltl.Formula,
    algebra: Algebra[Value],
    known: MutableMapping[ltl.Formula, Value] | None = None,
) -> Value:
    """The formula's value in an algebra.

    Operands are evaluated before their operations, from left to right. ``known`` caches the values
    of all parts, so that each is computed once.

    Raises:
        ValueError: for an identity, if the algebra has none.
        TypeError: for a temporal operator, if the algebra has none.
    """
    if known is None:
        return _value(formula, algebra, None)
    value = known.get(formula)
    if value is None:
        value = known[formula] = _value(formula, algebra, known)
    return value


def _value(
    formula: ltl.Formula, algebra: Algebra[Value], known: MutableMapping[ltl.Formula, Value] | None
) -> Value:
    match formula:
        case ltl.Atom() | ltl.Comparison():
            return algebra.proposition(formula)
        case ltl.Same():
            if algebra.identity is None:
                raise ValueError(f"`{formula}` is asked of counted objects, not of a word")
            return algebra.identity(formula)
        case ltl.Constant(value):
            return algebra.constant(value)
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return algebra.negation(fold(operand, algebra, known))
        case ltl.Binary(operator, left, right) if operator in _CONNECTIVES:
            first = fold(left, algebra, known)
            if known is None and algebra.is_false is not None and operator in _SETTLED_BY:
                asked = first if _SETTLED_BY[operator] is False else algebra.negation(first)
                if algebra.is_false(asked):
                    implies = operator is ltl.BinaryOperator.IMPLIES
                    return algebra.negation(first) if implies else first
            return _joined(operator, first, fold(right, algebra, known), algebra)
        case ltl.Unary() | ltl.Binary():
            if algebra.operation is None:
                raise TypeError("this formula does not speak of one state alone")
            return algebra.operation(formula, partial(fold, algebra=algebra, known=known))


_CONNECTIVES = frozenset(
    {
        ltl.BinaryOperator.AND,
        ltl.BinaryOperator.OR,
        ltl.BinaryOperator.IMPLIES,
        ltl.BinaryOperator.IFF,
        ltl.BinaryOperator.XOR,
    }
)


_SETTLED_BY = {
    ltl.BinaryOperator.AND: False,
    ltl.BinaryOperator.OR: True,
    ltl.BinaryOperator.IMPLIES: False,
}
"""The value of the left operand beside which the right one is of no account."""


def _joined(
    operator: ltl.BinaryOperator, left: Value, right: Value, algebra: Algebra[Value]
) -> Value:
    match operator:
        case ltl.BinaryOperator.AND:
            return algebra.conjunction(left, right)
        case ltl.BinaryOperator.OR:
            return algebra.disjunction(left, right)
        case ltl.BinaryOperator.IFF:
            return algebra.equivalence(left, right)
        case ltl.BinaryOperator.IMPLIES:
            if algebra.implication is None:
                return algebra.disjunction(algebra.negation(left), right)
            return algebra.implication(left, right)
        case _:
            if algebra.difference is None:
                return algebra.negation(algebra.equivalence(left, right))
            return algebra.difference(left, right)


def bit_sets(sets: Mapping[ltl.Proposition, int], everything: int) -> Algebra[int]:
    """The algebra of sets as bits of integers.

    ``sets`` has one for each proposition, and ``everything`` is the set of all elements.
    """
    return Algebra(
        proposition=sets.__getitem__,
        constant=lambda value: everything if value else 0,
        negation=everything.__xor__,
        conjunction=and_,
        disjunction=or_,
        equivalence=lambda left, right: everything ^ left ^ right,
        difference=xor,
    )


WordJoin: TypeAlias = Callable[[Value | None, Value, Range], Value]
"""A function of the left operand (None for a constant), the right operand, and the range."""


def temporal_operation(
    negation: Callable[[Value], Value],
    *,
    until: WordJoin[Value],
    release: WordJoin[Value],
    weak_until: Callable[[Value, Value, Range], Value],
    strong_release: Callable[[Value, Value, Range], Value],
    since: WordJoin[Value] | None = None,
) -> Callable[[ltl.Unary | ltl.Binary, Callable[[ltl.Formula], Value]], Value]:
    """The temporal operators, derived from four of the future and one of the past.

    For the ``operation`` of an algebra of words; one without ``since`` has no past.

    ``until`` without a left operand means ``eventually``, ``release`` without one means ``always``,
    ``since`` without one ``once``. Bounds are in steps. The operation raises ValueError for an
    operator of a past that there is not.
    """

    def operation(
        formula: ltl.Unary | ltl.Binary, value_of: Callable[[ltl.Formula], Value]
    ) -> Value:
        span = range_of(formula)
        match formula:
            case ltl.Unary(ltl.UnaryOperator.NEXT | ltl.UnaryOperator.EVENTUALLY, operand):
                return until(None, value_of(operand), span)
            case ltl.Unary(ltl.UnaryOperator.WEAK_NEXT | ltl.UnaryOperator.ALWAYS, operand):
                return release(None, value_of(operand), span)
            case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
                return release(None, negation(value_of(operand)), span)
            case ltl.Binary(ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN, left, right):
                return until(value_of(left), value_of(right), span)
            case ltl.Binary(ltl.BinaryOperator.RELEASE, left, right):
                return release(value_of(left), value_of(right), span)
            case ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right):
                return weak_until(value_of(left), value_of(right), span)
            case ltl.Binary(ltl.BinaryOperator.STRONG_RELEASE, left, right):
                return strong_release(value_of(left), value_of(right), span)
        if since is None:
            raise ValueError(f"`{formula.operator.value}` is an operator of the past")
        match formula:
            case ltl.Unary(ltl.UnaryOperator.ONCE | ltl.UnaryOperator.PREVIOUSLY, operand):
                return since(None, value_of(operand), span)
            case ltl.Unary(_, operand):
                return negation(since(None, negation(value_of(operand)), span))
            case ltl.Binary(_, left, right):
                return since(value_of(left), value_of(right), span)

    return operation


def fold_constants(formula: ltl.Formula) -> ltl.Formula:
    """An equivalent formula without constant operands of ``and``, ``or``, ``implies``, ``not``."""
    return fold(formula, _FOLDED)


def _negation(operand: ltl.Formula) -> ltl.Formula:
    if isinstance(operand, ltl.Constant):
        return ltl.Constant(not operand.value)
    return ltl.Unary(ltl.UnaryOperator.NOT, operand)


def _neutral_left_out(
    operator: ltl.BinaryOperator, neutral: bool, left: ltl.Formula, right: ltl.Formula
) -> ltl.Formula:
    """The conjunction or disjunction, simplified if an operand is a constant."""
    for operand, other in ((left, right), (right, left)):
        if isinstance(operand, ltl.Constant):
            return other if operand.value == neutral else operand
    return ltl.Binary(operator, left, right)


def _implication(left: ltl.Formula, right: ltl.Formula) -> ltl.Formula:
    if isinstance(left, ltl.Constant):
        return right if left.value else ltl.Constant(True)
    if isinstance(right, ltl.Constant):
        return right if right.value else _negation(left)
    return ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right)


_FOLDED: Algebra[ltl.Formula] = Algebra(
    proposition=lambda proposition: proposition,
    identity=lambda same: same,
    constant=ltl.Constant,
    negation=_negation,
    conjunction=partial(_neutral_left_out, ltl.BinaryOperator.AND, True),
    disjunction=partial(_neutral_left_out, ltl.BinaryOperator.OR, False),
    implication=_implication,
    equivalence=partial(ltl.Binary, ltl.BinaryOperator.IFF),
    difference=partial(ltl.Binary, ltl.BinaryOperator.XOR),
    operation=ltl.with_operands,
)

"""Bounds of time behind temporal operators."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Literal

from rulec.logic.formula import Bound
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate import bound_messages as say
from rulec.rulebook.elaborate.number_literals import exact_value
from rulec.rulebook.elaborate.scope import Scope
from rulec.syntax import tree
from rulec.vocabulary.units import DIMENSIONS

_ONE_INSTANT = frozenset(("next", "weak next", "previously", "weak previously"))
_STEPS = frozenset(("step", "steps"))

Evaluate = Callable[[tree.Formula, Scope], NumberByCases | None]

_Time = tuple[Fraction, Literal["s", "steps"]]


def bound_of(
    node: tree.Prefix | tree.Infix, bound: tree.BoundNode | None, scope: Scope, evaluate: Evaluate
) -> Bound | Literal[False] | None:
    """The meaning of a bound; False if it has a reported mistake.

    ``evaluate`` gives the number that a parameter stands for.
    """
    if bound is None:
        return None
    sides = [side for side in (bound.low, bound.high) if side is not None]
    times = [_time(side, scope, evaluate) for side in sides]
    if bound.exact:
        times = times[:1] * 2
    good = [time for time in times if time is not None]
    if len(good) < len(times):
        return False
    units = {unit for amount, unit in good if amount != 0} or {good[0][1]}
    if len(units) > 1:
        scope.report(say.two_units_of_time(bound))
        return False
    unit = units.pop()
    if bound.exact != (node.operator in _ONE_INSTANT):
        scope.report(say.wrong_form(node, bound))
        return False
    amounts = [amount for amount, _ in good]
    low = Fraction(0) if bound.low is None else amounts[0]
    high = None if bound.high is None else amounts[-1]
    if high is not None and high < low:
        scope.report(say.empty_bound(bound))
        return False
    return Bound(low, high, unit, bound.span)


def _time(side: tree.Amount, scope: Scope, evaluate: Evaluate) -> _Time | None:
    if isinstance(side, tree.NumberLiteral) and side.unit in _STEPS:
        whole = exact_value(side, scope)
        if whole is None:
            return None
        if whole.denominator != 1:
            scope.report(say.half_a_step(side))
            return None
        return whole, "steps"
    number = evaluate(side, scope)
    if number is None:
        return None
    if not number.is_constant or number.dimension not in (None, DIMENSIONS["time"]):
        scope.report(say.no_time(side, number))
        return None
    amount = number.cases[0][1].constant
    if amount < 0:
        scope.report(say.no_time(side, number))
        return None
    return amount, "s"

"""Written numbers with their units, and time bounds made of them."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Literal

from rulec.logic.formula import Bound
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases, constant, share_of
from rulec.rulebook.elaborate import constant_messages as say
from rulec.rulebook.elaborate.elaboration_messages import point_of_thousands, too_long
from rulec.rulebook.elaborate.scope import Evaluate, Scope
from rulec.rulebook.names.declaration_messages import unknown_unit
from rulec.syntax import tree
from rulec.vocabulary.dimensions import DIMENSIONS

_LONGEST = 400
"""The most characters of a number, and its largest exponent. Floats need fewer."""

_EXPONENT = re.compile(r"[eE]([+-]?[0-9]+)$")

_IN_THOUSANDS = re.compile(r"[1-9][0-9]{0,2}\.[0-9]{2}0")
"""How most of Europe writes numbers of thousands, and nobody writes decimals."""

_ONE_INSTANT = frozenset(("next", "weak next", "previously", "weak previously"))


def literal(node: tree.NumberLiteral, scope: Scope) -> NumberByCases | None:
    """Number literal with its unit; None after a reported mistake."""
    value = exact_value(node, scope)
    if value is None:
        return None
    if _IN_THOUSANDS.fullmatch(node.text):
        scope.report(point_of_thousands(node))
    if not node.unit:
        if value == 0:
            return constant(value, None, node.text)
        return constant(value, DIMENSIONS["number"], node.text, share="")
    unit = scope.symbols.unit(node.unit)
    if unit is None:
        scope.report(unknown_unit(node.unit, node.span))
        return None
    text = f"{node.text} {node.unit}"
    return constant(value * unit.factor, unit.dimension, text, share_of(unit))


def exact_value(node: tree.NumberLiteral, scope: Scope) -> Fraction | None:
    """The exact value of a number literal, without unit; None if it is too long or too large."""
    exponent = _EXPONENT.search(node.text)
    short = len(node.text) <= _LONGEST and (exponent is None or abs(int(exponent[1])) <= _LONGEST)
    if not math.isfinite(float(node.text)):
        return None  # which has been reported where it was read
    if short:
        return Fraction(node.text)
    scope.report(too_long(node))
    return None


def bound_of(
    node: tree.Prefix | tree.Infix, scope: Scope, evaluate: Evaluate
) -> Bound | Literal[False] | None:
    """The meaning of an operator's bound; False if it has a reported mistake.

    ``evaluate`` gives the value of a parameter.
    """
    bound = node.bound
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
    amounts = [amount for amount, _ in good]
    low = Fraction(0) if bound.low is None else amounts[0]
    high = None if bound.high is None else amounts[-1]
    if len(units) > 1:
        scope.report(say.two_units_of_time(bound))
    elif bound.exact != (node.operator in _ONE_INSTANT):
        scope.report(say.wrong_form(node, bound))
    elif high is not None and high < low:
        scope.report(say.empty_bound(bound))
    else:
        return Bound(low, high, units.pop(), bound.span)
    return False


def _time(
    side: tree.Amount, scope: Scope, evaluate: Evaluate
) -> tuple[Fraction, Literal["s", "steps"]] | None:
    if isinstance(side, tree.NumberLiteral) and side.unit in ("step", "steps"):
        whole = exact_value(side, scope)
        if whole is not None and whole.denominator == 1:
            return whole, "steps"
        if whole is not None:
            scope.report(say.half_a_step(side))
        return None
    number = evaluate(side, scope)
    if number is None:
        return None
    amount = number.cases[0][1].constant
    is_time = number.dimension in (None, DIMENSIONS["time"])
    if number.is_constant and is_time and amount >= 0:
        return amount, "s"
    scope.report(say.no_time(side, number))
    return None

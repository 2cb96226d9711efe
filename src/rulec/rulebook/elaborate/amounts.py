"""Written numbers with their units, and time bounds made of them."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Literal

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, offering
from rulec.logic.formula import Bound
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases, constant, share_of
from rulec.rulebook.elaborate.elaboration_messages import (
    kind_of,
    point_of_thousands,
    short,
    too_long,
)
from rulec.rulebook.elaborate.scope import Evaluate, Scope
from rulec.rulebook.names.declaration_messages import unknown_unit
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import exchanged
from rulec.syntax.tree_printer import print_formula
from rulec.vocabulary.dimensions import DIMENSIONS, LENGTH

SENSELESS_BOUND = Code(
    "R0317",
    title="a time bound makes no sense",
    why="Bounds are fixed times or whole numbers of steps: `[<= 3 s]`, `[>= 2 steps]`, `[1 s .. 4 "
    "s]`. `next` and `previously` refer to one instant: `next[2 steps]`.",
    bad="rulebook example\nsignal wet\nhard rule r { require eventually[4 s .. 1 s] wet }\n",
    good="rulebook example\nsignal wet\nhard rule r { require eventually[1 s .. 4 s] wet }\n",
)


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
        scope.report(_two_units_of_time(bound))
    elif bound.exact != (node.operator in _ONE_INSTANT):
        scope.report(_wrong_form(node, bound))
    elif high is not None and high < low:
        scope.report(_empty_bound(bound))
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
            scope.report(_half_a_step(side))
        return None
    number = evaluate(side, scope)
    if number is None:
        return None
    amount = number.cases[0][1].constant
    is_time = number.dimension in (None, DIMENSIONS["time"])
    if number.is_constant and is_time and amount >= 0:
        return amount, "s"
    scope.report(_no_time(side, number))
    return None


def _two_units_of_time(bound: tree.BoundNode) -> Diagnostic:
    return SENSELESS_BOUND.at(
        bound.span,
        "a bound is in units of time or in steps, not in both",
        expected="expected one of them",
        help="write both ends in seconds, or both in steps",
    )


def _wrong_form(node: tree.Prefix | tree.Infix, bound: tree.BoundNode) -> Diagnostic:
    """``next[<= 2 s]`` or ``eventually[2 s]``."""
    amount = bound.high or bound.low
    text = print_formula(amount) if amount else "2 s"
    if bound.exact:
        message = f"`{node.operator}` looks at a stretch of time, and this is an instant"
        way_out: Help = offering(
            f"write `[<= {text}]`, `[>= {text}]` or `[{text} .. {text}]`",
            f"[<= {text}]",
            f"[>= {text}]",
        )
    else:
        message = f"`{node.operator}` looks at one instant, and this is a stretch of time"
        instant = f"write `{node.operator}[{text}]`"
        if bound.high and not bound.low and node.operator in ("next", "previously"):
            within = "eventually" if node.operator == "next" else "once"
            instant += f" for that instant, `{within}[<= {text}]` for one on the way there"
        way_out = instant
    return SENSELESS_BOUND.at(bound.span, message, expected="expected another bound", help=way_out)


def _empty_bound(bound: tree.BoundNode) -> Diagnostic:
    """``[4 s .. 1 s]``."""
    ends = [end.span.text for end in (bound.low, bound.high) if end is not None]
    return SENSELESS_BOUND.at(
        bound.span,
        "the bound ends before it begins",
        expected="expected the smaller number first",
        help=offering("exchange the two", *(exchanged(bound.span, *ends) if len(ends) > 1 else ())),
    )


def _half_a_step(side: tree.NumberLiteral) -> Diagnostic:
    """``[<= 1.5 steps]``."""
    return SENSELESS_BOUND.at(
        side.span,
        f"there is no {side.text} of a step",
        expected="expected a whole number of steps",
        help="write a whole number, or a time in seconds",
    )


def _no_time(side: tree.Amount, number: NumberByCases) -> Diagnostic:
    way_out = "write a time, such as `3 s`, or a number of steps, such as `2 steps`"
    if not number.is_constant:
        why = "changes from state to state"
    elif number.dimension is None or number.cases[0][1].constant < 0:
        why = "is below 0"
    else:
        why = f"is {kind_of(number.dimension)}"
        if number.dimension == LENGTH:
            way_out = "write a time, such as `3 s`; how far is compared, as in `gap(v) <= 100 m`"
    return SENSELESS_BOUND.at(
        side.span,
        f"`{short(side)}` {why}; a bound is a fixed time",
        expected="expected a time",
        help=way_out,
    )

"""Bounds of temporal operators: seconds converted to steps, and ranges of instants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from math import ceil, floor, gcd, lcm
from typing import NamedTuple

from rulec.diagnostics import Span
from rulec.logic import formula as ltl
from rulec.logic.formula import parts_in

PAST: frozenset[ltl.UnaryOperator | ltl.BinaryOperator] = frozenset(
    (
        ltl.UnaryOperator.ONCE,
        ltl.UnaryOperator.HISTORICALLY,
        ltl.UnaryOperator.PREVIOUSLY,
        ltl.UnaryOperator.WEAK_PREVIOUSLY,
        ltl.BinaryOperator.SINCE,
    )
)
"""The operators that refer to the past."""

BOOLEAN: frozenset[ltl.UnaryOperator | ltl.BinaryOperator] = frozenset(
    (
        ltl.UnaryOperator.NOT,
        ltl.BinaryOperator.AND,
        ltl.BinaryOperator.OR,
        ltl.BinaryOperator.IMPLIES,
        ltl.BinaryOperator.IFF,
        ltl.BinaryOperator.XOR,
    )
)
"""The operators that refer to the present only."""

DISTANCE: frozenset[ltl.UnaryOperator | ltl.BinaryOperator] = frozenset(
    (
        ltl.UnaryOperator.NEXT,
        ltl.UnaryOperator.WEAK_NEXT,
        ltl.UnaryOperator.PREVIOUSLY,
        ltl.UnaryOperator.WEAK_PREVIOUSLY,
    )
)
"""The operators that refer to a single instant: without a bound, to the adjacent one."""


_LATER = frozenset({ltl.BinaryOperator.THEN})
_UNBOUNDED, _LATER_ON = (ltl.Bound(Fraction(low), None, "steps") for low in (0, 1))
PREVIOUS = ltl.Bound(Fraction(1), Fraction(1), "steps")
"""The bound of what is about the adjacent instant."""


class Range(NamedTuple):
    """The instants from ``low`` to ``high`` steps away, both included.

    ``high`` is None if the range is unbounded. A range may be empty.
    """

    low: int
    high: int | None


def bound_of(formula: ltl.Unary | ltl.Binary) -> ltl.Bound:
    """The bound of the formula's operator, also where none is written.

    For ``then`` it is that of its ``until``: the first phase lasts at least one instant.
    """
    bound, operator = formula.bound, formula.operator
    if bound is None:
        later = _LATER_ON if operator in _LATER else _UNBOUNDED
        return PREVIOUS if operator in DISTANCE else later
    return replace(bound, span=None, least=max(bound.least, int(operator in _LATER)))


def range_of(formula: ltl.Unary | ltl.Binary) -> Range:
    """The range of ``bound_of`` the formula.

    Raises ValueError for a bound in seconds, or in fractions of a step.
    """
    return range_of_bound(bound_of(formula))


def range_of_bound(bound: ltl.Bound) -> Range:
    """The range of a bound in steps. Raises ValueError for any other."""
    if bound.unit == "s":
        raise ValueError("a bound in seconds has no meaning without the step of a trace")
    low, high = _whole(bound.low), None if bound.high is None else _whole(bound.high)
    return Range(max(low, bound.least), high)


def _whole(steps: Fraction) -> int:
    if steps.denominator != 1:
        raise ValueError(f"{steps} steps are no whole number")
    return steps.numerator


def has_seconds(formula: ltl.Formula) -> bool:
    """Whether the formula has a bound in seconds, and thus depends on the step of a trace."""
    bounds = (operation.bound for operation in operations_of(formula))
    return any(bound is not None and bound.unit == "s" for bound in bounds)


def fitting_step(formula: ltl.Formula, step_s: Fraction) -> Fraction:
    """The longest time (s) that divides a step and all bounds in seconds."""
    bounds = [operation.bound for operation in operations_of(formula)]
    seconds = [bound for bound in bounds if bound is not None and bound.unit == "s"]
    ends = [end for bound in seconds for end in (bound.low, bound.high) if end is not None]
    return longest_divisor((step_s, *ends))


def longest_divisor(times: Iterable[Fraction]) -> Fraction:
    """The longest time of which all these times (at least one) are multiples."""
    listed = list(times)
    whole = lcm(*(time.denominator for time in listed))
    return Fraction(gcd(*(int(time * whole) for time in listed)), whole)


def operations_of(formula: ltl.Formula) -> Iterator[ltl.Unary | ltl.Binary]:
    """The operations in a formula, except in bodies of counts, each before its operands."""
    return (part for part in parts_in(formula) if isinstance(part, ltl.Unary | ltl.Binary))


def looks_elsewhere(formula: ltl.Formula) -> bool:
    """Whether a formula refers to other states than the present one."""
    return any(operation.operator not in BOOLEAN for operation in operations_of(formula))


def between_instants(formula: ltl.Formula, step_s: Fraction) -> tuple[Fraction, Span | None] | None:
    """The first bound (s) of a formula that is no multiple of a step, and where it is written."""
    for operation in operations_of(formula):
        bound = operation.bound
        if bound is not None and bound.unit == "s":
            for end in (bound.low, bound.high):
                if end is not None and (end / step_s).denominator != 1:
                    return end, bound.span
    return None


def in_steps(formula: ltl.Formula, step_s: Fraction) -> ltl.Formula:
    """The formula with bounds in steps of ``step_s`` seconds, without their ``span``.

    A bound in seconds is about the instants that exist, a whole number of steps away: within 0.5 s
    are, at steps of 0.2 s, those 0.2 and 0.4 s away. Where none exists the range is empty.

    Raises ValueError if the step is not positive.
    """
    if step_s <= 0:
        raise ValueError("a step lasts more than 0 s")
    if not isinstance(formula, ltl.Unary | ltl.Binary):
        return formula
    inside = ltl.with_operands(formula, lambda operand: in_steps(operand, step_s))
    bound = inside.bound
    return inside if bound is None else replace(inside, bound=bound_in_steps(bound, step_s))


def bound_in_steps(bound: ltl.Bound, step_s: Fraction) -> ltl.Bound:
    """A bound in steps of so many seconds, as ``in_steps``."""
    if bound.unit == "steps":
        return replace(bound, span=None)
    low = Fraction((floor if bound.early else ceil)(bound.low / step_s))
    high = None if bound.high is None else Fraction(floor(bound.high / step_s))
    return ltl.Bound(low, high, "steps", least=bound.least)


def begins_at(bound: ltl.Bound) -> frozenset[int]:
    """Where a bound begins: 0 if now, 1 if at another instant, both if that depends on the step."""
    if bound.early and bound.unit == "s" and not bound.least:
        return frozenset({0, 1} if bound.low else {0})
    return frozenset({int(bound.low > 0 or bound.least > 0)})


def total_bound(formula: ltl.Formula) -> int:
    """The sum of all bounds of a formula in steps: their upper ends, or lower ones if unbounded.

    Raises ValueError for a bound in seconds.
    """
    bounded = (operation for operation in operations_of(formula) if operation.bound is not None)
    return sum(low if high is None else high for low, high in map(range_of, bounded))

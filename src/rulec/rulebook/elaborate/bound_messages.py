"""What is said about bounds of time."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.rulebook.elaborate.elaboration_messages import kind_of, short
from rulec.rulebook.elaborate.linear_arithmetic import Number
from rulec.syntax import tree
from rulec.syntax.printer import print_formula


def two_units_of_time(bound: tree.Bound) -> Diagnostic:
    """A bound from seconds to steps."""
    return Diagnostic(
        "R0317",
        "a bound is in units of time or in steps, not in both",
        bound.span.place,
        expected="expected one of them",
        help="write both ends in seconds, or both in steps",
    )


def wrong_form(node: tree.Prefix | tree.Infix, bound: tree.Bound) -> Diagnostic:
    """``next[<= 2 s]`` or ``eventually[2 s]``."""
    amount = bound.high or bound.low
    text = print_formula(amount) if amount else "2 s"
    if bound.exact:
        message = f"`{node.operator}` looks at a stretch of time, and this is an instant"
        way_out = f"write `[<= {text}]`, `[>= {text}]` or `[{text} .. {text}]`"
    else:
        message = f"`{node.operator}` looks at one instant, and this is a stretch of time"
        way_out = f"write `{node.operator}[{text}]`"
    return Diagnostic(
        "R0317", message, bound.span.place, expected="expected another bound", help=way_out
    )


def empty_bound(bound: tree.Bound) -> Diagnostic:
    """``[4 s .. 1 s]``."""
    return Diagnostic(
        "R0317",
        "the bound ends before it begins",
        bound.span.place,
        expected="expected the smaller number first",
        help="exchange the two",
    )


def half_a_step(side: tree.Number) -> Diagnostic:
    """``[<= 1.5 steps]``."""
    return Diagnostic(
        "R0317",
        f"there is no {side.text} of a step",
        side.span.place,
        expected="expected a whole number of steps",
        help="write a whole number, or a time in seconds",
    )


def no_time(side: tree.Amount, found: Number) -> Diagnostic:
    """A bound that is no fixed time from 0 on."""
    if not found.is_constant:
        why = "changes from state to state"
    elif found.dimension is None or found.cases[0][1].constant < 0:
        why = "is below 0"
    else:
        why = f"is {kind_of(found.dimension)}"
    return Diagnostic(
        "R0317",
        f"`{short(side)}` {why}; a bound is a fixed time",
        side.span.place,
        expected="expected a time",
        help="write a time, such as `3 s`, or a number of steps, such as `2 steps`",
    )

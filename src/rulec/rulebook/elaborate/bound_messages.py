"""Messages about time bounds."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import Help, offering
from rulec.rulebook.arithmetic.linear_arithmetic import NumberByCases
from rulec.rulebook.elaborate.elaboration_messages import kind_of, short
from rulec.syntax import tree
from rulec.syntax.messages.larger_edits import exchanged
from rulec.syntax.tree_printer import print_formula
from rulec.vocabulary.dimensions import LENGTH

SENSELESS_BOUND = Code(
    "R0317",
    title="a time bound makes no sense",
    why="Bounds are fixed times or whole numbers of steps: `[<= 3 s]`, `[>= 2 steps]`, `[1 s .. 4 "
    "s]`. `next` and `previously` refer to one instant: `next[2 steps]`.",
    bad="rulebook example\nsignal wet\nhard rule r { require eventually[4 s .. 1 s] wet }\n",
    good="rulebook example\nsignal wet\nhard rule r { require eventually[1 s .. 4 s] wet }\n",
)


def two_units_of_time(bound: tree.BoundNode) -> Diagnostic:
    return SENSELESS_BOUND.at(
        bound.span,
        "a bound is in units of time or in steps, not in both",
        expected="expected one of them",
        help="write both ends in seconds, or both in steps",
    )


def wrong_form(node: tree.Prefix | tree.Infix, bound: tree.BoundNode) -> Diagnostic:
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


def empty_bound(bound: tree.BoundNode) -> Diagnostic:
    """``[4 s .. 1 s]``."""
    ends = [end.span.text for end in (bound.low, bound.high) if end is not None]
    return SENSELESS_BOUND.at(
        bound.span,
        "the bound ends before it begins",
        expected="expected the smaller number first",
        help=offering("exchange the two", *(exchanged(bound.span, *ends) if len(ends) > 1 else ())),
    )


def half_a_step(side: tree.NumberLiteral) -> Diagnostic:
    """``[<= 1.5 steps]``."""
    return SENSELESS_BOUND.at(
        side.span,
        f"there is no {side.text} of a step",
        expected="expected a whole number of steps",
        help="write a whole number, or a time in seconds",
    )


def no_time(side: tree.Amount, number: NumberByCases) -> Diagnostic:
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

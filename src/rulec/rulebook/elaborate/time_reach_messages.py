"""Messages about how much of a formula, and of a trace, a temporal operator applies to."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic, Fix, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import offering
from rulec.rulebook.elaborate.elaboration_messages import parentheses_behind, short
from rulec.syntax import tree

FIRST_STATE_ONLY = Code("R0360")

NARROW_OPERATOR = Code("R0361")

TWO_READINGS = Code("R0362")


def first_state_only(node: tree.Formula, asked_once: tree.Formula, *, alone: bool) -> Diagnostic:
    """A requirement, or a part of one if not ``alone``, with a part outside of every `always`.

    ``asked_once`` is that part, or the whole.
    """
    text = node.span.text
    bare = isinstance(node, tree.AtomUse | tree.Aggregate)
    if isinstance(node, tree.Prefix) and node.operator == "not":
        wider = f"never {text[len(node.sign) :].lstrip()}"
    else:
        wider = f"always {text}" if bare else f"always ({text})"
    looks_back = _is_false_at_first(node)
    spoken = f"write `{wider if len(wider) <= 60 else f'{wider[:59]}…'}` to speak of all states"
    if looks_back:
        spoken = (
            "`previously` is false in the first state: say in which states this is asked for, as "
            "in `always (p implies previously q)`, or write `always` and `weak previously`"
        )
    asker = "the rule asks" if alone else "this part of the rule asks"
    asked = "for" if asked_once is node else "whether there is"
    return FIRST_STATE_ONLY.at(
        node.span,
        f"{asker} {asked} `{short(asked_once)}` in the first state only",
        expected="nothing here speaks of later states"
        if asked_once is node
        else "no operator of time is about the whole of this",
        help=spoken,
        severity="warning",
        fix=None if looks_back else Fix(node.span.place, wider),
    )


def _is_false_at_first(node: tree.Formula) -> bool:
    """Whether a formula is false in the first state whatever is there: nothing was before it."""
    match node:
        case tree.Prefix("previously"):
            return True
        case tree.Infix("and", left, right):
            return _is_false_at_first(left) or _is_false_at_first(right)
        case tree.Infix("or", left, right):
            return _is_false_at_first(left) and _is_false_at_first(right)
    return False


def narrow_operator(prefix: tree.Prefix, follows: str, until: int) -> Diagnostic:
    """``never a and b``, where ``never (a and b)`` is probably meant, up to a position.

    Of ``never a implies b`` that would be false: what is meant there is rather ``a and b``.
    """
    is_denial = prefix.operator == "never" and follows == "implies"
    lasts = follows in _LASTING
    way_out = f"write `{prefix.operator} (… {'and' if is_denial else follows} …)`"
    if lasts:
        way_out = _only_so_long(prefix.operator, short(prefix.operand), follows)
    return NARROW_OPERATOR.at(
        prefix.span,
        f"`{prefix.operator}` speaks of this alone, not of what `{follows}` joins to it",
        expected=f"`{prefix.operator}` binds tighter than `{follows}`",
        help=f"{way_out}, or put parentheses around this",
        severity="warning",
        fix=None if is_denial or lasts else parentheses_behind(prefix, until),
    )


def leaves_reach_open(diagnostic: Diagnostic) -> bool:
    """Whether it is about an operator before `until` or its kin, which has no fix."""
    return diagnostic.code == NARROW_OPERATOR.code and "says how long" in diagnostic.help


_LASTING = ("until", "weak until", "release", "strong release", "since")
"""Operators that say themselves how long something lasts."""


def _only_so_long(operator: str, what: str, follows: str) -> str:
    """How ``never a until b`` is written, which would forbid `b`, too, with parentheses around."""
    no = "not " if operator == "never" else ""
    either = f"`{no}{what} {follows} …`"
    if follows == "until":
        either += f", or `{no}{what} weak until …` if that need not come"
    return f"`{follows}` says how long: write {either}"


def two_readings(
    node: tree.Infix, before: tree.Infix | None, behind: tree.Infix | None
) -> Diagnostic:
    """``a until b and c``, with what is joined to its front or its end, or both."""
    start, end = node.span.start, node.span.end
    operator = _sign(node) + (node.bound.span.text if node.bound else "")
    left, right = _operand_text(node.left), _operand_text(node.right)
    now, other, other_end = f"({left} {operator} {right})", left, right
    if before is not None:
        start, ahead = before.span.start, f"{_operand_text(before.left)} {_sign(before)}"
        now, other = f"{ahead} {now}", f"({ahead} {left})"
    if behind is not None:
        end, rest = behind.span.end, f"{_sign(behind)} {_operand_text(behind.right)}"
        now, other_end = f"{now} {rest}", f"({right} {rest})"
    later = f"{other} {operator} {other_end}"
    readings = () if "…" in now + later else (now, later)
    (join, *_) = [infix.operator for infix in (behind, before) if infix is not None]
    return TWO_READINGS.at(
        Span(node.span.source, start, end),
        f"`{join}` beside `{node.operator}` can be read in two ways",
        expected=f"this means `{now}`",
        help=offering(f"write the one you mean: `{now}`, or `{later}`", *readings),
        severity="warning",
    )


def _sign(node: tree.Infix) -> str:
    return " ".join((node.sign or node.operator).split())


def _operand_text(node: tree.Formula) -> str:
    """A short operand on one line, in its parentheses if it has some."""
    grouped = isinstance(node, tree.Grouping) and node.grouped
    return f"({short(node)})" if grouped else short(node)

"""Size limits of formulas with definitions, conditions and exceptions expanded."""

from __future__ import annotations

from typing import Literal

from rulec.logic.formula import Atom, Binary, Comparison, Constant, Count, Formula, Same, Unary

MOST_PARTS = 20_000
"""Operators, atoms and comparisons of a rule's formula, those inside of counts included."""

DEEPEST = 240
"""Operators inside one another, those of definitions that have been put in included."""


class TooDeepError(Exception):
    """An expression has more than ``DEEPEST`` operators and definitions inside one another."""


class TooLargeError(Exception):
    """An expression has more than ``MOST_PARTS`` parts, those of its definitions included."""


def exceeded_limit(formula: Formula) -> Literal["", "deep", "large"]:
    """The limit that a formula exceeds, if any; repeated parts count again."""
    rest = [(formula, 1)]
    parts = 0
    while rest:
        one, depth = rest.pop()
        parts += 1
        if depth > DEEPEST:
            return "deep"
        if parts > MOST_PARTS:
            return "large"
        rest += ((part, depth + 1) for part in _parts(one))
    return ""


def _parts(formula: Formula) -> tuple[Formula, ...]:
    match formula:
        case Unary(_, operand):
            return (operand,)
        case Binary(_, left, right):
            return left, right
        case Comparison(terms):
            return tuple(term.body for _, term in terms if isinstance(term, Count))
        case Atom() | Constant() | Same():
            return ()

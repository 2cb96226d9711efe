"""Formulas as text: in the words of a rulebook, and in Spot's syntax."""

from __future__ import annotations

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
)

# As in the grammar: a larger number binds tighter.
_BINDING = {
    BinaryOperator.IFF: 1,
    BinaryOperator.IMPLIES: 2,
    BinaryOperator.THEN: 3,
    BinaryOperator.XOR: 4,
    BinaryOperator.OR: 5,
    BinaryOperator.AND: 6,
    BinaryOperator.UNTIL: 7,
    BinaryOperator.RELEASE: 7,
    BinaryOperator.WEAK_UNTIL: 7,
    BinaryOperator.STRONG_RELEASE: 7,
    BinaryOperator.SINCE: 7,
}

_SPOT = {
    UnaryOperator.NOT: "!",
    UnaryOperator.ALWAYS: "G",
    UnaryOperator.EVENTUALLY: "F",
    UnaryOperator.NEXT: "X",
    # On the infinite words that Spot reads there always is a next instant.
    UnaryOperator.WEAK_NEXT: "X",
    BinaryOperator.AND: "&",
    BinaryOperator.OR: "|",
    BinaryOperator.IMPLIES: "->",
    BinaryOperator.IFF: "<->",
    BinaryOperator.XOR: "xor",
    BinaryOperator.UNTIL: "U",
    BinaryOperator.RELEASE: "R",
    BinaryOperator.WEAK_UNTIL: "W",
    BinaryOperator.STRONG_RELEASE: "M",
}


def in_words(formula: Formula) -> str:
    """The formula as a rulebook would say it, with no more parentheses than needed to read it."""
    match formula:
        case Atom():
            return str(formula)
        case Constant(value):
            return "true" if value else "false"
        case Unary(operator, operand):
            inner = in_words(operand)
            return f"{operator.value} {f'({inner})' if isinstance(operand, Binary) else inner}"
        case Binary(operator, left, right):
            # Printed as it is read: chains of `and` and `or` to the left, phases to the right.
            to_the_left = operator in (BinaryOperator.AND, BinaryOperator.OR)
            first = _side(operator, left, chain=to_the_left)
            second = _side(operator, right, chain=operator is BinaryOperator.THEN)
            return f"{first} {operator.value} {second}"


def _side(operator: BinaryOperator, formula: Formula, *, chain: bool) -> str:
    text = in_words(formula)
    if not isinstance(formula, Binary):
        return text
    tighter = _BINDING[formula.operator] > _BINDING[operator]
    return text if tighter or (chain and formula.operator is operator) else f"({text})"


def in_spot(formula: Formula) -> str:
    """The formula in Spot's syntax, every atom quoted, every operation in parentheses.

    Spot has no operators of the past: KeyError for them; ``logic.past`` puts atoms in their place.
    """
    match formula:
        case Atom():
            return f'"{formula}"'
        case Constant(value):
            return "1" if value else "0"
        case Unary(UnaryOperator.NEVER, operand):
            return f"G(!({in_spot(operand)}))"
        case Binary(BinaryOperator.THEN, left, right):
            first = in_spot(left)
            return f"({first} & X({first} U {in_spot(right)}))"
        case Unary(operator, operand):
            return f"{_SPOT[operator]}({in_spot(operand)})"
        case Binary(operator, left, right):
            return f"({in_spot(left)} {_SPOT[operator]} {in_spot(right)})"

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
    BinaryOperator.XOR: 3,
    BinaryOperator.OR: 4,
    BinaryOperator.AND: 5,
    BinaryOperator.UNTIL: 6,
    BinaryOperator.RELEASE: 6,
    BinaryOperator.WEAK_UNTIL: 6,
    BinaryOperator.STRONG_RELEASE: 6,
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
            chain = operator in (BinaryOperator.AND, BinaryOperator.OR)
            before = _side(operator, left, chain=chain)
            return f"{before} {operator.value} {_side(operator, right)}"


def _side(operator: BinaryOperator, formula: Formula, *, chain: bool = False) -> str:
    text = in_words(formula)
    if not isinstance(formula, Binary):
        return text
    chained = chain and operator is formula.operator
    tighter = _BINDING[formula.operator] > _BINDING[operator]
    return text if chained or tighter else f"({text})"


def in_spot(formula: Formula) -> str:
    """The formula in Spot's syntax, every atom quoted, every operation in parentheses."""
    match formula:
        case Atom():
            return f'"{formula}"'
        case Constant(value):
            return "1" if value else "0"
        case Unary(operator, operand):
            return f"{_SPOT[operator]}({in_spot(operand)})"
        case Binary(operator, left, right):
            return f"({in_spot(left)} {_SPOT[operator]} {in_spot(right)})"

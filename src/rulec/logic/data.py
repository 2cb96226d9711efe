"""Formulas as plain data: what JSON can hold."""

from __future__ import annotations

from typing import Any

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
)

DEEPEST = 250
"""No rulebook nests deeper, so nothing that reads formulas has to."""


def to_data(formula: Formula) -> Any:
    """An atom as an object, a constant as itself, an operation as a list, its operator first."""
    match formula:
        case Atom(name, arguments, value):
            return {"name": name, "variables": list(arguments), "value": value}
        case Constant(value):
            return value
        case Unary(operator, operand):
            return [operator.value, to_data(operand)]
        case Binary(operator, left, right):
            return [operator.value, to_data(left), to_data(right)]


def from_data(data: Any, depth: int = 0) -> Formula:
    """The formula that ``to_data`` made this of. ValueError if there is none."""
    if depth > DEEPEST:
        raise ValueError("a formula is nested too deep")
    match data:
        case bool():
            return Constant(data)
        case {"name": str(name), "variables": list(variables), "value": value} if (
            len(data) == 3
            and all(isinstance(variable, str) for variable in variables)
            and (value is None or isinstance(value, str))
        ):
            return Atom(name, tuple(variables), value)
        case [str(operator), operand]:
            return Unary(UnaryOperator(operator), from_data(operand, depth + 1))
        case [str(operator), left, right]:
            below = depth + 1
            return Binary(BinaryOperator(operator), from_data(left, below), from_data(right, below))
    raise ValueError("a formula is neither an atom, a constant nor an operation")

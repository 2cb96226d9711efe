"""Formulas without what is true or false for good, as options are once they are put in."""

from __future__ import annotations

from rulec.logic.formula import Binary, BinaryOperator, Constant, Formula, Unary, UnaryOperator


def folded(formula: Formula) -> Formula:
    """An equivalent formula in which ``and``, ``or``, ``implies``, ``not`` join no constants."""
    match formula:
        case Unary(UnaryOperator.NOT, operand):
            inside = folded(operand)
            if isinstance(inside, Constant):
                return Constant(not inside.value)
            return Unary(UnaryOperator.NOT, inside)
        case Unary(operator, operand, bound):
            return Unary(operator, folded(operand), bound)
        case Binary(operator, left, right, bound):
            return _joined(Binary(operator, folded(left), folded(right), bound))
    return formula


def _joined(formula: Binary) -> Formula:
    left, right = formula.left, formula.right
    match formula.operator:
        case BinaryOperator.AND | BinaryOperator.OR:
            neutral = formula.operator is BinaryOperator.AND
            for one, other in ((left, right), (right, left)):
                if isinstance(one, Constant):
                    return other if one.value == neutral else one
        case BinaryOperator.IMPLIES:
            if isinstance(left, Constant):
                return right if left.value else Constant(True)
            if isinstance(right, Constant):
                return right if right.value else folded(Unary(UnaryOperator.NOT, left))
    return formula

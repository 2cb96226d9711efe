"""Constant folding: formulas without operands that are true or false for good."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from rulec.logic.fold import Algebra, fold
from rulec.logic.formula import (
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
    with_operands,
)


def fold_constants(formula: Formula) -> Formula:
    """An equivalent formula in which ``and``, ``or``, ``implies``, ``not`` join no constants."""
    return fold(formula, _FOLDED)


def _unchanged(formula: Formula) -> Formula:
    return formula


def _negation(operand: Formula) -> Formula:
    if isinstance(operand, Constant):
        return Constant(not operand.value)
    return Unary(UnaryOperator.NOT, operand)


def _joined(operator: BinaryOperator, neutral: bool, left: Formula, right: Formula) -> Formula:
    """The conjunction or disjunction, which its neutral constant does not change."""
    for operand, other in ((left, right), (right, left)):
        if isinstance(operand, Constant):
            return other if operand.value == neutral else operand
    return Binary(operator, left, right)


def _implication(left: Formula, right: Formula) -> Formula:
    if isinstance(left, Constant):
        return right if left.value else Constant(True)
    if isinstance(right, Constant):
        return right if right.value else _negation(left)
    return Binary(BinaryOperator.IMPLIES, left, right)


def _operation(formula: Unary | Binary, value_of: Callable[[Formula], Formula]) -> Formula:
    return with_operands(formula, value_of)


_FOLDED: Algebra[Formula] = Algebra(
    proposition=_unchanged,
    identity=_unchanged,
    constant=Constant,
    negation=_negation,
    conjunction=partial(_joined, BinaryOperator.AND, True),
    disjunction=partial(_joined, BinaryOperator.OR, False),
    implication=_implication,
    equivalence=partial(Binary, BinaryOperator.IFF),
    difference=partial(Binary, BinaryOperator.XOR),
    operation=_operation,
)

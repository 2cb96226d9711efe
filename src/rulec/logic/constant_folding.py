"""Constant folding: formulas without operands that are true or false for good."""

from __future__ import annotations

from functools import partial

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold


def fold_constants(formula: ltl.Formula) -> ltl.Formula:
    """An equivalent formula in which ``and``, ``or``, ``implies``, ``not`` join no constants."""
    return fold(formula, _FOLDED)


def _negation(operand: ltl.Formula) -> ltl.Formula:
    if isinstance(operand, ltl.Constant):
        return ltl.Constant(not operand.value)
    return ltl.Unary(ltl.UnaryOperator.NOT, operand)


def _joined(
    operator: ltl.BinaryOperator, neutral: bool, left: ltl.Formula, right: ltl.Formula
) -> ltl.Formula:
    """The conjunction or disjunction, which its neutral constant does not change."""
    for operand, other in ((left, right), (right, left)):
        if isinstance(operand, ltl.Constant):
            return other if operand.value == neutral else operand
    return ltl.Binary(operator, left, right)


def _implication(left: ltl.Formula, right: ltl.Formula) -> ltl.Formula:
    if isinstance(left, ltl.Constant):
        return right if left.value else ltl.Constant(True)
    if isinstance(right, ltl.Constant):
        return right if right.value else _negation(left)
    return ltl.Binary(ltl.BinaryOperator.IMPLIES, left, right)


_FOLDED: Algebra[ltl.Formula] = Algebra(
    proposition=lambda proposition: proposition,
    identity=lambda same: same,
    constant=ltl.Constant,
    negation=_negation,
    conjunction=partial(_joined, ltl.BinaryOperator.AND, True),
    disjunction=partial(_joined, ltl.BinaryOperator.OR, False),
    implication=_implication,
    equivalence=partial(ltl.Binary, ltl.BinaryOperator.IFF),
    difference=partial(ltl.Binary, ltl.BinaryOperator.XOR),
    operation=ltl.with_operands,
)

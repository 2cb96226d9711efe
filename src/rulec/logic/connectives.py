"""Operands, chains and negations of formulas, and formulas with other parts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from rulec.logic import formula as ltl

TRUE, FALSE = ltl.Constant(True), ltl.Constant(False)


def operands_of(formula: ltl.Formula | ltl.Term) -> tuple[ltl.Formula, ...]:
    """The operands of an operation, from left to right; nothing else has any."""
    match formula:
        case ltl.Unary(_, operand):
            return (operand,)
        case ltl.Binary(_, left, right):
            return left, right
    return ()


def parts_in(formula: ltl.Formula) -> Iterator[ltl.Formula]:
    """The formula and its parts, except in bodies of counts, each before its operands."""
    waiting = [formula]
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(operands_of(part))


def chain_of(operator: ltl.BinaryOperator, formula: ltl.Formula) -> Iterator[ltl.Formula]:
    """The operands of a chain of one operator from left to right, however it is grouped."""
    if isinstance(formula, ltl.Binary) and formula.operator is operator:
        yield from chain_of(operator, formula.left)
        yield from chain_of(operator, formula.right)
    else:
        yield formula


def negated(formula: ltl.Formula) -> ltl.Formula:
    """The negation of a formula, without a double one."""
    match formula:
        case ltl.Constant(value):
            return ltl.Constant(not value)
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            return operand
    return ltl.Unary(ltl.UnaryOperator.NOT, formula)


def all_of(formulas: Iterable[ltl.Formula]) -> ltl.Formula:
    """The conjunction of formulas; true if there are none."""
    return _joined(ltl.BinaryOperator.AND, True, formulas)


def any_of(formulas: Iterable[ltl.Formula]) -> ltl.Formula:
    """The disjunction of formulas; false if there are none."""
    return _joined(ltl.BinaryOperator.OR, False, formulas)


def _joined(
    operator: ltl.BinaryOperator, neutral: bool, formulas: Iterable[ltl.Formula]
) -> ltl.Formula:
    whole: ltl.Formula | None = None
    for formula in formulas:
        if formula == ltl.Constant(not neutral):
            return formula
        if formula != ltl.Constant(neutral):
            whole = formula if whole is None else ltl.Binary(operator, whole, formula)
    return ltl.Constant(neutral) if whole is None else whole


def with_terms(
    comparison: ltl.Comparison, transform: Callable[[ltl.Term], ltl.Term]
) -> ltl.Comparison:
    """The comparison with transformed terms."""
    terms = [(factor, transform(term)) for factor, term in comparison.terms]
    return replace(comparison, terms=tuple(terms))


def with_parts(
    formula: ltl.Formula, transform: Callable[[ltl.Formula], ltl.Formula]
) -> ltl.Formula:
    """The formula with transformed operands, or with transformed bodies of what it counts."""

    def counted(term: ltl.Term) -> ltl.Term:
        return replace(term, body=transform(term.body)) if isinstance(term, ltl.Count) else term

    match formula:
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, transform)
        case ltl.Comparison():
            return with_terms(formula, counted)
    return formula

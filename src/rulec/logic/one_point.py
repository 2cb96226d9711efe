"""Equivalent formulas without objects that are the same as another (the one-point rule)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import reduce

from rulec.logic import formula as ltl
from rulec.logic.formula import chain_of, with_parts, with_terms
from rulec.logic.free_names import rename_variables

_CHAINS = (ltl.BinaryOperator.AND, ltl.BinaryOperator.OR)

Fits = Callable[[str, str], bool]
"""Whether every object of the first type is of the second."""


def plain(formula: ltl.Formula, kinds: Mapping[str, str], fits: Fits) -> ltl.Formula:
    """The formula with chains in one piece, and without objects that are the same as another.

    ``kinds`` has the types of its free variables. "There is a vehicle x that is v and brakes" says
    that v brakes (the one-point rule), and that v is a vehicle unless ``fits`` tells that anyway.
    """

    def inside(operand: ltl.Formula) -> ltl.Formula:
        return plain(operand, kinds, fits)

    match formula:
        case ltl.Unary(ltl.UnaryOperator.NOT, operand):
            shorter = inside(operand)
            if isinstance(shorter, ltl.Unary) and shorter.operator is ltl.UnaryOperator.NOT:
                return shorter.operand
            return ltl.Unary(ltl.UnaryOperator.NOT, shorter)
        case ltl.Binary(operator) if operator in _CHAINS:
            parts = [
                part
                for own in chain_of(operator, formula)
                for part in chain_of(operator, inside(own))
            ]
            return _joined(operator, parts)
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, inside)
        case ltl.Comparison():
            plainly = with_terms(formula, lambda term: _counted(term, kinds, fits))
            return _at_one_point(formula, kinds, fits) or plainly
    return formula


def plainly_counted(formula: ltl.Formula, kinds: Mapping[str, str], fits: Fits) -> ltl.Formula:
    """The formula with only what it counts made plain, so that it counts as often as before."""
    match formula:
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, lambda part: plainly_counted(part, kinds, fits))
        case ltl.Comparison():
            return with_terms(formula, lambda term: _counted(term, kinds, fits))
    return formula


def _counted(term: ltl.Term, kinds: Mapping[str, str], fits: Fits) -> ltl.Term:
    if not isinstance(term, ltl.Count):
        return term
    return replace(term, body=plain(term.body, {**kinds, term.variable: term.type}, fits))


def _at_one_point(
    formula: ltl.Comparison, kinds: Mapping[str, str], fits: Fits
) -> ltl.Formula | None:
    """What a comparison says of another object, if all that it counts is the same as that one."""
    count = single_count(formula)
    if count is None or not (is_none(formula) or is_some(formula)):
        return None
    parts = list(chain_of(ltl.BinaryOperator.AND, count.body))
    same = ((part, _other_than(count.variable, part)) for part in parts)
    itself, other = next(((part, other) for part, other in same if other), (None, ""))
    if itself is None:
        return None
    rest = [rename_variables(part, {count.variable: other}) for part in parts if part is not itself]
    if not fits(kinds.get(other, ""), count.type):
        if not rest:
            return None
        kind = ((Fraction(1), replace(count, body=itself)),)
        rest.insert(0, ltl.Comparison(kind, ">=", Fraction(1)))
    said = _joined(ltl.BinaryOperator.AND, rest or [ltl.Constant(True)])
    return plain(ltl.Unary(ltl.UnaryOperator.NOT, said) if is_none(formula) else said, kinds, fits)


def _other_than(variable: str, part: ltl.Formula) -> str:
    """The variable that a part says to be the same as this one; empty if it says no such thing."""
    if not isinstance(part, ltl.Same) or variable not in (part.left, part.right):
        return ""
    other = part.right if part.left == variable else part.left
    return other if other != variable else ""


def _joined(operator: ltl.BinaryOperator, parts: list[ltl.Formula]) -> ltl.Formula:
    return reduce(lambda left, right: ltl.Binary(operator, left, right), parts)


def single_count(comparison: ltl.Comparison) -> ltl.Count | None:
    """The count, if the comparison compares a single count with a number, else None."""
    match comparison.terms:
        case ((coefficient, ltl.Count() as count),) if coefficient == 1:
            return count
    return None


def is_some(comparison: ltl.Comparison) -> bool:
    """Whether a comparison of a single count says that there is such an object."""
    return comparison.relation == ">=" and comparison.limit == 1


def is_none(comparison: ltl.Comparison) -> bool:
    """Whether a comparison of a single count says that there is no such object."""
    match comparison.relation, comparison.limit:
        case ("=" | "<=", Fraction(numerator=0)) | ("<", Fraction(numerator=1, denominator=1)):
            return True
    return False


def replaced(formula: ltl.Formula, names: Mapping[ltl.Formula, ltl.Formula]) -> ltl.Formula:
    """The formula with the parts that have a name replaced by it, the largest first."""
    name = names.get(formula)
    return name or with_parts(formula, lambda part: replaced(part, names))

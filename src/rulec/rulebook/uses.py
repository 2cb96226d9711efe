"""The names that a tree speaks of."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.syntax import tree


def names_used(item: tree.Item) -> Iterator[str]:
    """Every name in the formulas of an item, with repetitions; not in its examples."""
    match item:
        case tree.RuleItem(require=require, when=when, unless=unless):
            for formula in (require, when, *(one.formula for one in unless)):
                if formula is not None:
                    yield from names_in(formula)
        case tree.DefineItem(body=body):
            yield from names_in(body)
        case tree.ParamItem(value=value) | tree.SetItem(value=value):
            if not isinstance(value, bool):
                yield from names_in(value)
        case _:
            return


def names_in(formula: tree.Formula) -> Iterator[str]:
    """Every name in a formula, with repetitions."""
    match formula:
        case tree.AtomUse(name, arguments):
            yield name.text
            yield from (one.text for one in arguments)
        case tree.Prefix(operand=operand, bound=bound):
            yield from names_in(operand)
            yield from _in_bound(bound)
        case tree.Infix(left=left, right=right, bound=bound):
            yield from names_in(left)
            yield from names_in(right)
            yield from _in_bound(bound)
        case tree.Compare(left=left, right=right) | tree.Arithmetic(left=left, right=right):
            yield from names_in(left)
            yield from names_in(right)
        case tree.Minus(operand):
            yield from names_in(operand)
        case tree.Conditional(value, condition, otherwise):
            for part in (value, condition, otherwise):
                yield from names_in(part)
        case tree.Aggregate(body=body):
            yield from names_in(body)
        case tree.Truth() | tree.Number():
            return


def _in_bound(bound: tree.Bound | None) -> Iterator[str]:
    if bound is not None:
        for side in (bound.low, bound.high):
            if side is not None:
                yield from names_in(side)

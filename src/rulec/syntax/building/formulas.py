"""Formulas, expressions, and the parameters that they and everything else have."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from rulec.syntax import tree
from rulec.syntax.building.values import NodeValues
from rulec.syntax.grammar import ParseLeaf, ParseNode
from rulec.syntax.keywords import SYMBOLS, token_kind

_OPERATORS = {token_kind(words): words for words in SYMBOLS}


def formula(values: NodeValues, node: ParseNode) -> tree.Formula:
    """Build a formula or an expression from its parse node."""
    span = values.span(node)
    signs = [child for child in node.children if isinstance(child, ParseLeaf)]
    parts = [
        formula(values, child)
        for child in node.children
        if isinstance(child, ParseNode) and child.kind not in ("bound", "variable", "names")
    ]
    match node.kind:
        case "infix":
            word, (left, right), bound = _OPERATORS[signs[0].kind], parts, _bound(values, node)
            return tree.Infix(word, left, right, bound, signs[0].text, span=span)
        case "prefix":
            word, (operand,), bound = _OPERATORS[signs[0].kind], parts, _bound(values, node)
            return tree.Prefix(word, operand, bound, signs[0].text, span=span)
        case "compare":
            return tree.Compare(cast("Any", signs[0].text), *parts, span=span)
        case "arithmetic":
            return tree.Arithmetic(signs[0].text, *parts, span=span)
        case "minus":
            return tree.Minus(*parts, span=span)
        case "conditional":
            return tree.Conditional(*parts, span=span)
        case "group":
            # Parentheses around what needs none are not worth remembering.
            (inner,) = parts
            return replace(inner, grouped=True) if isinstance(inner, tree.Grouping) else inner
        case "aggregate":
            (variable,) = node.branches("variable")
            word = cast("Any", signs[0].text)
            return tree.Aggregate(word, parameter(values, variable), *parts, span=span)
        case "truth":
            return tree.TruthLiteral(signs[0].kind == "TRUE", span=span)
        case "number":
            return amount(values, node)
        case _:
            return atom(values, node)


def amount(values: NodeValues, node: ParseNode) -> tree.NumberLiteral:
    """A number with its unit, if any."""
    (number,) = node.leaves("NUMBER")
    values.number(number)
    units = "".join(unit.text for unit in node.leaves("UNIT"))
    return tree.NumberLiteral(number.text, units, span=values.span(node))


def _bound(values: NodeValues, operation: ParseNode) -> tree.BoundNode | None:
    for node in operation.branches("bound"):
        span = values.span(node)
        first, *others = (
            atom(values, child) if child.kind == "atom" else amount(values, child)
            for child in node.branches("atom", "number")
        )
        if node.leaves("AT_MOST"):
            return tree.BoundNode(None, first, span=span)
        if node.leaves("AT_LEAST"):
            return tree.BoundNode(first, None, span=span)
        return tree.BoundNode(first, others[0] if others else first, not others, span=span)
    return None


def atom(values: NodeValues, node: ParseNode) -> tree.AtomUse:
    """An atom with its arguments."""
    (name,) = values.names(node)
    arguments = [name for names in node.branches("names") for name in values.names(names)]
    return tree.AtomUse(name, tuple(arguments), span=values.span(node))


def parameter(values: NodeValues, node: ParseNode) -> tree.Parameter:
    """``name`` or ``name: type``."""
    return tree.Parameter(*values.names(node), span=values.span(node))


def parameters(values: NodeValues, node: ParseNode) -> tuple[tree.Parameter, ...]:
    """A declaration's or definition's parameters, or a rule's variables."""
    return tuple(
        parameter(values, branch)
        for group in node.branches("parameters", "variables")
        for branch in group.branches("parameter", "variable")
    )

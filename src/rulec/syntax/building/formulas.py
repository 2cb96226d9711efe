"""Formulas, expressions, and the parameters that they and everything else have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from rulec.syntax import tree
from rulec.syntax.building.values import NodeValues, branches, leaf_of, leaves
from rulec.syntax.grammar import ParseLeaf, ParseNode
from rulec.syntax.keywords import SYMBOLS, token_kind

_OPERATORS = {token_kind(words): words for words in SYMBOLS}

_AGGREGATES: dict[str, Literal["some", "every", "count"]] = {
    "SOME": "some",
    "EVERY": "every",
    "COUNT": "count",
}

_RELATIONS: dict[str, Literal["<", "<=", "=", "!=", ">=", ">"]] = {
    "LESS": "<",
    "AT_MOST": "<=",
    "EQUALS": "=",
    "NOT_EQUAL": "!=",
    "AT_LEAST": ">=",
    "GREATER": ">",
}


def formula(values: NodeValues, node: ParseNode) -> tree.Formula:
    """Build a formula or an expression from its parse node."""
    span = values.span(node)
    match node:
        case ParseNode(
            "infix", (ParseNode() as left, ParseLeaf() as sign, *bound, ParseNode() as right)
        ):
            word = _OPERATORS[sign.kind]
            sides = formula(values, left), formula(values, right)
            return tree.Infix(word, *sides, _bound(values, bound), span, sign.text)
        case ParseNode("prefix", (ParseLeaf() as sign, *bound, ParseNode() as operand)):
            word = _OPERATORS[sign.kind]
            inside = formula(values, operand)
            return tree.Prefix(word, inside, _bound(values, bound), span, sign.text)
        case ParseNode(
            "compare", (ParseNode() as left, ParseLeaf(kind=kind), ParseNode() as right)
        ):
            sides = formula(values, left), formula(values, right)
            return tree.Compare(_RELATIONS[kind], *sides, span)
        case ParseNode(
            "arithmetic", (ParseNode() as left, ParseLeaf() as sign, ParseNode() as right)
        ):
            return tree.Arithmetic(sign.text, formula(values, left), formula(values, right), span)
        case ParseNode("minus", (_, ParseNode() as operand)):
            return tree.Minus(formula(values, operand), span)
        case ParseNode(
            "conditional", (ParseNode() as value, _, ParseNode() as test, _, ParseNode() as other)
        ):
            parts = formula(values, value), formula(values, test), formula(values, other)
            return tree.Conditional(*parts, span)
        case ParseNode("group", (_, ParseNode() as inner, _)):
            return _grouped(formula(values, inner))
        case ParseNode(
            "aggregate", (ParseLeaf() as kind, ParseNode() as variable, _, ParseNode() as body, _)
        ):
            word = _AGGREGATES[kind.kind]
            return tree.Aggregate(word, parameter(values, variable), formula(values, body), span)
        case ParseNode("truth", (ParseLeaf(kind=kind),)):
            return tree.TruthLiteral(kind == "TRUE", span)
        case ParseNode("number"):
            return amount(values, node)
        case _:
            return atom(values, node)


def amount(values: NodeValues, node: ParseNode) -> tree.NumberLiteral:
    """A number with its unit, if any."""
    number = leaf_of(node, "NUMBER")
    values.number(number)
    units = leaves(node, "UNIT")
    return tree.NumberLiteral(number.text, units[0].text if units else "", values.span(node))


def _bound(values: NodeValues, nodes: Sequence[ParseNode | ParseLeaf]) -> tree.BoundNode | None:
    if not nodes:
        return None
    (node,) = nodes
    assert isinstance(node, ParseNode), "a bound is no token"
    first, *others = (
        atom(values, child) if child.kind == "atom" else amount(values, child)
        for child in node.children
        if isinstance(child, ParseNode)
    )
    span = values.span(node)
    if leaves(node, "AT_MOST"):
        return tree.BoundNode(None, first, span=span)
    if leaves(node, "AT_LEAST"):
        return tree.BoundNode(first, None, span=span)
    return tree.BoundNode(first, others[0] if others else first, not others, span)


def atom(values: NodeValues, node: ParseNode) -> tree.AtomUse:
    """An atom with its arguments."""
    arguments = [name for names in branches(node, "names") for name in values.names(names)]
    return tree.AtomUse(values.name(leaf_of(node, "NAME")), tuple(arguments), values.span(node))


def parameter(values: NodeValues, node: ParseNode) -> tree.Parameter:
    """``name`` or ``name: type``."""
    names = values.names(node)
    return tree.Parameter(names[0], names[1] if len(names) > 1 else None, values.span(node))


def parameters(values: NodeValues, node: ParseNode) -> tuple[tree.Parameter, ...]:
    """A declaration's or definition's parameters, or a rule's variables."""
    return tuple(
        parameter(values, branch)
        for group in (*branches(node, "parameters"), *branches(node, "variables"))
        for branch in (*branches(group, "parameter"), *branches(group, "variable"))
    )


_GROUPS = (
    *(tree.Prefix, tree.Infix, tree.Compare),
    *(tree.Arithmetic, tree.Minus, tree.Conditional),
)


def _grouped(formula: tree.Formula) -> tree.Formula:
    """Parentheses around what needs none are not worth remembering."""
    return replace(formula, grouped=True) if isinstance(formula, _GROUPS) else formula

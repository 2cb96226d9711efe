"""Formulas, expressions, and the parameters that they and everything else have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from rulec.syntax import tree
from rulec.syntax.building.values import Values, branches, leaf_of, leaves
from rulec.syntax.grammar import Branch, Leaf
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


def formula(values: Values, node: Branch) -> tree.Formula:
    """A formula or an expression; as deep as the parser lets it be."""
    span = values.span(node)
    match node:
        case Branch("infix", (Branch() as left, Leaf() as sign, *bound, Branch() as right)):
            word = _OPERATORS[sign.kind]
            sides = formula(values, left), formula(values, right)
            return tree.Infix(word, *sides, _bound(values, bound), span, sign.text)
        case Branch("prefix", (Leaf() as sign, *bound, Branch() as operand)):
            word = _OPERATORS[sign.kind]
            inside = formula(values, operand)
            return tree.Prefix(word, inside, _bound(values, bound), span, sign.text)
        case Branch("compare", (Branch() as left, Leaf(kind=kind), Branch() as right)):
            sides = formula(values, left), formula(values, right)
            return tree.Compare(_RELATIONS[kind], *sides, span)
        case Branch("arithmetic", (Branch() as left, Leaf() as sign, Branch() as right)):
            return tree.Arithmetic(sign.text, formula(values, left), formula(values, right), span)
        case Branch("minus", (_, Branch() as operand)):
            return tree.Minus(formula(values, operand), span)
        case Branch("conditional", (Branch() as value, _, Branch() as test, _, Branch() as other)):
            parts = formula(values, value), formula(values, test), formula(values, other)
            return tree.Conditional(*parts, span)
        case Branch("group", (_, Branch() as inner, _)):
            return _grouped(formula(values, inner))
        case Branch("aggregate", (Leaf() as kind, Branch() as variable, _, Branch() as body, _)):
            word = _AGGREGATES[kind.kind]
            return tree.Aggregate(word, parameter(values, variable), formula(values, body), span)
        case Branch("truth", (Leaf(kind=kind),)):
            return tree.Truth(kind == "TRUE", span)
        case Branch("number"):
            return amount(values, node)
        case _:
            return atom(values, node)


def amount(values: Values, node: Branch) -> tree.Number:
    """A number with its unit, if any."""
    number = leaf_of(node, "NUMBER")
    values.number(number)
    units = leaves(node, "UNIT")
    return tree.Number(number.text, units[0].text if units else "", values.span(node))


def _bound(values: Values, nodes: Sequence[Branch | Leaf]) -> tree.Bound | None:
    if not nodes:
        return None
    (node,) = nodes
    assert isinstance(node, Branch), "a bound is no token"
    first, *others = (
        atom(values, child) if child.kind == "atom" else amount(values, child)
        for child in node.children
        if isinstance(child, Branch)
    )
    span = values.span(node)
    if leaves(node, "AT_MOST"):
        return tree.Bound(None, first, span=span)
    if leaves(node, "AT_LEAST"):
        return tree.Bound(first, None, span=span)
    return tree.Bound(first, others[0] if others else first, not others, span)


def atom(values: Values, node: Branch) -> tree.AtomUse:
    """An atom with its arguments."""
    arguments = [name for names in branches(node, "names") for name in values.names(names)]
    return tree.AtomUse(values.name(leaf_of(node, "NAME")), tuple(arguments), values.span(node))


def parameter(values: Values, node: Branch) -> tree.Parameter:
    """``name`` or ``name: type``."""
    names = values.names(node)
    return tree.Parameter(names[0], names[1] if len(names) > 1 else None, values.span(node))


def parameters(values: Values, node: Branch) -> tuple[tree.Parameter, ...]:
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

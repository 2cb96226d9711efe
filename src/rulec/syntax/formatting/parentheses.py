"""Operators of a parse node, and parentheses that group nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from rulec.syntax.grammar import ParseLeaf, ParseNode
from rulec.syntax.keywords import (
    ARITHMETIC_PRECEDENCE,
    COMPARISON_PRECEDENCE,
    PRECEDENCE,
    token_kind,
)

OPERATIONS: Final = frozenset(
    ("infix", "prefix", "compare", "arithmetic", "minus", "conditional", "group", "aggregate")
)

_LEVELS = {token_kind(word): level for word, level in PRECEDENCE.items()}
_FORMULAS_ONLY = frozenset(
    ("require_clause", "when_clause", "fact_item", "define_item", "aggregate")
)
_WHOLE = _FORMULAS_ONLY | {"unless_clause", "param_item", "set_item", "group"}


def level(node: ParseNode) -> int:
    """The binding strength of an infix, a comparison or an arithmetic operation."""
    sign = node.children[1]
    assert isinstance(sign, ParseLeaf), "the operator is between its operands"
    if node.kind == "compare":
        return COMPARISON_PRECEDENCE
    return ARITHMETIC_PRECEDENCE[sign.text] if node.kind == "arithmetic" else _LEVELS[sign.kind]


def without_spare_parentheses(node: ParseNode) -> ParseNode:
    """The node without parentheses that it never needs."""
    whole = node.kind in _WHOLE and _has_no_words_behind(node)
    children = tuple(
        child if isinstance(child, ParseLeaf) else _child(node, child, whole=whole)
        for child in node.children
    )
    return replace(node, children=children)


def _child(node: ParseNode, child: ParseNode, *, whole: bool) -> ParseNode:
    while child.kind == "group":
        inside = child.children[1]
        assert isinstance(inside, ParseNode), "a group holds a formula"
        kind = inside.kind
        only_here = kind == "conditional" and node.kind in _FORMULAS_ONLY
        if kind not in OPERATIONS or kind in ("group", "aggregate") or (whole and not only_here):
            child = inside
        else:
            break
    return without_spare_parentheses(child)


def _has_no_words_behind(node: ParseNode) -> bool:
    """``unless (p or q) throughout`` reads better with them."""
    return node.kind != "unless_clause" or isinstance(node.children[-1], ParseNode)

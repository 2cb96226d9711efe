"""Removes parentheses that group nothing, and adds those that make the meaning obvious."""

from __future__ import annotations

from typing import Final

from rulec.syntax.keywords import (
    ARITHMETIC_PRECEDENCE,
    BINDS_NARROWLY,
    COMPARISON_PRECEDENCE,
    JOINS_ALIKE,
    OF_ONE_STATE,
    PRECEDENCE,
    UNARY_OPERATORS,
    token_kind,
)
from rulec.syntax.parse_nodes import MAX_DEPTH, ParseLeaf, ParseNode

OPERATIONS: Final = frozenset(
    ("infix", "prefix", "compare", "arithmetic", "minus", "conditional", "group", "aggregate")
)

_LEVELS = {token_kind(word): level for word, level in PRECEDENCE.items()}
_FORMULAS_ONLY = frozenset(
    ("require_clause", "when_clause", "fact_item", "define_item", "aggregate")
)
_NARROW = frozenset(map(token_kind, BINDS_NARROWLY))
_ALIKE = frozenset(map(token_kind, JOINS_ALIKE))
_OF_TIME = frozenset(
    token_kind(word) for word in (*UNARY_OPERATORS, *PRECEDENCE) if word not in OF_ONE_STATE
)
_WHOLE = _FORMULAS_ONLY | {"unless_clause", "param_item", "set_item", "group"}


def level(node: ParseNode) -> int:
    """The precedence of an infix, a comparison or an arithmetic operation."""
    sign = node.children[1]
    assert isinstance(sign, ParseLeaf), "the operator is between its operands"
    if node.kind == "compare":
        return COMPARISON_PRECEDENCE
    return ARITHMETIC_PRECEDENCE[sign.text] if node.kind == "arithmetic" else _LEVELS[sign.kind]


def with_fitting_parentheses(node: ParseNode) -> ParseNode:
    """The node without redundant parentheses, and with those that make its meaning obvious.

    `never p and q` is written `(never p) and q`, since few readers know that it means this.
    """
    shown = _fitted(node, shows=True)
    return shown if _depth(shown) <= MAX_DEPTH else _fitted(node, shows=False)


def _fitted(node: ParseNode, *, shows: bool) -> ParseNode:
    whole = node.kind in _WHOLE and _has_no_words_behind(node)
    children = tuple(
        child
        if isinstance(child, ParseLeaf)
        else _fitted(_without_spare(node, child, whole=whole), shows=shows)
        for child in node.children
    )
    fitted = node._replace(children=children)
    if shows and node.kind == "infix":
        # Redundant parentheses are gone by now: they would hide an operator at the end.
        left, *rest = children
        fitted = fitted._replace(children=(_end_shown(left, fitted), *rest))
    return fitted


def _without_spare(node: ParseNode, child: ParseNode, *, whole: bool) -> ParseNode:
    while child.kind == "group":
        inside = child.children[1]
        assert isinstance(inside, ParseNode), "a group holds a formula"
        kind = inside.kind
        only_here = kind == "conditional" and node.kind in _FORMULAS_ONLY
        if kind not in OPERATIONS or kind in ("group", "aggregate") or (whole and not only_here):
            child = inside
        else:
            break
    return child


def _depth(node: ParseNode | ParseLeaf) -> int:
    if isinstance(node, ParseLeaf):
        return 0
    return max(map(_depth, node.children), default=0) + (node.kind in OPERATIONS)


def _end_shown(part: ParseNode | ParseLeaf, around: ParseNode) -> ParseNode | ParseLeaf:
    """An operand, with parentheses around a final operator that could be misread."""
    if not isinstance(part, ParseNode) or part.kind not in ("infix", "prefix"):
        return part
    *before, last = part.children
    sign = part.children[0]
    if isinstance(sign, ParseLeaf) and sign.kind in _NARROW and _is_narrow(sign, last, around):
        opening = ParseLeaf("LPAR", "(", part.start, part.start)
        closing = ParseLeaf("RPAR", ")", part.end, part.end)
        return ParseNode("group", (opening, part, closing), part.start, part.end)
    return part._replace(children=(*before, _end_shown(last, around)))


def _is_narrow(sign: ParseLeaf, operand: ParseNode | ParseLeaf, around: ParseNode) -> bool:
    operation, behind = around.children[1], around.children[-1]
    if operand.kind == "group":
        return False
    if operation.kind in _ALIKE:
        return not _speaks_of_time(behind)
    return sign.kind != "EVENTUALLY" or operation.kind == "THEN"


def _speaks_of_time(node: ParseNode | ParseLeaf) -> bool:
    if isinstance(node, ParseLeaf):
        return node.kind in _OF_TIME
    return any(map(_speaks_of_time, node.children))


def _has_no_words_behind(node: ParseNode) -> bool:
    """Whether no scope follows; ``unless (p or q) throughout`` keeps its parentheses."""
    return node.kind != "unless_clause" or isinstance(node.children[-1], ParseNode)

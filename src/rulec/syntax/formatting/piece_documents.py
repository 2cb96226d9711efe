"""Parse nodes as documents: where spaces are, and where lines may end.

The file's own words and signs are written again, one by one and in order. Only two things are not
kept: redundant parentheses, and white space.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from rulec.syntax.formatting.comments import Comment
from rulec.syntax.formatting.document import (
    Break,
    Concatenation,
    Document,
    Fill,
    LineEnd,
    Nest,
    group,
    run,
)
from rulec.syntax.formatting.parentheses import OPERATIONS, level
from rulec.syntax.keywords import OPERATOR_LETTERS
from rulec.syntax.parse_nodes import ParseLeaf, ParseNode

Node = ParseNode | ParseLeaf
Gap = Break | Fill | Literal["", " "]
"""The space between two tokens; only the first two kinds can end a line or hold a comment."""

_LEADS = frozenset(("AS", "IN", "BECAUSE", "DEFAULT", "UNTIL", "GREATER"))
"""Keywords that may begin a line in a header line, a declaration, a provision or a head.

They exclude words that may be names elsewhere, since a name on its own line may begin an item.
"""

_SCOPES = frozenset(("INITIALLY", "AT_START", "THROUGHOUT", "AT_SOME_POINT", "AT_END"))

_CHAINS = frozenset(("infix", "arithmetic", "compare"))


@dataclass(slots=True)
class DocumentBuilder:
    """Builds documents in the order of the file, with each comment once."""

    comments: deque[Comment]

    def take(self, until: int) -> tuple[Comment | None, tuple[Comment, ...]]:
        """Take the comments before a position: the trailing one, and the others."""
        comments: list[Comment] = []
        while self.holds_comment(until):
            comments.append(self.comments.popleft())
        trailing = next((comment for comment in comments if comment.trails), None)
        return trailing, tuple(comment for comment in comments if comment is not trailing)

    def holds_comment(self, until: int) -> bool:
        """Whether some comment before a position has not been taken yet."""
        return bool(self.comments) and self.comments[0].start < until

    def gap(self, gap: Gap, following: int) -> Document:
        """The gap before the token at ``following``, with its comments."""
        if isinstance(gap, str):
            return gap
        trailing, own = self.take(following)
        if trailing is None and not own:
            return gap
        return LineEnd(trailing, own, gap.deeper if isinstance(gap, Fill) else 0)

    def closing_gap(self, flat: str, following: int) -> Document:
        """The gap before a block's closing brace, with the block's last comments."""
        gap = self.gap(Break(flat), following)
        return replace(gap, inner=2) if isinstance(gap, LineEnd) else gap

    def spell(self, node: Node) -> Document:
        """The document of a node of any kind."""
        match node:
            case ParseLeaf():
                return node.text if node.kind == "STRING" else " ".join(node.text.split())
            case ParseNode(kind="infix" | "arithmetic" | "compare"):
                return self._chain(_links(node, level(node)))
            case ParseNode("prefix", (ParseLeaf() as sign, *_, operand)):
                return self._operator(node.children, _behind_prefix(sign, node.children, operand))
            case ParseNode("minus", children):
                return self._operator(children, "")
            case ParseNode("group", (opening, inside, closing)):
                return self._parentheses(opening, inside, closing)
            case ParseNode("aggregate", (kind, variable, opening, inside, closing)):
                head = run(self.spell(kind), " ", self.spell(variable), " ")
                return run(head, self._parentheses(opening, inside, closing))
            case ParseNode("conditional", children):
                value, if_word, condition, else_word, otherwise = children
                return self._chain([[value], [if_word, condition], [else_word, otherwise]])
            case ParseNode("state", children):
                return self._chain(_in_pairs(children))
            case ParseNode():
                return self.plain(node.children, node.kind)

    def plain(self, nodes: Sequence[Node], kind: str, deeper: int = 4) -> Concatenation:
        """Nodes in sequence, with the spaces and breaks that tokens need."""
        parts: list[Document] = []
        for index, node in enumerate(nodes):
            if index:
                gap = between(last_leaf(nodes[index - 1]), first_leaf(node), kind, deeper)
                parts.append(self.gap(gap, first_leaf(node).start))
            if isinstance(node, ParseNode) and node.kind not in OPERATIONS:
                parts.append(self.plain(node.children, node.kind, deeper))
            else:
                parts.append(self.spell(node))
        return run(*parts)

    def worded(self, node: ParseNode, column: int, deeper: int = 4) -> Concatenation:
        """A keyword and its content, which begins and continues at ``column``."""
        word, *content = node.children
        start = self.spell(word)
        assert isinstance(start, str), "a word is a leaf"
        if isinstance(word, ParseLeaf) and word.kind == "ALSO":
            start, content = "also unless", content[1:]
        lead = self.gap(Break(" " * (column - len(start))), first_leaf(content[0]).start)
        first = lead.flat if isinstance(lead, Break) else lead
        return run(start, Nest(column, run(first, self.plain(content, node.kind, deeper))))

    def assigned(self, node: ParseNode, column: int, *, broken: bool) -> Document:
        """``word name = value``, with the name at ``column``.

        The value gets lines of its own if it is ``broken`` off, or too long; so does a ``cite``.
        """
        at = next(index for index, child in enumerate(node.children) if _is_equals(child)) + 1
        word = self.spell(node.children[0])
        assert isinstance(word, str), "a word is a leaf"
        values = [child for child in node.children[at:] if child.kind != "cite_clause"]
        head = run(word.ljust(column), self.plain(node.children[1:at], node.kind))
        lead = self.gap(Break(), first_leaf(values[0]).start)
        given = group(head, Nest(2, run(lead, self.plain(values, node.kind))), forced=broken)
        if len(values) == len(node.children) - at:
            return given
        own_line = self.gap(Break(), first_leaf(node.children[-1]).start)
        return group(given, Nest(2, run(own_line, self.spell(node.children[-1]))))

    def block(self, node: ParseNode) -> Document:
        """A head, and entries in braces, one per line."""
        at = next(index for index, child in enumerate(node.children) if child.kind == "LBRACE") + 1
        head = self.plain(node.children[:at], node.kind)
        inside: list[Document] = []
        for child in node.children[at:-1]:
            if isinstance(child, ParseNode):
                gap = self.gap(Break(), first_leaf(child).start)
                inside += [gap, self.plain(child.children, child.kind)]
            else:
                inside.append(self.spell(child))
        ends = self.closing_gap("", first_leaf(node.children[-1]).start)
        closing = self.spell(node.children[-1])
        return group(head, Nest(2, run(*inside)), ends, closing, forced=True)

    def _chain(self, links: Sequence[Sequence[Node]]) -> Document:
        """Operands of operators of equal precedence: on one line, or one per line."""
        parts: list[Document] = []
        for index, link in enumerate(links):
            if index:
                parts.append(self.gap(Break(), first_leaf(link[0]).start))
            parts.append(self._operator(link, _behind_operator(link)))
        return group(*parts)

    def _operator(self, nodes: Sequence[Node], behind: Gap) -> Concatenation:
        *before, operand = nodes
        parts = [self.spell(node) for node in before]
        if before:
            parts.append(self.gap(behind, first_leaf(operand).start))
        inside = self.spell(operand)
        chained = isinstance(operand, ParseNode) and operand.kind in _CHAINS
        return run(*parts, Nest(2, inside) if chained else inside)

    def _parentheses(self, opening: Node, inside: Node, closing: Node) -> Document:
        first = self.spell(opening)
        begins = self.gap(Break(""), first_leaf(inside).start)
        text = self.spell(inside)
        ends = self.closing_gap("", first_leaf(closing).start)
        return group(first, Nest(2, run(begins, text)), ends, self.spell(closing))


def first_leaf(node: Node) -> ParseLeaf:
    """The first token of a node."""
    while isinstance(node, ParseNode):
        node = node.children[0]
    return node


def last_leaf(node: Node) -> ParseLeaf:
    """The last token of a node."""
    while isinstance(node, ParseNode):
        node = node.children[-1]
    return node


def _links(node: Node, of: int) -> list[list[Node]]:
    if not isinstance(node, ParseNode) or node.kind not in _CHAINS or level(node) != of:
        return [[node]]
    left, *operator, right = node.children
    first, *others = _links(right, of)
    return [*_links(left, of), [*operator, *first], *others]


def _in_pairs(children: Iterable[Node]) -> list[list[Node]]:
    first, *others = children
    return [[first], *([others[at], others[at + 1]] for at in range(0, len(others), 2))]


def _behind_prefix(sign: ParseLeaf, children: Sequence[Node], operand: Node) -> Gap:
    grouped = isinstance(operand, ParseNode) and operand.kind == "group" and len(children) == 2
    if sign.text == "!" or (sign.text in OPERATOR_LETTERS and grouped):
        return ""
    return _behind_operator(children)


def _behind_operator(link: Sequence[Node]) -> Gap:
    bounded = len(link) > 2 and first_leaf(link[-1]).kind == "NAME"
    return " " if bounded else Fill()


def _is_equals(node: Node) -> bool:
    return isinstance(node, ParseLeaf) and node.kind == "EQUALS"


def between(before: ParseLeaf, behind: ParseLeaf, inside: str, deeper: int) -> Gap:
    """The gap between two tokens that are not around an operator."""
    match before.kind, behind.kind:
        case (_, "COMMA" | "RPAR" | "RSQB" | "LSQB") | ("LPAR" | "LSQB" | "MINUS", _):
            return ""
        case (_, "COLON"):
            return " " if inside == "param_item" else ""
        case ("NOT", _):
            return "" if before.text == "!" else " "
        case ("NAME", "LPAR"):
            return " " if inside in ("rule_head", "example_head") else ""
        case ("COMMA", _):
            return Fill(deeper)
        case (_, kind):
            return Fill(deeper) if kind in _LEADS or kind in _SCOPES else " "

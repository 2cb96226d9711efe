"""Runs the grammar; the only file that depends on Lark."""

from __future__ import annotations

from functools import cache

import lark
from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedInput, UnexpectedToken
from lark.grammar import Rule
from lark.lexer import TerminalDef

from rulec.resources import grammar_file
from rulec.syntax import parser_tables
from rulec.syntax.parse_nodes import (
    MAX_DEPTH,
    Mismatch,
    ParseLeaf,
    ParseNode,
    Start,
    TooDeep,
)

STARTS: tuple[Start, ...] = ("item", "rule_head", "clause", "example_head", "state", "formula")

_LEVELS = frozenset(
    (*("infix", "prefix", "group", "compare"), *("arithmetic", "minus", "conditional", "aggregate"))
)


def parse_piece(start: Start, text: str, begin: int, end: int) -> ParseNode | Mismatch | TooDeep:
    """Parse characters ``begin`` to ``end`` of a text. Positions count from the text's start."""
    try:
        # Not a `TextSlice`: Lark would count the lines before every piece anew, which takes
        # quadratic time in all.
        tree = _lark().parse(text[begin:end], start=start)
    except UnexpectedInput as error:
        position = begin + _position(error, end - begin)
        return Mismatch(position, _accepted(start, text[begin:position]))
    return _neutral(tree, begin)


@cache
def _lark() -> Lark:
    """The parser from its tables, which are rebuilt if they are stale."""
    grammar = grammar_file("rulec.lark").read_text(encoding="utf-8")
    try:
        text = grammar_file("rulec.tables.json").read_text(encoding="utf-8")
        ready = parser_tables.from_text(text, parser_tables.stamp(grammar, lark.__version__))
    except (OSError, ValueError):
        ready = None
    return _made(grammar) if ready is None else Lark.load(ready)


def _made(grammar: str) -> Lark:
    return Lark(
        grammar,
        parser="lalr",
        lexer="contextual",
        start=list(STARTS),
        propagate_positions=True,
        maybe_placeholders=False,
    )


def tables_of(grammar: str) -> str:
    """The text of ``grammar/rulec.tables.json``."""
    data, memo = _made(grammar).memo_serialize([TerminalDef, Rule])
    serialized = {"data": data, "memo": memo}
    return parser_tables.to_text(parser_tables.stamp(grammar, lark.__version__), serialized)


def accepted_after(start: Start, text: str) -> frozenset[str]:
    """The terminals that may follow the beginning of a piece; none if it cannot be read."""
    try:
        return _accepted(start, text)
    except UnexpectedInput:
        return frozenset()


def _position(error: UnexpectedInput, end: int) -> int:
    if isinstance(error, UnexpectedToken) and error.token.type == "$END":
        return end
    return end if error.pos_in_stream is None else error.pos_in_stream


def _accepted(start: Start, good: str) -> frozenset[str]:
    """The terminals that could follow the readable part.

    It is parsed again, because Lark's error lists only terminals found after the parser had acted
    on the wrong token, and omits many that could have followed.
    """
    state = _lark().parse_interactive(good, start=start)
    state.exhaust_lexer()
    return frozenset(state.accepts())  # type: ignore[no-untyped-call]


def _neutral(tree: Tree[Token], begin: int) -> ParseNode | TooDeep:
    """Convert Lark's tree to parse nodes, from the leaves up.

    This is not recursive, because a hostile tree may be very deep.
    """
    done: list[ParseNode | ParseLeaf] = []
    todo: list[tuple[Tree[Token] | Token, int, bool]] = [(tree, 0, False)]
    while todo:
        node, depth, ready = todo.pop()
        if isinstance(node, Token):
            start = begin + (node.start_pos or 0)
            done.append(ParseLeaf(node.type, str(node), start, start + len(node)))
        elif ready:
            first = len(done) - len(node.children)
            meta = node.meta
            inside = tuple(done[first:])
            span = begin + meta.start_pos, begin + meta.end_pos
            done[first:] = [ParseNode(str(node.data), inside, *span)]
        elif depth > MAX_DEPTH:
            return TooDeep(begin + node.meta.start_pos)
        else:
            below = depth + (node.data in _LEVELS)
            todo.append((node, depth, True))
            todo.extend((child, below, False) for child in reversed(node.children))
    root = done[0]
    assert isinstance(root, ParseNode)
    return root

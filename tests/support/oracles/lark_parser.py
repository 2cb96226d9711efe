"""Lark's own parser of the pieces, with its trees as parse nodes."""

from functools import cache

from lark import Token
from lark.exceptions import UnexpectedInput, UnexpectedToken

from rulec.resources import grammar_file
from rulec.syntax.parse_nodes import Mismatch, ParseLeaf, ParseNode
from tools.parser_tables import lark_of


@cache
def lark_parser():
    return lark_of(grammar_file("rulec.lark").read_text(encoding="utf-8"))


def parsed_by_lark(start, text):
    """The node of a text, or where and what Lark expected instead."""
    try:
        return node_of(lark_parser().parse(text, start=start))
    except UnexpectedInput as error:
        at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
        place = len(text) if at_end or error.pos_in_stream is None else error.pos_in_stream
        return Mismatch(place, accepted_by_lark(start, text[:place]))


def accepted_by_lark(start, good):
    """The terminals that may follow the beginning of a piece."""
    state = lark_parser().parse_interactive(good, start=start)
    state.exhaust_lexer()
    return frozenset(state.accepts())


def node_of(tree):
    if isinstance(tree, Token):
        return ParseLeaf(tree.type, str(tree), tree.start_pos, tree.end_pos)
    children = tuple(map(node_of, tree.children))
    return ParseNode(str(tree.data), children, tree.meta.start_pos, tree.meta.end_pos)

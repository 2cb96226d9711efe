"""The grammar file as one parser of whole files, where rulec parses piece by piece."""

from functools import cache

from lark import Lark

from rulec.resources import grammar_file


@cache
def whole_grammar() -> Lark:
    text = grammar_file("rulec.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", lexer="contextual", start="file")

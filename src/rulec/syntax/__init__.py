"""The language as written: text in, a tree with every place, and back.

The way through, which ``parser`` walks:

    bytes -> text -> scanner: coarse tokens
          -> split_file, split_rule: pieces, each parsed by itself, so that one mistake costs one
             error; landmarks tell where one begins, even in a file that is wrong
          -> grammar: each piece by Lark, or where it cannot go on, which messages explain
          -> building, literals: the pieces' nodes -> assemble: rules and the file

``tables`` keep what Lark makes of the grammar, so that no run has to make it again; ``generate``
writes them, and a test says when they are out of date.

``tree`` is what comes out, ``printer`` the way back, ``keywords`` the words that all of them know.
"""

from rulec.syntax.parser import parse, parse_formula
from rulec.syntax.printer import print_file, print_formula
from rulec.syntax.source_decoding import decode

__all__ = ["decode", "parse", "parse_formula", "print_file", "print_formula"]

"""The language as written: text in, a tree with every place, and back."""

from rulec.syntax.printer import print_file, print_formula
from rulec.syntax.read import parse, parse_formula
from rulec.syntax.text import MAX_BYTES, decode

__all__ = ["MAX_BYTES", "decode", "parse", "parse_formula", "print_file", "print_formula"]

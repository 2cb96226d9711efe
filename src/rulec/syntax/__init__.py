"""Concrete syntax: parsing text to a syntax tree, and printing formulas.

The way through stands in the README beside this file.
"""

from rulec.syntax.parser import parse, parse_formula, parse_head
from rulec.syntax.scanner import decode
from rulec.syntax.tree_printer import print_formula

__all__ = ["decode", "parse", "parse_formula", "parse_head", "print_formula"]

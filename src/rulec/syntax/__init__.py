"""Concrete syntax: parses text into a syntax tree, and prints formulas.

The README beside this file describes the steps.
"""

from rulec.syntax.parser import parse, parse_formula, parse_head
from rulec.syntax.scanner import decode
from rulec.syntax.tree_printer import print_formula

__all__ = ["decode", "parse", "parse_formula", "parse_head", "print_formula"]

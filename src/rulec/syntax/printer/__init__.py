"""The syntax tree as text again: fewest parentheses, one form for everything.

Reading what is printed gives the same tree back. Comments are not part of the tree.
"""

from rulec.syntax.printer.files import header_of, print_file, print_item
from rulec.syntax.printer.formulas import (
    Style,
    needs_parentheses,
    precedence,
    print_formula,
    print_parameters,
    print_whole,
)
from rulec.syntax.printer.items import print_header_line, print_in_force
from rulec.syntax.printer.rules import clauses_of, print_example_head, print_rule_head, print_state

__all__ = [
    "Style",
    "clauses_of",
    "header_of",
    "needs_parentheses",
    "precedence",
    "print_example_head",
    "print_file",
    "print_formula",
    "print_header_line",
    "print_in_force",
    "print_item",
    "print_parameters",
    "print_rule_head",
    "print_state",
    "print_whole",
]

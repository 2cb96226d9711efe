"""Items and whole files as text."""

from __future__ import annotations

from rulec.syntax import tree
from rulec.syntax.printer.formulas import (
    Style,
)
from rulec.syntax.printer.items import print_declaration, print_header_line, print_provision
from rulec.syntax.printer.rules import print_rule


def print_file(file: tree.File, style: Style = "words") -> str:
    """A whole file, without its comments; a rule's clauses come in one order.

    Raises:
        ValueError: the tree has an item that could not be read.
    """
    if file.name is None:
        raise ValueError("the tree lacks the file's name")
    items = [print_item(item, style) for item in file.items]
    if file.kind == "vocabulary":
        body = "".join(f"  {item}\n" for item in items)
        return f"vocabulary {file.name.text} {{\n{body}}}\n"
    lines = [f"rulebook {file.name.text}", *(print_header_line(line) for line in header_of(file))]
    for item, text in zip(file.items, items, strict=True):
        lines.append(f"\n{text}" if isinstance(item, tree.RuleItem) else text)
    return "\n".join(lines) + "\n"


def header_of(file: tree.File) -> list[tree.HeaderLine]:
    """A rulebook's header lines in one order."""
    single = (file.title, file.law, file.extends, file.traffic)
    behind = (file.semantics, file.step, *file.priorities)
    return [line for line in (*single, *file.uses, *behind) if line is not None]


def print_item(item: tree.Item, style: Style = "words") -> str:
    """A declaration, a provision or a rule. ValueError for an item that could not be read."""
    if isinstance(item, tree.BrokenItem):
        raise ValueError("an item that could not be read cannot be printed")
    if isinstance(item, tree.RuleItem):
        return print_rule(item, style)
    if isinstance(item, tree.Provision):
        return print_provision(item, style)
    return print_declaration(item, style)

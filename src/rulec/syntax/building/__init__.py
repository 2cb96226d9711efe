"""Syntax tree nodes from parse nodes: one function per kind of piece."""

from rulec.syntax.building.formulas import formula
from rulec.syntax.building.items import item
from rulec.syntax.building.rules import (
    Clause,
    ExampleHead,
    RuleHead,
    clause,
    example_head,
    rule_head,
    state,
)
from rulec.syntax.building.values import NodeValues

__all__ = [
    "Clause",
    "ExampleHead",
    "NodeValues",
    "RuleHead",
    "clause",
    "example_head",
    "formula",
    "item",
    "rule_head",
    "state",
]

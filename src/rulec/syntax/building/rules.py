"""A rule's head, its clauses, the states of its examples."""

from __future__ import annotations

from rulec.syntax import tree
from rulec.syntax.building.formulas import amount, atom, parameters
from rulec.syntax.building.items import in_force, value_of, weight
from rulec.syntax.building.values import NodeValues
from rulec.syntax.grammar import ParseLeaf, ParseNode

_SCOPES: dict[str, tree.Scope] = {
    "INITIALLY": "initially",
    "AT_START": "at start",
    "THROUGHOUT": "throughout",
    "AT_SOME_POINT": "at some point",
    "AT_END": "at end",
}


Clause = tree.Text | tree.Formula | tree.Unless | tree.InForce | str
"""What a clause says; a text for ``certainty``."""


def rule_head(values: NodeValues, node: ParseNode) -> tree.RuleItem:
    """A rule without its clauses."""
    name, *level = values.names(node)
    return tree.RuleItem(
        strength="hard" if node.leaves("HARD") else "soft" if node.leaves("SOFT") else None,
        name=name,
        variables=parameters(values, node),
        level=level[0] if level else None,
        weight=weight(values, node),
        override=bool(node.leaves("OVERRIDE")),
    )


def clause(values: NodeValues, node: ParseNode) -> Clause:
    """The value of a clause."""
    last = node.children[-1]
    match node.kind:
        case "require_clause" | "when_clause":
            return value_of(values, node)
        case "unless_clause":
            scope = _SCOPES[last.kind] if isinstance(last, ParseLeaf) else None
            return tree.Unless(value_of(values, node), scope, span=values.span(node))
        case "certainty_clause":
            return last.text if isinstance(last, ParseLeaf) else ""
        case "in_force":
            return in_force(values, node)
        case _:
            return values.text(node)


def example_head(values: NodeValues, node: ParseNode) -> tree.ExampleItem:
    """An example without its states."""
    label = values.text(node).value if node.leaves("STRING") else ""
    accepts = bool(node.leaves("ACCEPT"))
    return tree.ExampleItem(accepts, (), label, parameters(values, node))


def state(values: NodeValues, node: ParseNode) -> tree.ExampleState:
    """A state of an example."""
    literals = tuple(_literal(values, branch) for branch in node.branches("literal"))
    return tree.ExampleState(literals, span=values.span(node))


def _literal(values: NodeValues, node: ParseNode) -> tree.StateLiteral:
    (use,) = node.branches("atom")
    value: tree.NumberLiteral | tree.Minus | None = None
    for number in node.branches("number"):
        value = amount(values, number)
        if node.leaves("MINUS"):
            value = tree.Minus(value, span=value.span)
    negated = bool(node.leaves("NOT"))
    return tree.StateLiteral(atom(values, use), negated, value, span=values.span(node))

"""Header lines, declarations and provisions."""

from __future__ import annotations

from typing import Literal

from rulec.syntax import tree
from rulec.syntax.building.formulas import amount, formula, parameters
from rulec.syntax.building.values import NodeValues, branches, leaf_of, leaves
from rulec.syntax.grammar import ParseLeaf, ParseNode

_PROVISIONS = ("option", "param", "set", "define", "drop", "soften", "silent")


def item(
    values: NodeValues, node: ParseNode
) -> tree.FileLine | tree.HeaderLine | tree.Declaration | tree.Definition:
    """A header line, a declaration or a provision."""
    span = values.span(node)
    match node.kind:
        case "rulebook_line":
            return tree.FileLine("rulebook", values.name(leaf_of(node, "BOOK")), span)
        case "vocabulary_line":
            return tree.FileLine("vocabulary", values.name(leaf_of(node, "NAME")), span)
        case "title_line":
            return tree.TitleLine(values.text(node), span)
        case "law_line":
            dates = leaves(node, "DATE")
            return tree.LawLine(values.text(node), values.date(dates[0]) if dates else "", span)
        case "use_line":
            return tree.UseLine(values.name(leaf_of(node, "NAME")), span)
        case "extends_line":
            return tree.ExtendsLine(values.name(leaf_of(node, "BOOK")), span)
        case "traffic_line":
            return tree.TrafficLine("left" if leaves(node, "LEFT") else "right", span)
        case "semantics_line":
            return tree.SemanticsLine("finite" if leaves(node, "FINITE") else "stutter", span)
        case "step_line":
            (number,) = branches(node, "number")
            return tree.StepLine(amount(values, number), span)
        case "priority_line":
            signs = [leaf for leaf in node.children if isinstance(leaf, ParseLeaf)]
            relations: list[Literal[">", "="]] = [
                ">" if sign.kind == "GREATER" else "="
                for sign in signs
                if sign.kind in ("GREATER", "EQUALS")
            ]
            return tree.PriorityLine(values.names(node), tuple(relations), span)
        case kind if kind.removesuffix("_item") in _PROVISIONS:
            return definition(values, node)
        case _:
            return declaration(values, node)


def definition(values: NodeValues, node: ParseNode) -> tree.Definition:
    """Build an option, parameter or definition, or a change of one."""
    span = values.span(node)
    name, *others = values.names(node)
    match node.kind:
        case "option_item":
            return tree.OptionItem(name, bool(leaves(node, "ON")), span)
        case "param_item":
            dimension = others[0] if others else None
            return tree.ParamItem(
                name, dimension, value_of(values, node), _dates(values, node), span
            )
        case "set_item":
            value = bool(leaves(node, "ON"))
            if leaves(node, "ON") or leaves(node, "OFF"):
                return tree.SetItem(name, value, None, span)
            return tree.SetItem(name, value_of(values, node), _dates(values, node), span)
        case "define_item":
            body, again = value_of(values, node), bool(leaves(node, "REDEFINE"))
            return tree.DefineItem(name, parameters(values, node), body, again, span)
        case "drop_item":
            return tree.DropItem(name, values.text(node), span)
        case "soften_item":
            because = values.text(node) if leaves(node, "STRING") else None
            level = others[0] if others else None
            return tree.SoftenItem(name, level, weight(values, node), because, span)
        case _:
            return tree.SilentItem(name, values.text(node), span)


def value_of(values: NodeValues, node: ParseNode) -> tree.Formula:
    """The one formula or expression directly below a node."""
    (value,) = (
        child
        for child in node.children
        if isinstance(child, ParseNode) and child.kind not in ("parameters", "in_force")
    )
    return formula(values, value)


def _dates(values: NodeValues, node: ParseNode) -> tree.InForce | None:
    result = branches(node, "in_force")
    return in_force(values, result[0]) if result else None


def in_force(values: NodeValues, node: ParseNode) -> tree.InForce:
    """``in force from DATE until DATE``."""
    dates = [values.date(leaf) for leaf in leaves(node, "DATE")]
    since = dates.pop(0) if leaves(node, "FROM") else ""
    return tree.InForce(since, dates[0] if dates else "", values.span(node))


def weight(values: NodeValues, node: ParseNode) -> tree.NumberLiteral | None:
    """The number behind ``weight``, if there is one."""
    numbers = leaves(node, "NUMBER")
    if not numbers:
        return None
    values.number(numbers[0])
    return tree.NumberLiteral(numbers[0].text, "", values.span(numbers[0]))


def declaration(values: NodeValues, node: ParseNode) -> tree.Declaration:
    """A declaration."""
    span = values.span(node)
    names = values.names(node)
    match node.kind:
        case "type_item":
            return tree.TypeItem(names[0], names[1] if len(names) > 1 else None, span)
        case "enumeration_item":
            (listed,) = branches(node, "names")
            default = names[1] if len(names) > 1 else None
            return tree.EnumerationItem(
                names[0], parameters(values, node), values.names(listed), default, span
            )
        case "quantity_item":
            numbers = leaves(node, "NUMBER")
            number = values.number(numbers[0]) if numbers else None
            if number is not None and leaves(node, "MINUS"):
                number = -number
            unit = leaf_of(node, "UNIT")
            return tree.QuantityItem(
                name=names[0],
                parameters=parameters(values, node),
                unit=unit.text,
                default=number,
                span=span,
                unit_span=values.span(unit),
            )
        case "fact_item":
            return tree.FactItem(value_of(values, node), span)
        case _:
            signals = tuple(
                tree.SignalHead(values.names(head)[0], parameters(values, head), values.span(head))
                for head in branches(node, "signal")
            )
            true, false = leaves(node, "TRUE"), leaves(node, "FALSE")
            return tree.SignalItem(signals, bool(true) if true or false else None, span)

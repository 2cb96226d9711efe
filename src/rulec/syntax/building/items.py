"""Header lines, declarations and provisions."""

from __future__ import annotations

from typing import Literal

from rulec.syntax import tree
from rulec.syntax.building.formulas import amount, formula, parameters
from rulec.syntax.building.values import NodeValues
from rulec.syntax.grammar import ParseNode


def item(
    values: NodeValues, node: ParseNode
) -> tree.FileLine | tree.HeaderLine | tree.Declaration | tree.Definition:
    """A header line, a declaration or a provision."""
    span = values.span(node)
    names = values.names(node)
    match node.kind:
        case "rulebook_line":
            return tree.FileLine("rulebook", *values.names(node, "BOOK"), span=span)
        case "vocabulary_line":
            return tree.FileLine("vocabulary", *names, span=span)
        case "title_line":
            return tree.TitleLine(values.text(node), span=span)
        case "law_line":
            date = "".join(map(values.date, node.leaves("DATE")))
            return tree.LawLine(values.text(node), date, span=span)
        case "use_line":
            return tree.UseLine(*names, span=span)
        case "extends_line":
            return tree.ExtendsLine(*values.names(node, "BOOK"), span=span)
        case "traffic_line":
            return tree.TrafficLine("left" if node.leaves("LEFT") else "right", span=span)
        case "semantics_line":
            return tree.SemanticsLine("finite" if node.leaves("FINITE") else "stutter", span=span)
        case "step_line":
            (number,) = node.branches("number")
            return tree.StepLine(amount(values, number), span=span)
        case "priority_line":
            signs: dict[str, Literal[">", "="]] = {"GREATER": ">", "EQUALS": "="}
            relations = tuple(signs[leaf.kind] for leaf in node.children if leaf.kind in signs)
            return tree.PriorityLine(names, relations, span=span)
        case "type_item":
            return tree.TypeItem(*names, span=span)
        case "enumeration_item":
            (values_node,) = node.branches("names")
            heads, listed = parameters(values, node), values.names(values_node)
            return tree.EnumerationItem(names[0], heads, listed, *names[1:], span=span)
        case "signal_item":
            signals = tuple(
                tree.SignalHead(
                    values.names(head)[0], parameters(values, head), span=values.span(head)
                )
                for head in node.branches("signal")
            )
            true, false = node.leaves("TRUE"), node.leaves("FALSE")
            return tree.SignalItem(signals, bool(true) if true or false else None, span=span)
        case "quantity_item":
            return _quantity(values, node)
        case "fact_item":
            return tree.FactItem(value_of(values, node), span=span)
        case _:
            return _definition(values, node)


def _quantity(values: NodeValues, node: ParseNode) -> tree.QuantityItem:
    (name,), (unit,) = values.names(node), node.leaves("UNIT")
    numbers = [values.number(leaf) for leaf in node.leaves("NUMBER")]
    default = -numbers[0] if node.leaves("MINUS") else numbers[0] if numbers else None
    return tree.QuantityItem(
        name=name,
        parameters=parameters(values, node),
        unit=unit.text,
        default=default,
        span=values.span(node),
        unit_span=values.span(unit),
    )


def _definition(values: NodeValues, node: ParseNode) -> tree.Definition:
    """Build an option, parameter or definition, or a change of one."""
    span = values.span(node)
    name, *others = values.names(node)
    option = bool(node.leaves("ON"))
    other = others[0] if others else None
    match node.kind:
        case "option_item":
            return tree.OptionItem(name, option, span=span)
        case "param_item":
            value, dates = value_of(values, node), _dates(values, node)
            return tree.ParamItem(name, other, value, dates, span=span)
        case "set_item" if option or node.leaves("OFF"):
            return tree.SetItem(name, option, span=span)
        case "set_item":
            return tree.SetItem(name, value_of(values, node), _dates(values, node), span=span)
        case "define_item":
            body, again = value_of(values, node), bool(node.leaves("REDEFINE"))
            return tree.DefineItem(name, parameters(values, node), body, again, span=span)
        case "drop_item":
            return tree.DropItem(name, values.text(node), span=span)
        case "soften_item":
            because = values.text(node) if node.leaves("STRING") else None
            return tree.SoftenItem(name, other, weight(values, node), because, span=span)
        case _:
            return tree.SilentItem(name, values.text(node), span=span)


def value_of(values: NodeValues, node: ParseNode) -> tree.Formula:
    """The one formula or expression directly below a node."""
    (value,) = (
        child
        for child in node.children
        if isinstance(child, ParseNode) and child.kind not in ("parameters", "in_force")
    )
    return formula(values, value)


def _dates(values: NodeValues, node: ParseNode) -> tree.InForce | None:
    return next((in_force(values, dates) for dates in node.branches("in_force")), None)


def in_force(values: NodeValues, node: ParseNode) -> tree.InForce:
    """``in force from DATE until DATE``."""
    dates = [values.date(leaf) for leaf in node.leaves("DATE")]
    since = dates.pop(0) if node.leaves("FROM") else ""
    return tree.InForce(since, *dates, span=values.span(node))


def weight(values: NodeValues, node: ParseNode) -> tree.NumberLiteral | None:
    """The number behind ``weight``, if there is one."""
    for number in node.leaves("NUMBER"):
        values.number(number)
        return tree.NumberLiteral(number.text, span=values.span(number))
    return None

"""Header lines, declarations, provisions, and the parts of rules."""

from __future__ import annotations

from typing import Literal, cast, get_args

from rulec.syntax import tree
from rulec.syntax.building.formulas import NodeValues, amount, atom, formula, parameters
from rulec.syntax.keywords import token_kind
from rulec.syntax.parse_nodes import ParseLeaf, ParseNode


def item(
    values: NodeValues, node: ParseNode
) -> tree.HeaderLine | tree.Declaration | tree.Definition | tree.Listing:
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
        case "constant_item":
            return tree.ConstantItem(_listed(values, node), span=span)
        case "presumed_item":
            return tree.PresumedItem(_listed(values, node), span=span)
        case "topics_item":
            entries = tuple(_topic(values, entry) for entry in node.branches("topic"))
            return tree.TopicsItem(entries, span=span)
        case "provisions_item":
            date = "".join(map(values.date, node.leaves("DATE")))
            articles = tuple(_article(values, entry) for entry in node.branches("article"))
            sure = [clause(values, word) for word in node.branches("certainty_clause")]
            certainty = cast("tree.Certainty", sure[0] if sure else "")
            return tree.ProvisionsItem(values.text(node), date, articles, certainty, span=span)
        case _:
            return _definition(values, node)


def _listed(values: NodeValues, node: ParseNode) -> tuple[tree.Name, ...]:
    (names,) = node.branches("names")
    return values.names(names)


def _topic(values: NodeValues, node: ParseNode) -> tree.TopicEntry:
    (name,) = values.names(node)
    rules = _listed(values, node) if node.branches("names") else ()
    return tree.TopicEntry(name, values.text(node), rules, span=values.span(node))


_TREATMENTS: dict[str, tree.Treatment] = {
    token_kind(words.replace("-", " ")): words for words in get_args(tree.Treatment)
}


def _article(values: NodeValues, node: ParseNode) -> tree.ArticleEntry:
    number, heading, *because = values.texts(node)
    kinds = {leaf.kind for leaf in node.children if isinstance(leaf, ParseLeaf)}
    ways: list[tree.Treatment] = [words for kind, words in _TREATMENTS.items() if kind in kinds]
    treatment = ways[0] if ways else "to do"
    return tree.ArticleEntry(number, heading, treatment, *because, span=values.span(node))


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
    span = values.span(node)
    name, *others = values.names(node)
    option = bool(node.leaves("ON"))
    other = others[0] if others else None
    cite = next((values.text(clause) for clause in node.branches("cite_clause")), None)
    match node.kind:
        case "option_item":
            return tree.OptionItem(name, option, cite, span=span)
        case "param_item":
            value, dates = value_of(values, node), _dates(values, node)
            return tree.ParamItem(name, other, value, dates, cite, span=span)
        case "set_item" if option or node.leaves("OFF"):
            return tree.SetItem(name, option, cite=cite, span=span)
        case "set_item":
            value, dates = value_of(values, node), _dates(values, node)
            return tree.SetItem(name, value, dates, cite, span=span)
        case "define_item":
            body, again = value_of(values, node), bool(node.leaves("REDEFINE"))
            return tree.DefineItem(name, parameters(values, node), body, again, cite, span=span)
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
        if isinstance(child, ParseNode)
        and child.kind not in ("parameters", "in_force", "cite_clause")
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
    """The number after ``weight``, if there is one."""
    for number in node.leaves("NUMBER"):
        values.number(number)
        return tree.NumberLiteral(number.text, span=values.span(number))
    return None


_SCOPES: dict[str, tree.Scope] = {token_kind(scope): scope for scope in get_args(tree.Scope)}


Clause = tree.Text | tree.Formula | tree.Unless | tree.InForce | tuple[tree.Name, ...] | str
"""The content of a clause; a text for ``certainty``, names for ``topic``."""


def rule_head(values: NodeValues, node: ParseNode) -> tree.RuleItem:
    """A rule without its clauses."""
    name, *level = values.names(node)
    confirm = bool(node.leaves("CONFIRM"))
    return tree.RuleItem(
        strength="hard" if node.leaves("HARD") else "soft" if node.leaves("SOFT") else None,
        name=name,
        variables=parameters(values, node),
        level=level[0] if level else None,
        weight=weight(values, node),
        override=bool(node.leaves("OVERRIDE") or confirm),
        confirm=confirm,
    )


def clause(values: NodeValues, node: ParseNode) -> Clause:
    """The value of a clause."""
    last = node.children[-1]
    match node.kind:
        case "require_clause" | "when_clause":
            return value_of(values, node)
        case "unless_clause":
            scope = _SCOPES[last.kind] if isinstance(last, ParseLeaf) else None
            also = bool(node.leaves("ALSO"))
            return tree.Unless(value_of(values, node), scope, also, span=values.span(node))
        case "certainty_clause":
            return last.text if isinstance(last, ParseLeaf) else ""
        case "topic_clause":
            return _listed(values, node)
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

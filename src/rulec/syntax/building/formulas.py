"""Builds names, texts and numbers, and formulas from them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, cast

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax import tree
from rulec.syntax.keywords import SYMBOLS, token_kind
from rulec.syntax.messages import literal_values
from rulec.syntax.messages.literals import misleads, why_not_a_day
from rulec.syntax.parse_nodes import ParseLeaf, ParseNode


@dataclass(frozen=True, slots=True)
class NodeValues:
    """Builder of the values in one source; mistakes are added to ``mistakes``."""

    source: Source
    mistakes: list[Diagnostic] = field(default_factory=list)

    def span(self, node: ParseNode | ParseLeaf) -> Span:
        """The span of a node."""
        return Span(self.source, node.start, node.end)

    def names(self, node: ParseNode, kind: str = "NAME") -> tuple[tree.Name, ...]:
        """The identifiers directly below a node."""
        return tuple(tree.Name(leaf.text, span=self.span(leaf)) for leaf in node.leaves(kind))

    def text(self, node: ParseNode) -> tree.Text:
        """The node's first quoted text, with its escapes and characters checked."""
        return self._text(node.leaves("STRING")[0])

    def texts(self, node: ParseNode) -> tuple[tree.Text, ...]:
        """All quoted texts directly below a node."""
        return tuple(map(self._text, node.leaves("STRING")))

    def _text(self, leaf: ParseLeaf) -> tree.Text:
        inner = leaf.text[1:-1]
        if inner.isascii() and inner.isprintable() and "\\" not in inner:
            return tree.Text(inner, span=self.span(leaf))
        value: list[str] = []
        characters = enumerate(inner, leaf.start + 1)
        for position, character in characters:
            if character == "\\":
                _, escaped = next(characters)
                if escaped not in '"\\':
                    place = Span(self.source, position, position + 2)
                    self.mistakes.append(literal_values.unknown_escape(place, escaped))
                value.append(escaped)
            elif misleads(character):
                place = Span(self.source, position, position + 1)
                self.mistakes.append(literal_values.control_character(place))
            else:
                value.append(character)
        return tree.Text("".join(value), span=self.span(leaf))

    def date(self, leaf: ParseLeaf) -> str:
        """The ISO text of an existing date."""
        wrong = why_not_a_day(leaf.text)
        if wrong:
            self.mistakes.append(literal_values.no_such_date(self.span(leaf), leaf.text, wrong))
        return "" if wrong else leaf.text

    def number(self, leaf: ParseLeaf) -> float:
        """A finite number; 0 if it is too large."""
        number = float(leaf.text)
        if not math.isfinite(number):
            self.mistakes.append(literal_values.number_too_large(self.span(leaf)))
            return 0.0
        return number


_OPERATORS = {token_kind(words): words for words in SYMBOLS}


def formula(values: NodeValues, node: ParseNode) -> tree.Formula:
    """Build a formula or an expression from its parse node."""
    span = values.span(node)
    signs = [child for child in node.children if isinstance(child, ParseLeaf)]
    parts = [
        formula(values, child)
        for child in node.children
        if isinstance(child, ParseNode) and child.kind not in ("bound", "variable", "names")
    ]
    match node.kind:
        case "infix":
            word, (left, right), bound = _OPERATORS[signs[0].kind], parts, _bound(values, node)
            return tree.Infix(word, left, right, bound, signs[0].text, span=span)
        case "prefix":
            word, (operand,), bound = _OPERATORS[signs[0].kind], parts, _bound(values, node)
            return tree.Prefix(word, operand, bound, signs[0].text, span=span)
        case "compare":
            return tree.Compare(cast("Any", signs[0].text), *parts, span=span)
        case "arithmetic":
            return tree.Arithmetic(signs[0].text, *parts, span=span)
        case "minus":
            return tree.Minus(*parts, span=span)
        case "conditional":
            return tree.Conditional(*parts, span=span)
        case "group":
            # Parentheses around what needs none are not worth remembering.
            (inner,) = parts
            return replace(inner, grouped=True) if isinstance(inner, tree.Grouping) else inner
        case "aggregate":
            (variable,) = node.branches("variable")
            word = cast("Any", signs[0].text)
            return tree.Aggregate(word, parameter(values, variable), *parts, span=span)
        case "truth":
            return tree.TruthLiteral(signs[0].kind == "TRUE", span=span)
        case "number":
            return amount(values, node)
        case _:
            return atom(values, node)


def amount(values: NodeValues, node: ParseNode) -> tree.NumberLiteral:
    """A number with its unit, if any."""
    (number,) = node.leaves("NUMBER")
    values.number(number)
    units = "".join(unit.text for unit in node.leaves("UNIT"))
    return tree.NumberLiteral(number.text, units, span=values.span(node))


def _bound(values: NodeValues, operation: ParseNode) -> tree.BoundNode | None:
    for node in operation.branches("bound"):
        span = values.span(node)
        first, *others = (
            atom(values, child) if child.kind == "atom" else amount(values, child)
            for child in node.branches("atom", "number")
        )
        if node.leaves("AT_MOST"):
            return tree.BoundNode(None, first, span=span)
        if node.leaves("AT_LEAST"):
            return tree.BoundNode(first, None, span=span)
        return tree.BoundNode(first, others[0] if others else first, not others, span=span)
    return None


def atom(values: NodeValues, node: ParseNode) -> tree.AtomUse:
    """An atom with its arguments."""
    (name,) = values.names(node)
    arguments = [name for names in node.branches("names") for name in values.names(names)]
    return tree.AtomUse(name, tuple(arguments), span=values.span(node))


def parameter(values: NodeValues, node: ParseNode) -> tree.Parameter:
    """``name`` or ``name: type``."""
    return tree.Parameter(*values.names(node), span=values.span(node))


def parameters(values: NodeValues, node: ParseNode) -> tuple[tree.Parameter, ...]:
    """A declaration's or definition's parameters, or a rule's variables."""
    return tuple(
        parameter(values, branch)
        for group in node.branches("parameters", "variables")
        for branch in group.branches("parameter", "variable")
    )

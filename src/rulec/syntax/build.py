"""From what the grammar matched to the syntax tree."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax import tree
from rulec.syntax.grammar import Branch, Leaf
from rulec.syntax.keywords import SYMBOLS, token_kind
from rulec.syntax.literals import misleads, why_not_a_day

_OPERATORS = {token_kind(words): words for words in SYMBOLS}


@dataclass(frozen=True, slots=True)
class RuleHead:
    """``hard rule NAME (variables)``."""

    strength: str
    name: tree.Name
    variables: tuple[tree.Parameter, ...]


@dataclass(frozen=True, slots=True)
class ExampleHead:
    """``accept "label"`` or ``reject "label"``."""

    accepts: bool
    label: str


@dataclass(frozen=True, slots=True)
class Builder:
    """Builds the nodes of one source; mistakes inside values are added to ``mistakes``."""

    source: Source
    mistakes: list[Diagnostic] = field(default_factory=list)

    def span(self, node: Branch | Leaf) -> Span:
        """The characters of a node."""
        return Span(self.source, node.start, node.end)

    def name(self, leaf: Leaf) -> tree.Name:
        """An identifier."""
        return tree.Name(leaf.text, self.span(leaf))

    def names(self, node: Branch) -> tuple[tree.Name, ...]:
        """The identifiers directly below a node."""
        return tuple(self.name(leaf) for leaf in _leaves(node, "NAME"))

    # Formulas

    def formula(self, node: Branch) -> tree.Formula:
        """A formula; as deep as the parser lets it be."""
        span = self.span(node)
        match node:
            case Branch("infix", (Branch() as left, Leaf(kind=operator), Branch() as right)):
                word = _OPERATORS[operator]
                return tree.Infix(word, self.formula(left), self.formula(right), span)
            case Branch("prefix", (Leaf(kind=operator), Branch() as operand)):
                return tree.Prefix(_OPERATORS[operator], self.formula(operand), span)
            case Branch("group", (_, Branch() as inner, _)):
                return self.formula(inner)
            case Branch("truth", (Leaf(kind=kind),)):
                return tree.Truth(kind == "TRUE", span)
            case _:
                return self.atom(node)

    def atom(self, node: Branch) -> tree.AtomUse:
        """An atom with its arguments."""
        arguments = [name for names in _branches(node, "names") for name in self.names(names)]
        return tree.AtomUse(self.name(_leaf(node, "NAME")), tuple(arguments), self.span(node))

    # Header lines and declarations

    def item(
        self, node: Branch
    ) -> tree.FileLine | tree.TitleLine | tree.LawLine | tree.UseLine | tree.Declaration:
        """A header line or a declaration."""
        span = self.span(node)
        match node.kind:
            case "rulebook_line":
                return tree.FileLine("rulebook", self.name(_leaf(node, "NAME")), span)
            case "vocabulary_line":
                return tree.FileLine("vocabulary", self.name(_leaf(node, "NAME")), span)
            case "title_line":
                return tree.TitleLine(self.text(node), span)
            case "law_line":
                dates = _leaves(node, "DATE")
                return tree.LawLine(self.text(node), self.date(dates[0]) if dates else "", span)
            case "use_line":
                return tree.UseLine(self.name(_leaf(node, "NAME")), span)
            case _:
                return self.declaration(node)

    def declaration(self, node: Branch) -> tree.Declaration:
        """A declaration."""
        span = self.span(node)
        names = self.names(node)
        match node.kind:
            case "type_item":
                return tree.TypeItem(names[0], names[1] if len(names) > 1 else None, span)
            case "enumeration_item":
                (values,) = _branches(node, "names")
                default = names[1] if len(names) > 1 else None
                parameters = self.parameters(node)
                return tree.EnumerationItem(names[0], parameters, self.names(values), default, span)
            case "quantity_item":
                numbers = _leaves(node, "NUMBER")
                number = self.number(numbers[0]) if numbers else None
                unit = _leaf(node, "UNIT").text
                return tree.QuantityItem(names[0], self.parameters(node), unit, number, span)
            case _:
                signals = tuple(
                    tree.SignalHead(self.names(head)[0], self.parameters(head), self.span(head))
                    for head in _branches(node, "signal")
                )
                true, false = _leaves(node, "TRUE"), _leaves(node, "FALSE")
                return tree.SignalItem(signals, bool(true) if true or false else None, span)

    def parameters(self, node: Branch) -> tuple[tree.Parameter, ...]:
        """A declaration's parameters, or a rule's variables."""
        return tuple(
            tree.Parameter(names[0], names[1] if len(names) > 1 else None, self.span(one))
            for group in (*_branches(node, "parameters"), *_branches(node, "variables"))
            for one in (*_branches(group, "parameter"), *_branches(group, "variable"))
            for names in [self.names(one)]
        )

    # Rules

    def rule_head(self, node: Branch) -> RuleHead:
        """A rule's head."""
        strength = "hard" if _leaves(node, "HARD") else "soft"
        return RuleHead(strength, self.names(node)[0], self.parameters(node))

    def example_head(self, node: Branch) -> ExampleHead:
        """An example's head."""
        label = self.text(node).value if _leaves(node, "STRING") else ""
        return ExampleHead(bool(_leaves(node, "ACCEPT")), label)

    def state(self, node: Branch) -> tree.ExampleState:
        """A state of an example."""
        literals = tuple(
            tree.StateLiteral(
                self.atom(_branches(one, "atom")[0]), bool(_leaves(one, "NOT")), self.span(one)
            )
            for one in _branches(node, "literal")
        )
        return tree.ExampleState(literals, self.span(node))

    # Values

    def text(self, node: Branch) -> tree.Text:
        """The node's text in quotes, its escapes and characters checked."""
        leaf = _leaf(node, "STRING")
        span = self.span(leaf)
        value: list[str] = []
        characters = enumerate(leaf.text[1:-1], leaf.start + 1)
        for position, character in characters:
            if character == "\\":
                _, escaped = next(characters)
                if escaped not in '"\\':
                    self._mistake("R0106", position, 2, f"`\\{escaped}` means nothing in a text")
                value.append(escaped)
            elif misleads(character):
                self._mistake("R0107", position, 1, "a text may not hold this invisible character")
            else:
                value.append(character)
        return tree.Text("".join(value), span)

    def date(self, leaf: Leaf) -> str:
        """ISO text of a date that exists."""
        wrong = why_not_a_day(leaf.text)
        if wrong:
            why = f"`{leaf.text}` is no date"
            self._mistake("R0110", leaf.start, len(leaf.text), why, wrong)
        return "" if wrong else leaf.text

    def number(self, leaf: Leaf) -> float:
        """A finite number; 0 in place of one that is too large."""
        number = float(leaf.text)
        if not math.isfinite(number):
            self._mistake("R0112", leaf.start, len(leaf.text), "this number is too large")
            return 0.0
        return number

    def _mistake(self, code: str, position: int, length: int, message: str, hint: str = "") -> None:
        helps = {
            "R0106": '`\\"` is a quote and `\\\\` a backslash',
            "R0107": "delete it, or type it as words",
            "R0112": "write a number below 1e308",
        }
        place = Span(self.source, position, position + length).place
        self.mistakes.append(Diagnostic(code, message, place, help=hint or helps.get(code, "")))


def _leaves(node: Branch, kind: str) -> list[Leaf]:
    return [child for child in node.children if isinstance(child, Leaf) and child.kind == kind]


def _leaf(node: Branch, kind: str) -> Leaf:
    return _leaves(node, kind)[0]


def _branches(node: Branch, kind: str) -> list[Branch]:
    return _of_kind(node.children, kind)


def _of_kind(children: Iterable[Branch | Leaf], kind: str) -> list[Branch]:
    return [child for child in children if isinstance(child, Branch) and child.kind == kind]

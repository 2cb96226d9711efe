"""From what the grammar matched to the syntax tree."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax import tree
from rulec.syntax.grammar import Branch, Leaf
from rulec.syntax.keywords import SYMBOLS, token_kind
from rulec.syntax.literals import misleads, why_not_a_day

_OPERATORS = {token_kind(words): words for words in SYMBOLS}


_PROVISIONS = ("option", "param", "set", "define", "drop", "soften", "silent")

_SCOPES: dict[str, tree.Scope] = {
    "INITIALLY": "initially",
    "AT_START": "at start",
    "THROUGHOUT": "throughout",
    "AT_SOME_POINT": "at some point",
    "AT_END": "at end",
}

_AGGREGATES: dict[str, Literal["some", "every", "count"]] = {
    "SOME": "some",
    "EVERY": "every",
    "COUNT": "count",
}

_RELATIONS: dict[str, Literal["<", "<=", "=", "!=", ">=", ">"]] = {
    "LESS": "<",
    "AT_MOST": "<=",
    "EQUALS": "=",
    "NOT_EQUAL": "!=",
    "AT_LEAST": ">=",
    "GREATER": ">",
}


@dataclass(frozen=True, slots=True)
class RuleHead:
    """``hard rule NAME (variables) in level weight number``, or ``override rule NAME …``."""

    strength: Literal["hard", "soft"] | None
    name: tree.Name
    variables: tuple[tree.Parameter, ...]
    level: tree.Name | None
    weight: tree.Number | None
    override: bool


@dataclass(frozen=True, slots=True)
class ExampleHead:
    """``accept "label" (objects)`` or ``reject …``."""

    accepts: bool
    label: str
    objects: tuple[tree.Parameter, ...]


Clause = tree.Text | tree.Formula | tree.Unless | tree.InForce | str
"""What a clause says; a text for ``certainty``."""


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
        """A formula or an expression; as deep as the parser lets it be."""
        span = self.span(node)
        match node:
            case Branch("infix", (Branch() as left, Leaf() as sign, *bound, Branch() as right)):
                word = _OPERATORS[sign.kind]
                sides = self.formula(left), self.formula(right)
                return tree.Infix(word, *sides, self._bound(bound), span, sign.text)
            case Branch("prefix", (Leaf() as sign, *bound, Branch() as operand)):
                word = _OPERATORS[sign.kind]
                inside = self.formula(operand)
                return tree.Prefix(word, inside, self._bound(bound), span, sign.text)
            case Branch("compare", (Branch() as left, Leaf(kind=kind), Branch() as right)):
                sides = self.formula(left), self.formula(right)
                return tree.Compare(_RELATIONS[kind], *sides, span)
            case Branch("arithmetic", (Branch() as left, Leaf() as sign, Branch() as right)):
                return tree.Arithmetic(sign.text, self.formula(left), self.formula(right), span)
            case Branch("minus", (_, Branch() as operand)):
                return tree.Minus(self.formula(operand), span)
            case Branch(
                "conditional", (Branch() as value, _, Branch() as test, _, Branch() as other)
            ):
                parts = self.formula(value), self.formula(test), self.formula(other)
                return tree.Conditional(*parts, span)
            case Branch("group", (_, Branch() as inner, _)):
                return _grouped(self.formula(inner))
            case Branch(
                "aggregate", (Leaf() as kind, Branch() as variable, _, Branch() as body, _)
            ):
                word = _AGGREGATES[kind.kind]
                return tree.Aggregate(word, self._parameter(variable), self.formula(body), span)
            case Branch("truth", (Leaf(kind=kind),)):
                return tree.Truth(kind == "TRUE", span)
            case Branch("number"):
                return self.amount(node)
            case _:
                return self.atom(node)

    def amount(self, node: Branch) -> tree.Number:
        """A number with its unit, if any."""
        number = _leaf(node, "NUMBER")
        self.number(number)
        units = _leaves(node, "UNIT")
        return tree.Number(number.text, units[0].text if units else "", self.span(node))

    def _bound(self, nodes: Sequence[Branch | Leaf]) -> tree.Bound | None:
        if not nodes:
            return None
        (node,) = nodes
        assert isinstance(node, Branch), "a bound is no token"
        first, *others = (
            self.atom(one) if one.kind == "atom" else self.amount(one)
            for one in node.children
            if isinstance(one, Branch)
        )
        span = self.span(node)
        if _leaves(node, "AT_MOST"):
            return tree.Bound(None, first, span=span)
        if _leaves(node, "AT_LEAST"):
            return tree.Bound(first, None, span=span)
        return tree.Bound(first, others[0] if others else first, not others, span)

    def atom(self, node: Branch) -> tree.AtomUse:
        """An atom with its arguments."""
        arguments = [name for names in _branches(node, "names") for name in self.names(names)]
        return tree.AtomUse(self.name(_leaf(node, "NAME")), tuple(arguments), self.span(node))

    # Header lines and declarations

    def item(
        self, node: Branch
    ) -> tree.FileLine | tree.HeaderLine | tree.Declaration | tree.Provision:
        """A header line, a declaration or a provision."""
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
            case "extends_line":
                return tree.ExtendsLine(self.name(_leaf(node, "NAME")), span)
            case "traffic_line":
                return tree.TrafficLine("left" if _leaves(node, "LEFT") else "right", span)
            case "semantics_line":
                return tree.SemanticsLine("finite" if _leaves(node, "FINITE") else "stutter", span)
            case "step_line":
                (amount,) = _branches(node, "number")
                return tree.StepLine(self.amount(amount), span)
            case "priority_line":
                signs = [leaf for leaf in node.children if isinstance(leaf, Leaf)]
                relations: list[Literal[">", "="]] = [
                    ">" if sign.kind == "GREATER" else "="
                    for sign in signs
                    if sign.kind in ("GREATER", "EQUALS")
                ]
                return tree.PriorityLine(self.names(node), tuple(relations), span)
            case kind if kind.removesuffix("_item") in _PROVISIONS:
                return self.provision(node)
            case _:
                return self.declaration(node)

    def provision(self, node: Branch) -> tree.Provision:
        """An option, a parameter, a definition, or what is done to an inherited one."""
        span = self.span(node)
        name, *others = self.names(node)
        match node.kind:
            case "option_item":
                return tree.OptionItem(name, bool(_leaves(node, "ON")), span)
            case "param_item":
                dimension = others[0] if others else None
                return tree.ParamItem(name, dimension, self._value(node), self._dates(node), span)
            case "set_item":
                value = bool(_leaves(node, "ON"))
                if _leaves(node, "ON") or _leaves(node, "OFF"):
                    return tree.SetItem(name, value, None, span)
                return tree.SetItem(name, self._value(node), self._dates(node), span)
            case "define_item":
                body, again = self._value(node), bool(_leaves(node, "REDEFINE"))
                return tree.DefineItem(name, self.parameters(node), body, again, span)
            case "drop_item":
                return tree.DropItem(name, self.text(node), span)
            case "soften_item":
                because = self.text(node) if _leaves(node, "STRING") else None
                level = others[0] if others else None
                return tree.SoftenItem(name, level, self._weight(node), because, span)
            case _:
                return tree.SilentItem(name, self.text(node), span)

    def _value(self, node: Branch) -> tree.Formula:
        """The one formula or expression directly below a node."""
        (value,) = (
            child
            for child in node.children
            if isinstance(child, Branch) and child.kind not in ("parameters", "in_force")
        )
        return self.formula(value)

    def _dates(self, node: Branch) -> tree.InForce | None:
        found = _branches(node, "in_force")
        return self.in_force(found[0]) if found else None

    def in_force(self, node: Branch) -> tree.InForce:
        """``in force from DATE until DATE``."""
        dates = [self.date(leaf) for leaf in _leaves(node, "DATE")]
        since = dates.pop(0) if _leaves(node, "FROM") else ""
        return tree.InForce(since, dates[0] if dates else "", self.span(node))

    def _weight(self, node: Branch) -> tree.Number | None:
        numbers = _leaves(node, "NUMBER")
        if not numbers:
            return None
        self.number(numbers[0])
        return tree.Number(numbers[0].text, "", self.span(numbers[0]))

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
                if number is not None and _leaves(node, "MINUS"):
                    number = -number
                unit = _leaf(node, "UNIT").text
                return tree.QuantityItem(names[0], self.parameters(node), unit, number, span)
            case "fact_item":
                return tree.FactItem(self._value(node), span)
            case _:
                signals = tuple(
                    tree.SignalHead(self.names(head)[0], self.parameters(head), self.span(head))
                    for head in _branches(node, "signal")
                )
                true, false = _leaves(node, "TRUE"), _leaves(node, "FALSE")
                return tree.SignalItem(signals, bool(true) if true or false else None, span)

    def parameters(self, node: Branch) -> tuple[tree.Parameter, ...]:
        """A declaration's or definition's parameters, or a rule's variables."""
        return tuple(
            self._parameter(one)
            for group in (*_branches(node, "parameters"), *_branches(node, "variables"))
            for one in (*_branches(group, "parameter"), *_branches(group, "variable"))
        )

    def _parameter(self, node: Branch) -> tree.Parameter:
        names = self.names(node)
        return tree.Parameter(names[0], names[1] if len(names) > 1 else None, self.span(node))

    # Rules

    def rule_head(self, node: Branch) -> RuleHead:
        """A rule's head."""
        name, *level = self.names(node)
        hard, soft = _leaves(node, "HARD"), _leaves(node, "SOFT")
        return RuleHead(
            "hard" if hard else "soft" if soft else None,
            name,
            self.parameters(node),
            level[0] if level else None,
            self._weight(node),
            bool(_leaves(node, "OVERRIDE")),
        )

    def clause(self, node: Branch) -> Clause:
        """What a clause says."""
        match node.kind:
            case "require_clause" | "when_clause":
                return self._value(node)
            case "unless_clause":
                *_, last = node.children
                scope = None
                if isinstance(last, Leaf):
                    scope = _SCOPES[last.kind]
                return tree.Unless(self._value(node), scope, self.span(node))
            case "certainty_clause":
                return node.children[1].text if isinstance(node.children[1], Leaf) else ""
            case "in_force":
                return self.in_force(node)
            case _:
                return self.text(node)

    def example_head(self, node: Branch) -> ExampleHead:
        """An example's head."""
        label = self.text(node).value if _leaves(node, "STRING") else ""
        return ExampleHead(bool(_leaves(node, "ACCEPT")), label, self.parameters(node))

    def state(self, node: Branch) -> tree.ExampleState:
        """A state of an example."""
        literals = tuple(self._literal(one) for one in _branches(node, "literal"))
        return tree.ExampleState(literals, self.span(node))

    def _literal(self, node: Branch) -> tree.StateLiteral:
        (atom,) = _branches(node, "atom")
        value: tree.Number | tree.Minus | None = None
        for number in _branches(node, "number"):
            value = self.amount(number)
            if _leaves(node, "MINUS"):
                value = tree.Minus(value, value.span)
        return tree.StateLiteral(
            self.atom(atom), bool(_leaves(node, "NOT")), value, self.span(node)
        )

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


_GROUPS = (
    *(tree.Prefix, tree.Infix, tree.Compare),
    *(tree.Arithmetic, tree.Minus, tree.Conditional),
)


def _grouped(formula: tree.Formula) -> tree.Formula:
    """Parentheses around what needs none are not worth remembering."""
    return replace(formula, grouped=True) if isinstance(formula, _GROUPS) else formula


def _leaves(node: Branch, kind: str) -> list[Leaf]:
    return [child for child in node.children if isinstance(child, Leaf) and child.kind == kind]


def _leaf(node: Branch, kind: str) -> Leaf:
    return _leaves(node, kind)[0]


def _branches(node: Branch, kind: str) -> list[Branch]:
    return _of_kind(node.children, kind)


def _of_kind(children: Iterable[Branch | Leaf], kind: str) -> list[Branch]:
    return [child for child in children if isinstance(child, Branch) and child.kind == kind]

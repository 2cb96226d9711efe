"""Occurrences of names in a file, with their meanings."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from rulec.diagnostics import Span
from rulec.language_server.workspace.editor_workspace import CheckedDocument
from rulec.rulebook.names.referenced_names import formulas_of, parts_of
from rulec.rulebook.resolve import BookNames
from rulec.syntax import tree
from rulec.vocabulary import Quantity, Signal

NameKind = Literal[
    "rule",
    "option",
    "parameter",
    "definition",
    "type",
    "signal",
    "quantity",
    "enumeration",
    "value",
    "level",
    "topic",
    "variable",
    "file",
]


@dataclass(frozen=True, slots=True)
class NamedSymbol:
    """The meaning of a name; ``span`` is where it is declared.

    For a ``file`` the span is empty: the beginning of the rulebook or vocabulary.
    """

    kind: NameKind
    name: str
    span: Span

    def is_alike(self, other: NamedSymbol) -> bool:
        """Whether two symbols may be the same; different variables can be alike."""
        if (self.kind, self.name) != (other.kind, other.name):
            return False
        return os.path.realpath(self.span.source.name) == os.path.realpath(other.span.source.name)


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A name in a file, ``span``, and its meaning.

    ``listed``: it is in a topic's list, which names rules by the beginnings of their names.
    """

    span: Span
    symbol: NamedSymbol
    declares: bool = False
    listed: bool = False


Scope = Mapping[str, NamedSymbol]
"""The variables of a rule, a definition or a count."""


@dataclass(frozen=True, slots=True)
class NamesOfChain:
    """Everything that is named in a rulebook, its bases, and their vocabularies."""

    names: BookNames
    books: Sequence[tree.File]
    vocabularies: Sequence[tree.File]

    def symbol(self, name: str) -> NamedSymbol | None:
        """The option, parameter, definition or word with this name."""
        laid, symbols = self.names.constants.overlay, self.names.symbols
        if kind := laid.kind_of(name):
            named: NameKind = "option" if kind == "option" else "definition"
            named = "parameter" if kind == "parameter" else named
            return NamedSymbol(named, name, laid.declared_at[name].span)
        span = symbols.spans.get(name)
        if span is None:
            return None
        item = symbols.items.get(name)
        if item is None:
            return NamedSymbol("value", name, span)
        if isinstance(item, Signal):
            return NamedSymbol("signal", name, span)
        return NamedSymbol("quantity" if isinstance(item, Quantity) else "enumeration", name, span)

    def type(self, name: str) -> NamedSymbol | None:
        """The type with this name."""
        span = self.names.symbols.type_spans.get(name)
        return None if span is None else NamedSymbol("type", name, span)

    def rule(self, name: str, until: tree.File | None = None) -> NamedSymbol | None:
        """The rule with this name, where it is declared; ``until`` is the last book searched."""
        named_symbol: NamedSymbol | None = None
        for book in self.books:
            for item in book.items:
                if isinstance(item, tree.RuleItem) and not item.override and item.name.text == name:
                    named_symbol = NamedSymbol("rule", name, item.name.span)
            if book is until:
                break
        return named_symbol

    def level(self, name: str) -> NamedSymbol | None:
        """The priority level with this name, where it first appears."""
        for book in self.books:
            for line in book.priorities:
                for level in line.levels:
                    if level.text == name:
                        return NamedSymbol("level", name, level.span)
        return None

    def topic(self, name: str) -> NamedSymbol | None:
        """The topic with this name."""
        entry = self.names.constants.overlay.topics.get(name)
        return None if entry is None else NamedSymbol("topic", name, entry.name.span)

    def file(self, name: str) -> NamedSymbol | None:
        """The rulebook or vocabulary with this name."""
        for file in (*self.books[:-1], *self.vocabularies):
            if file.name is not None and file.name.text == name:
                return NamedSymbol("file", name, Span(file.span.source, 0, 0))
        return None


def occurrences(file: tree.File, chain: NamesOfChain) -> Iterator[Occurrence]:
    """All names of a file that have a meaning, in no particular order."""
    for line in (*file.uses, *((file.extends,) if file.extends else ())):
        yield from _at(line.name, chain.file(line.name.text))
    for priority in file.priorities:
        for level in priority.levels:
            yield from _at(level, chain.level(level.text))
    for item in file.items:
        yield from _in_item(item, file, chain)


def _at(name: tree.Name, symbol: NamedSymbol | None) -> Iterator[Occurrence]:
    if symbol is not None:
        same = symbol.span.source is name.span.source and symbol.span.start == name.span.start
        yield Occurrence(name.span, symbol, declares=same)


def _in_item(item: tree.Item, file: tree.File, chain: NamesOfChain) -> Iterator[Occurrence]:
    match item:
        case tree.RuleItem():
            yield from _at(item.name, chain.rule(item.name.text, file))
            yield from _in_rule(item, chain)
        case tree.DropItem(name) | tree.SoftenItem(name):
            yield from _at(name, chain.rule(name.text, file))
            if isinstance(item, tree.SoftenItem) and item.level is not None:
                yield from _at(item.level, chain.level(item.level.text))
        case tree.SilentItem(name):
            yield from _at(name, chain.rule(name.text, file) or chain.topic(name.text))
        case tree.TypeItem(name, parent):
            yield from _at(name, chain.type(name.text))
            if parent is not None:
                yield from _at(parent, chain.type(parent.text))
        case tree.EnumerationItem():
            yield from _at(item.name, chain.symbol(item.name.text))
            yield from _types(item.parameters, chain)
            for value in (*item.values, *((item.default,) if item.default else ())):
                yield from _at(value, chain.symbol(value.text))
        case tree.SignalItem(signals):
            for head in signals:
                yield from _at(head.name, chain.symbol(head.name.text))
                yield from _types(head.parameters, chain)
        case tree.QuantityItem(name, parameters):
            yield from _at(name, chain.symbol(name.text))
            yield from _types(parameters, chain)
        case tree.ConstantItem(names) | tree.PresumedItem(names):
            for name in names:
                yield from _at(name, chain.symbol(name.text))
        case tree.FactItem(formula):
            yield from in_formula(formula, {}, chain)
        case tree.OptionItem(name):
            yield from _at(name, chain.symbol(name.text))
        case tree.ParamItem(name, _, value) | tree.SetItem(name, value):
            yield from _at(name, chain.symbol(name.text))
            if not isinstance(value, bool):
                yield from in_formula(value, {}, chain)
        case tree.DefineItem(name, parameters, body):
            yield from _at(name, chain.symbol(name.text))
            yield from _types(parameters, chain)
            yield from _variables(parameters)
            yield from in_formula(body, variables_of(parameters), chain)
        case tree.TopicsItem(entries):
            for entry in entries:
                yield from _at(entry.name, chain.topic(entry.name.text))
                for name in entry.rules:
                    if (rule := chain.rule(name.text)) is not None:
                        yield Occurrence(name.span, rule, listed=True)


def _in_rule(rule: tree.RuleItem, chain: NamesOfChain) -> Iterator[Occurrence]:
    scope: Scope = variables_of(rule.variables)
    inherited = chain.names.constants.overlay.rules.get(rule.name.text)
    if rule.override and not rule.variables and inherited is not None:
        scope = variables_of(inherited.item.variables)
    yield from _types(rule.variables, chain)
    yield from _variables(rule.variables)
    if rule.level is not None:
        yield from _at(rule.level, chain.level(rule.level.text))
    for topic in rule.topics:
        yield from _at(topic, chain.topic(topic.text))
    for formula in formulas_of(rule):
        yield from in_formula(formula, scope, chain)
    for example in rule.examples:
        yield from _types(example.objects, chain)
        yield from _variables(example.objects)
        inside = {**scope, **variables_of(example.objects)}
        for state in example.states:
            for literal in state.literals:
                yield from _use(literal.atom, inside, chain)


def variables_of(parameters: Iterable[tree.Parameter]) -> dict[str, NamedSymbol]:
    """The meanings of parameter names inside their rule or definition."""
    return {
        parameter.name.text: NamedSymbol("variable", parameter.name.text, parameter.name.span)
        for parameter in parameters
    }


def _variables(parameters: Iterable[tree.Parameter]) -> Iterator[Occurrence]:
    for parameter in parameters:
        symbol = NamedSymbol("variable", parameter.name.text, parameter.name.span)
        yield Occurrence(parameter.name.span, symbol, declares=True)


def _types(parameters: Iterable[tree.Parameter], chain: NamesOfChain) -> Iterator[Occurrence]:
    for parameter in parameters:
        if parameter.type is not None:
            yield from _at(parameter.type, chain.type(parameter.type.text))


def in_formula(formula: tree.Formula, scope: Scope, chain: NamesOfChain) -> Iterator[Occurrence]:
    """All names in a formula that have a meaning."""
    match formula:
        case tree.AtomUse():
            yield from _use(formula, scope, chain)
        case tree.Aggregate(variable=variable):
            yield from _types([variable], chain)
            yield from _variables([variable])
            scope = {**scope, **variables_of([variable])}
        case tree.Prefix(bound=bound) | tree.Infix(bound=bound) if bound is not None:
            for side in (bound.low, bound.high if bound.high is not bound.low else None):
                if isinstance(side, tree.AtomUse):
                    yield from _use(side, scope, chain)
    for part in parts_of(formula):
        yield from in_formula(part, scope, chain)


def _use(use: tree.AtomUse, scope: Scope, chain: NamesOfChain) -> Iterator[Occurrence]:
    name = use.name.text
    symbol = scope.get(name) or chain.symbol(name)
    if symbol is not None:
        yield from _at(use.name, symbol)
    elif not use.arguments:
        yield from _short_form(use.name, scope, chain)
    for argument in use.arguments:
        yield from _at(argument, scope.get(argument.text) or chain.symbol(argument.text))


def _short_form(name: tree.Name, scope: Scope, chain: NamesOfChain) -> Iterator[Occurrence]:
    """``b_v``, which stands for ``b(v)``."""
    for at, letter in enumerate(name.text):
        head, variable = name.text[:at], name.text[at + 1 :]
        symbol = chain.symbol(head) if letter == "_" and variable in scope else None
        if symbol is not None and symbol.kind in ("signal", "quantity", "value"):
            start, source = name.span.start, name.span.source
            yield Occurrence(Span(source, start, start + at), symbol)
            yield Occurrence(Span(source, start + at + 1, name.span.end), scope[variable])


@dataclass(frozen=True, slots=True)
class DocumentNames:
    """A checked document and everything that is named in its chain of rulebooks."""

    checked: CheckedDocument
    chain: NamesOfChain

    @property
    def file(self) -> tree.File:
        """The tree of the document itself."""
        return self.chain.books[-1]

    def bounds(self, span: Span) -> tuple[int, int]:
        """The character offsets of a span in the document's text, or in the span's own file."""
        return span.start, span.end

    def text_of(self, span: Span) -> str:
        """The text of the file that a span is in."""
        own = span.source is self.checked.source
        return self.checked.text if own else span.source.text

    def is_same(self, symbol: NamedSymbol, other: NamedSymbol, names: DocumentNames) -> bool:
        """Whether a symbol of this document is the same as one of another document, ``names``."""
        if not symbol.is_alike(other):
            return False
        return symbol.kind != "variable" or self.bounds(symbol.span) == names.bounds(other.span)

    def all(self) -> Iterator[Occurrence]:
        """All names of the document that have a meaning."""
        return occurrences(self.file, self.chain)

    def at(self, offset: int) -> Occurrence | None:
        """The name at a character or ending before it; the shortest if there are several."""
        here = [
            (end - start, number, occurrence)
            for number, occurrence in enumerate(self.all())
            for start, end in [self.bounds(occurrence.span)]
            if start <= offset <= end
        ]
        return min(here)[2] if here else None


def names_in_document(checked: CheckedDocument) -> DocumentNames:
    """The names of a document."""
    trees, names = checked.resolved.trees, checked.resolved.names
    return DocumentNames(checked, NamesOfChain(names, trees.books, trees.vocabularies))


def item_at(names: DocumentNames, offset: int) -> tree.Item | None:
    """The item of the document that contains a character."""
    for item in names.file.items:
        start, end = names.bounds(item.span)
        if start <= offset <= end:
            return item
    return None

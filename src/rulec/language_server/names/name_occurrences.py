"""Occurrences of names in a file, with their meanings."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from rulec.diagnostics import Span
from rulec.language_server.workspace.editor_workspace import CheckedDocument
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

    def is_same(self, other: NamedSymbol) -> bool:
        """Whether two symbols are the same; variables of one name differ by their places."""
        if (self.kind, self.name) != (other.kind, other.name):
            return False
        own, theirs = self.span, other.span
        if self.kind == "variable" and (own.start, own.end) != (theirs.start, theirs.end):
            return False
        return os.path.realpath(own.source.name) == os.path.realpath(theirs.source.name)


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

    def rule(self, name: str) -> NamedSymbol | None:
        """The rule with this name, where it is declared."""
        named_symbol: NamedSymbol | None = None
        for book in self.books:
            for item in book.items:
                if isinstance(item, tree.RuleItem) and not item.override and item.name.text == name:
                    named_symbol = NamedSymbol("rule", name, item.name.span)
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

    def items_at(self, symbol: NamedSymbol) -> Iterator[tree.Item]:
        """The items of the rulebooks that a symbol is declared in."""
        source, start = symbol.span.source, symbol.span.start
        for item in (item for book in self.books for item in book.items):
            if item.span.source is source and item.span.start <= start < item.span.end:
                yield item

    def file(self, name: str) -> NamedSymbol | None:
        """The rulebook or vocabulary with this name."""
        for file in (*self.books[:-1], *self.vocabularies):
            if file.name is not None and file.name.text == name:
                return NamedSymbol("file", name, Span(file.span.source, 0, 0))
        return None


def occurrences(node: tree.SyntaxNode, scope: Scope, chain: NamesOfChain) -> Iterator[Occurrence]:
    """All names in a part of a file that have a meaning, in no particular order."""
    if isinstance(node, tree.AtomUse):
        yield from _use(node, scope, chain)
        return
    own = _variables_of(node, chain)
    scope = {**scope, **own} if own else scope
    for field, part in tree.parts_of(node):
        if not isinstance(part, tree.Name):
            yield from occurrences(part, scope, chain)
        elif (symbol := _named(node, field, part.text, scope, chain)) is not None:
            listed = isinstance(node, tree.TopicEntry) and field == "rules"
            yield _at(part, symbol, listed=listed)


def _variables_of(node: tree.SyntaxNode, chain: NamesOfChain) -> dict[str, NamedSymbol]:
    """The variables that a node declares, or an override inherits, for what is in it."""
    parameters: Sequence[tree.Parameter] = ()
    match node:
        case tree.RuleItem(name=name, variables=parameters):
            inherited = chain.names.constants.overlay.rules.get(name.text)
            if node.override and not parameters and inherited is not None:
                parameters = inherited.item.variables
        case tree.DefineItem(parameters=parameters) | tree.ExampleItem(objects=parameters):
            pass
        case tree.Aggregate(variable=variable):
            parameters = (variable,)
    names = [parameter.name for parameter in parameters]
    return {name.text: NamedSymbol("variable", name.text, name.span) for name in names}


def _named(
    node: tree.SyntaxNode, field: str, name: str, scope: Scope, chain: NamesOfChain
) -> NamedSymbol | None:
    """The meaning of a name that stands in a field of a node."""
    match node, field:
        case (tree.File(), _) | (_, "dimension"):
            return None
        case tree.Parameter(), "name":
            return scope.get(name)
        case (tree.TypeItem(), _) | (_, "type"):
            return chain.type(name)
        case _, "level" | "levels":
            return chain.level(name)
        case (_, "topics") | (tree.TopicEntry(), "name"):
            return chain.topic(name)
        case (tree.UseLine() | tree.ExtendsLine(), _):
            return chain.file(name)
        case tree.SilentItem(), _:
            return chain.rule(name) or chain.topic(name)
        case tree.RuleItem() | tree.DropItem() | tree.SoftenItem() | tree.TopicEntry(), _:
            return chain.rule(name)
    return chain.symbol(name)


def _at(name: tree.Name, symbol: NamedSymbol, *, listed: bool = False) -> Occurrence:
    same = symbol.span.source is name.span.source and symbol.span.start == name.span.start
    return Occurrence(name.span, symbol, declares=same and not listed, listed=listed)


def _use(use: tree.AtomUse, scope: Scope, chain: NamesOfChain) -> Iterator[Occurrence]:
    name = use.name.text
    symbol = scope.get(name) or chain.symbol(name)
    if symbol is not None:
        yield _at(use.name, symbol)
    elif not use.arguments:
        yield from _short_form(use.name, scope, chain)
    for argument in use.arguments:
        if (symbol := scope.get(argument.text) or chain.symbol(argument.text)) is not None:
            yield _at(argument, symbol)


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

    def text_of(self, span: Span) -> str:
        """The text of the file that a span is in."""
        own = span.source is self.checked.source
        return self.checked.text if own else span.source.text

    def all(self) -> Iterator[Occurrence]:
        """All names of the document that have a meaning."""
        return occurrences(self.file, {}, self.chain)

    def at(self, offset: int) -> Occurrence | None:
        """The name at a character or ending before it; the shortest if there are several."""
        here = [
            (occurrence.span.end - occurrence.span.start, number, occurrence)
            for number, occurrence in enumerate(self.all())
            if occurrence.span.start <= offset <= occurrence.span.end
        ]
        return min(here)[2] if here else None


def names_in_document(checked: CheckedDocument) -> DocumentNames:
    """The names of a document."""
    trees, names = checked.resolved.trees, checked.resolved.names
    return DocumentNames(checked, NamesOfChain(names, trees.books, trees.vocabularies))


def item_at(names: DocumentNames, offset: int) -> tree.Item | None:
    """The item of the document that contains a character."""
    for item in names.file.items:
        if item.span.start <= offset <= item.span.end:
            return item
    return None

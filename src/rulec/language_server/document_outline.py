"""Outline and folding ranges of a document."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types as lsp

from rulec.diagnostics import Span
from rulec.language_server.names.name_occurrences import DocumentNames
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.syntax import tree
from rulec.syntax.tree_printer import print_formula

_Named = tree.RuleItem | tree.TypeItem | tree.EnumerationItem | tree.QuantityItem | tree.Definition
_EVENT = lsp.SymbolKind.Event
_KINDS = {
    tree.RuleItem: lsp.SymbolKind.Method,
    tree.DefineItem: lsp.SymbolKind.Function,
    tree.ParamItem: lsp.SymbolKind.Constant,
    tree.SetItem: lsp.SymbolKind.Constant,
    tree.OptionItem: lsp.SymbolKind.Boolean,
    tree.TypeItem: lsp.SymbolKind.Class,
    tree.EnumerationItem: lsp.SymbolKind.Enum,
    tree.QuantityItem: lsp.SymbolKind.Number,
    tree.DropItem: _EVENT,
    tree.SoftenItem: _EVENT,
    tree.SilentItem: _EVENT,
}


def outline(names: DocumentNames, positions: TextPositions) -> list[lsp.DocumentSymbol]:
    """The items of a document by name; a rule's examples are its children."""
    return [symbol for item in names.file.items for symbol in _symbols(item, positions)]


def _symbols(item: tree.Item, positions: TextPositions) -> Iterator[lsp.DocumentSymbol]:
    def symbol(
        name: tree.Name, kind: lsp.SymbolKind, span: Span, detail: str = ""
    ) -> lsp.DocumentSymbol:
        return lsp.DocumentSymbol(
            name=name.text,
            kind=kind,
            range=positions.of(span),
            selection_range=positions.of(name.span),
            detail=detail or None,
        )

    if isinstance(item, tree.SignalItem):
        for head in item.signals:
            yield symbol(head.name, lsp.SymbolKind.Variable, item.span, "signal")
    elif isinstance(item, tree.TopicsItem):
        for entry in item.entries:
            yield symbol(entry.name, lsp.SymbolKind.Namespace, entry.span, entry.title.value)
    elif isinstance(item, _Named):
        own = symbol(item.name, _KINDS[type(item)], item.span, _detail(item))
        if isinstance(item, tree.RuleItem):
            own.children = [
                symbol(tree.Name(_title(example, number), span=example.span), _EVENT, example.span)
                for number, example in enumerate(item.examples, 1)
            ]
        yield own


def _title(example: tree.ExampleItem, number: int) -> str:
    return f"{'accept' if example.accepts else 'reject'} {example.label or number}"


def _detail(item: tree.Item) -> str:
    match item:
        case tree.RuleItem(strength, cite=cite):
            deed = "confirm" if item.confirm else "override" if item.override else ""
            return " ".join(filter(None, (deed, strength, cite.value if cite else "")))
        case tree.ParamItem(value=value) | tree.SetItem(value=value):
            text = print_formula(value) if not isinstance(value, bool) else "on" if value else "off"
            return f"= {text}"
    return ""


def folds(names: DocumentNames, positions: TextPositions) -> list[lsp.FoldingRange]:
    """The items, examples and comments that span several lines."""
    spans: list[Span] = []
    for item in names.file.items:
        spans.append(item.span)
        if isinstance(item, tree.RuleItem):
            spans += (example.span for example in item.examples)
    ranges = [
        lsp.FoldingRange(start_line=whole.start.line, end_line=whole.end.line)
        for whole in map(positions.of, spans)
        if whole.end.line > whole.start.line
    ]
    return [*ranges, *_comment_folds(positions.text)]


def _comment_folds(text: str) -> Iterator[lsp.FoldingRange]:
    first: int | None = None
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    for number, line in enumerate([*lines, ""]):
        if line.lstrip().startswith("#"):
            first = number if first is None else first
        elif first is not None:
            if number - first > 1:
                kind = lsp.FoldingRangeKind.Comment
                yield lsp.FoldingRange(start_line=first, end_line=number - 1, kind=kind)
            first = None

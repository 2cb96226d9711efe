"""Declarations and uses of a symbol in all files of the workspace."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from lsprotocol import types as lsp

from rulec.diagnostics import RulecError
from rulec.language_server.names.document_names import DocumentNames, names_in_document
from rulec.language_server.names.name_occurrences import NamedSymbol
from rulec.language_server.workspace.editor_workspace import EditorWorkspace, uri_of
from rulec.syntax import tree


@dataclass(frozen=True, slots=True)
class NamePlace:
    """A name in some file, by character offsets; ``listed`` if it is in a topic's list."""

    uri: str
    start: int
    end: int
    location: lsp.Location
    declares: bool
    listed: bool


def declaration_of(
    names: DocumentNames, symbol: NamedSymbol, editor: EditorWorkspace
) -> lsp.Location:
    """Where a symbol is declared."""
    span = symbol.span
    positions = editor.positions(names.text_of(span))
    return lsp.Location(uri_of(span.source.name), positions.range(*names.bounds(span)))


def references_to(
    symbol: NamedSymbol, names: DocumentNames, editor: EditorWorkspace
) -> list[NamePlace]:
    """All places of a symbol's name."""
    places: dict[tuple[str, int], NamePlace] = {}
    for book in books_with(symbol, names, editor):
        for place in _in_document(symbol, names, book, editor):
            places.setdefault((place.uri, place.start), place)
    declared = uri_of(symbol.span.source.name)
    return sorted(
        places.values(),
        key=lambda name_place: (name_place.uri != declared, name_place.uri, name_place.start),
    )


def books_with(
    symbol: NamedSymbol, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[DocumentNames]:
    """The sources that contain a name, among the workspace's files and those the document reads.

    A variable occurs where its rule does, which another book may override.
    """
    yield names
    name = symbol.name if symbol.kind != "variable" else _owner(symbol, names)
    if not name:
        return
    word = re.compile(rf"(?<!\w){re.escape(name)}(?![^\W_])")
    chain = (*names.chain.books[:-1], *names.chain.vocabularies)
    read = [uri_of(file.span.source.name) for file in chain]
    for uri in dict.fromkeys((*editor.sources(), *read)):
        document = editor.document(uri)
        if document is None or document.name == names.checked.name:
            continue
        if not word.search(document.text):
            continue
        try:
            other = names_in_document(editor.check(document))
        except RulecError:
            continue
        if other is not None:
            yield other


def _owner(variable: NamedSymbol, names: DocumentNames) -> str:
    """The rule that a variable belongs to; empty for a definition's variable."""
    for item in (item for book in names.chain.books for item in book.items):
        span = item.span
        here = span.source is variable.span.source and span.start <= variable.span.start < span.end
        if here and isinstance(item, tree.RuleItem):
            return item.name.text
    return ""


def _in_document(
    symbol: NamedSymbol, origin: DocumentNames, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[NamePlace]:
    uri = uri_of(names.checked.path or names.checked.name)
    positions = editor.positions(names.checked.text)
    for occurrence in names.all():
        if names.is_same(occurrence.symbol, symbol, origin):
            start, end = names.bounds(occurrence.span)
            location = lsp.Location(uri, positions.range(start, end))
            yield NamePlace(
                uri, start, end, location, declares=occurrence.declares, listed=occurrence.listed
            )

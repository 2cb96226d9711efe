"""The names of a checked document, and their positions in its text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rulec.diagnostics import Span
from rulec.language_server.names.name_occurrences import (
    NamedSymbol,
    NamesOfChain,
    Occurrence,
    occurrences,
)
from rulec.language_server.workspace.editor_workspace import CheckedDocument
from rulec.syntax import tree


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
        if span.source is self.checked.parsed.source:
            start = self.checked.parsed.offset(span.start)
            return start, start + span.end - span.start
        return span.start, span.end

    def text_of(self, span: Span) -> str:
        """The text of the file that a span is in."""
        own = span.source is self.checked.parsed.source
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


def names_in_document(checked: CheckedDocument) -> DocumentNames | None:
    """The names of a document; None if it could not be parsed at all."""
    resolved = checked.resolved
    if resolved is None:
        return None
    trees = resolved.trees
    return DocumentNames(checked, NamesOfChain(resolved.names, trees.books, trees.vocabularies))


def item_at(names: DocumentNames, offset: int) -> tree.Item | None:
    """The item of the document that contains a character."""
    for item in names.file.items:
        start, end = names.bounds(item.span)
        if start <= offset <= end:
            return item
    return None

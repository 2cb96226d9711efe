"""Where a thing is declared and used, in all rulebooks and vocabularies of the workspace."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from lsprotocol import types as lsp

from rulec.diagnostics import RulecError
from rulec.language_server.document_names import DocumentNames, names_in_document
from rulec.language_server.editor_workspace import EditorWorkspace, uri_of
from rulec.language_server.name_occurrences import NamedThing


@dataclass(frozen=True, slots=True)
class NamePlace:
    """A name in some file, by characters of its text."""

    uri: str
    start: int
    end: int
    location: lsp.Location
    declares: bool


def declaration_of(
    names: DocumentNames, thing: NamedThing, editor: EditorWorkspace
) -> lsp.Location:
    """Where a thing is declared."""
    positions = editor.positions(names.text_of(thing.span))
    return lsp.Location(uri_of(thing.span.source.name), positions.range(*names.bounds(thing.span)))


def references_to(
    thing: NamedThing, names: DocumentNames, editor: EditorWorkspace
) -> list[NamePlace]:
    """All places of a thing's name; of a variable those in its own document."""
    if thing.kind == "variable":
        return list(_in_document(thing, names, editor))
    found: dict[tuple[str, int], NamePlace] = {}
    for book in books_with(thing, names, editor):
        for place in _in_document(thing, book, editor):
            found.setdefault((place.uri, place.start), place)
    declared = uri_of(thing.span.source.name)
    return sorted(found.values(), key=lambda one: (one.uri != declared, one.uri, one.start))


def books_with(
    thing: NamedThing, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[DocumentNames]:
    """The workspace's sources in which a name stands, and the files that the document reads."""
    yield names
    word = re.compile(rf"(?<!\w){re.escape(thing.name)}(?![^\W_])")
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


def _in_document(
    thing: NamedThing, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[NamePlace]:
    uri = uri_of(names.checked.path or names.checked.name)
    positions = editor.positions(names.checked.text)
    for one in names.all():
        if one.thing.is_same(thing):
            start, end = names.bounds(one.span)
            location = lsp.Location(uri, positions.range(start, end))
            yield NamePlace(uri, start, end, location, one.declares)

"""Finds a symbol in all rulebooks of the workspace, and renames it or explains why it cannot."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from lsprotocol import types as lsp

from rulec.diagnostics import Diagnostic, RulecError
from rulec.language_server.names.name_occurrences import (
    DocumentNames,
    NamedSymbol,
    names_in_document,
)
from rulec.language_server.workspace.editor_workspace import (
    CheckedDocument,
    Document,
    EditorWorkspace,
    path_of,
    uri_of,
)
from rulec.rulebook.rulebook_model import Rule
from rulec.syntax import tree
from rulec.syntax.keywords import RESERVED

_NAME = re.compile(r"[^\W\d]\w*")
_WORDS = ("type", "signal", "quantity", "enumeration", "value", "variable")
"""Kinds of names that still occur in formulas after resolution."""


class RefusedRenamingError(Exception):
    """The reason why a symbol cannot be renamed, worded for the author."""


@dataclass(frozen=True, slots=True)
class TextChange:
    """The replacement of characters ``start`` to ``end`` of a document by ``text``."""

    start: int
    end: int
    text: str


Changes = Mapping[str, Sequence[TextChange]]
"""Maps the address of a document to the changes of its text, in order."""


def renamed(
    symbol: NamedSymbol, name: str, names: DocumentNames, editor: EditorWorkspace
) -> Changes:
    """The changes that rename a symbol. Raises RefusedRenamingError.

    Every rulebook that changes, or that contains the new name, is checked with the changes: it must
    have the same findings and the same rules, apart from the name.
    """
    refuse_in_general(symbol, editor)
    if name == symbol.name:
        return {}
    if not _NAME.fullmatch(name):
        raise RefusedRenamingError(
            f"`{name}` is not a name: letters, digits and `_`, no digit first"
        )
    if name in RESERVED:
        raise RefusedRenamingError(f"`{name}` is a word of the language")
    changes: dict[str, list[TextChange]] = {}
    for place in references_to(symbol, names, editor):
        if place.listed:
            continue
        changes.setdefault(place.uri, []).append(TextChange(place.start, place.end, name))
    if symbol.kind == "rule":
        for uri, change in _in_topics(symbol, name, names, editor):
            changes.setdefault(uri, []).append(change)
    for uri, parts in changes.items():
        parts.sort(key=lambda change: change.start)
        path = path_of(uri)
        if path is not None and editor.is_read_only(path):
            raise RefusedRenamingError(f"`{symbol.name}` occurs in {path}, {_NOT_YOURS}")
    _refuse_other_meaning(changes, symbol, name, names, editor)
    return changes


_NOT_YOURS = "which is outside of the editor's folders and is not changed"


def refuse_in_general(symbol: NamedSymbol, editor: EditorWorkspace) -> None:
    """Raise RefusedRenamingError if a symbol cannot be renamed, whatever its new name."""
    if symbol.kind == "file":
        raise RefusedRenamingError(
            f"`{symbol.name}` is the name of its file: rename that, and the name after `rulebook`"
        )
    declared = symbol.span.source.name
    if path_of(uri_of(declared)) is not None and editor.is_read_only(declared):
        raise RefusedRenamingError(f"`{symbol.name}` is declared in {declared}, {_NOT_YOURS}")


def changed_text(text: str, changes: Sequence[TextChange]) -> str:
    """A text with non-overlapping changes applied."""
    parts: list[str] = []
    at = 0
    for change in changes:
        parts += (text[at : change.start], change.text)
        at = change.end
    return "".join((*parts, text[at:]))


def _in_topics(
    symbol: NamedSymbol, name: str, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[tuple[str, TextChange]]:
    """Changes in topics, which list rules, also those of extending books, by name prefix."""
    heads = re.compile(r"\brule\s+([^\W\d]\w*)")
    texts = [
        document.text for document in map(editor.document, editor.sources()) if document is not None
    ]
    others = Counter(match[1] for text in texts for match in heads.finditer(text))
    others[symbol.name] -= sum(
        1
        for book in books_with(symbol, names, editor)
        for occurrence in book.all()
        if occurrence.symbol.is_same(symbol) and not occurrence.listed
        if _heads_a_rule(book, occurrence.span.start, occurrence.span.end)
    )
    done: set[tuple[str, int]] = set()
    for book in books_with(symbol, names, editor):
        longest = _longest_listed(symbol.name, book)
        for file in book.chain.books:
            uri = uri_of(file.span.source.name)
            path = path_of(uri)
            if path is not None and editor.is_read_only(path):
                continue
            for entry in _topic_entries(file):
                if not any(rule.text == longest for rule in entry.rules):
                    continue
                change = _in_topic(entry, symbol.name, name, others)
                if change is not None and (uri, change.start) not in done:
                    done.add((uri, change.start))
                    yield uri, change


def _heads_a_rule(book: DocumentNames, start: int, end: int) -> bool:
    before = book.checked.source.text[:start].rstrip()
    return end > start and before.endswith("rule")


def _topic_entries(file: tree.File) -> Iterator[tree.TopicEntry]:
    for item in file.items:
        if isinstance(item, tree.TopicsItem):
            yield from item.entries


def _longest_listed(rule: str, book: DocumentNames) -> str:
    """The longest prefix of a rule's name that a topic lists; it alone determines its topics."""
    files = book.chain.books
    entries = (entry for file in files for entry in _topic_entries(file))
    listed = (name.text for entry in entries for name in entry.rules)
    return max((name for name in listed if f"{rule}_".startswith(f"{name}_")), key=len, default="")


def _in_topic(
    entry: tree.TopicEntry, old: str, new: str, others: Mapping[str, int]
) -> TextChange | None:
    """The change of a topic's rules: the name is replaced, or appended."""

    def is_of(rule: str, listed: tree.Name) -> bool:
        return f"{rule}_".startswith(f"{listed.text}_")

    listed = [name for name in entry.rules if is_of(old, name)]
    if not listed or any(is_of(new, name) for name in entry.rules):
        return None
    longest = max(listed, key=lambda name: len(name.text))
    start, end = longest.span.start, longest.span.end
    still = any(count > 0 and is_of(rule, longest) for rule, count in others.items())
    if longest.text == old and not still:
        return TextChange(start, end, new)
    return TextChange(end, end, f", {new}")


def _refuse_other_meaning(
    changes: Changes, symbol: NamedSymbol, name: str, names: DocumentNames, editor: EditorWorkspace
) -> None:
    """Raise RefusedRenamingError unless all books keep their meaning."""
    trial = EditorWorkspace(editor.folders, editor.encoding)
    for uri, shown in editor.documents.items():
        trial.documents[uri] = Document(uri, shown.text, shown.version)
    before: dict[str, CheckedDocument] = {}
    for uri in _affected(changes, symbol, name, names, editor):
        document = editor.document(uri)
        assert document is not None, "it has been read before"
        before[uri] = _checked(editor, document)
        text = changed_text(document.text, changes.get(uri, ()))
        trial.documents[uri] = Document(uri, text)
    for uri, was in before.items():
        now = _checked(trial, trial.documents[uri])
        file = was.path or was.name
        if any(diagnostic.severity == "error" for diagnostic in was.findings):
            raise RefusedRenamingError(f"{file} has mistakes: fix them first")
        new = _first_new(was.findings, now.findings)
        if new is not None:
            raise RefusedRenamingError(f"with `{name}` there would be a mistake: {new.message}")
        if symbol.kind not in _WORDS and _meaning(was, symbol, name) != _meaning(now, symbol, name):
            raise RefusedRenamingError(
                f"with `{name}` the rules in {file} would change their meaning"
            )


def _affected(
    changes: Changes, symbol: NamedSymbol, name: str, names: DocumentNames, editor: EditorWorkspace
) -> list[str]:
    """The documents that change, and all that use the symbol's file and contain either name."""
    uris = dict.fromkeys(changes)
    declared = os.path.realpath(symbol.span.source.name)
    for named_symbol in (symbol, replace(symbol, name=name)):
        for other in books_with(named_symbol, names, editor):
            files = (*other.chain.books, *other.chain.vocabularies)
            if any(os.path.realpath(file.span.source.name) == declared for file in files):
                uris[uri_of(other.checked.path or other.checked.name)] = None
    return list(uris)


def _checked(editor: EditorWorkspace, document: Document) -> CheckedDocument:
    try:
        return editor.check(document)
    except RulecError as error:
        raise RefusedRenamingError(error.diagnostics[0].message) from error


def _first_new(before: Sequence[Diagnostic], after: Sequence[Diagnostic]) -> Diagnostic | None:
    known = Counter(diagnostic.code for diagnostic in before)
    for diagnostic in after:
        known[diagnostic.code] -= 1
        if known[diagnostic.code] < 0:
            return diagnostic
    return None


def _meaning(
    checked: CheckedDocument, symbol: NamedSymbol, name: str
) -> tuple[dict[str, Rule], object] | None:
    """The rules and their order, with the old name replaced by the new one."""
    book = checked.resolved.rulebook
    if book is None:
        return None

    def called(text: str, kind: str) -> str:
        return name if kind == symbol.kind and text == symbol.name else text

    rules = {
        called(rule.name, "rule"): replace(
            rule,
            name=called(rule.name, "rule"),
            level=called(rule.level, "level"),
            topics=tuple(called(topic, "topic") for topic in rule.topics),
        )
        for rule in book.rules
    }
    order = {(called(high, "level"), called(low, "level")) for high, low in book.priorities}
    return rules, (order, book.axioms, book.vocabulary.declarations)


def workspace_edit(changes: Changes, editor: EditorWorkspace) -> lsp.WorkspaceEdit:
    """The changes in the form that editors expect."""
    edits: dict[str, list[lsp.TextEdit]] = {}
    for uri, parts in changes.items():
        document = editor.document(uri)
        positions = editor.positions(document.text if document else "")
        edits[uri] = [
            lsp.TextEdit(positions.range(change.start, change.end), change.text) for change in parts
        ]
    return lsp.WorkspaceEdit(changes=edits)


def placeholder(
    names: DocumentNames, offset: int, editor: EditorWorkspace
) -> tuple[NamedSymbol, int, int]:
    """The symbol to be renamed at a character, and its bounds. Raises RefusedRenamingError."""
    occurrence = names.at(offset)
    if occurrence is None:
        raise RefusedRenamingError("there is no name here to rename")
    refuse_in_general(occurrence.symbol, editor)
    return occurrence.symbol, occurrence.span.start, occurrence.span.end


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
    return lsp.Location(uri_of(span.source.name), positions.of(span))


def references_to(
    symbol: NamedSymbol, names: DocumentNames, editor: EditorWorkspace
) -> list[NamePlace]:
    """All places of a symbol's name."""
    places: dict[tuple[str, int], NamePlace] = {}
    for book in books_with(symbol, names, editor):
        for place in _in_document(symbol, book, editor):
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
        with suppress(RulecError):
            yield names_in_document(editor.check(document))


def _owner(variable: NamedSymbol, names: DocumentNames) -> str:
    """The rule that a variable belongs to; empty for a definition's variable."""
    for item in (item for book in names.chain.books for item in book.items):
        span = item.span
        here = span.source is variable.span.source and span.start <= variable.span.start < span.end
        if here and isinstance(item, tree.RuleItem):
            return item.name.text
    return ""


def _in_document(
    symbol: NamedSymbol, names: DocumentNames, editor: EditorWorkspace
) -> Iterator[NamePlace]:
    uri = uri_of(names.checked.path or names.checked.name)
    positions = editor.positions(names.checked.text)
    for occurrence in names.all():
        if occurrence.symbol.is_same(symbol):
            span = occurrence.span
            location = lsp.Location(uri, positions.of(span))
            marks = occurrence.declares, occurrence.listed
            yield NamePlace(uri, span.start, span.end, location, *marks)

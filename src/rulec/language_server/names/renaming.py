"""Finds a symbol in all rulebooks of the workspace, and renames it or explains why it cannot."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from lsprotocol import types as lsp

from rulec.diagnostics import Diagnostic, RulecError
from rulec.language_server.names.name_occurrences import (
    DocumentNames,
    NamedSymbol,
    Occurrence,
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
    for location, occurrence in references_to(symbol, names, editor):
        if not occurrence.listed:
            start, end = occurrence.span.start, occurrence.span.end
            changes.setdefault(location.uri, []).append(TextChange(start, end, name))
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
        entries = [
            node
            for file in book.chain.books
            for node in tree.nodes_in(file)
            if isinstance(node, tree.TopicEntry)
        ]
        longest = _longest_listed(symbol.name, entries)
        for entry in entries:
            uri = uri_of(entry.span.source.name)
            path = path_of(uri)
            if path is not None and editor.is_read_only(path):
                continue
            if not any(rule.text == longest for rule in entry.rules):
                continue
            change = _in_topic(entry, symbol.name, name, others)
            if change is not None and (uri, change.start) not in done:
                done.add((uri, change.start))
                yield uri, change


def _heads_a_rule(book: DocumentNames, start: int, end: int) -> bool:
    before = book.checked.source.text[:start].rstrip()
    return end > start and before.endswith("rule")


def _longest_listed(rule: str, entries: Iterable[tree.TopicEntry]) -> str:
    """The longest prefix of a rule's name that a topic lists; it alone determines its topics."""
    listed = (name.text for entry in entries for name in entry.rules)
    return max((name for name in listed if _is_of(rule, name)), key=len, default="")


def _is_of(rule: str, listed: str) -> bool:
    return f"{rule}_".startswith(f"{listed}_")


def _in_topic(
    entry: tree.TopicEntry, old: str, new: str, others: Mapping[str, int]
) -> TextChange | None:
    """The change of a topic's rules: the name is replaced, or appended."""
    listed = [name for name in entry.rules if _is_of(old, name.text)]
    if not listed or any(_is_of(new, name.text) for name in entry.rules):
        return None
    longest = max(listed, key=lambda name: len(name.text))
    start, end = longest.span.start, longest.span.end
    still = any(count > 0 and _is_of(rule, longest.text) for rule, count in others.items())
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
    documents = ((uri, editor.document(uri), parts) for uri, parts in changes.items())
    return lsp.WorkspaceEdit(
        changes={
            uri: text_edits(parts, document.text if document else "", editor)
            for uri, document, parts in documents
        }
    )


def text_edits(
    changes: Iterable[TextChange], text: str, editor: EditorWorkspace
) -> list[lsp.TextEdit]:
    """The changes of a text in the form that editors expect."""
    positions = editor.positions(text)
    return [lsp.TextEdit(positions.range(each.start, each.end), each.text) for each in changes]


def to_rename(names: DocumentNames, offset: int, editor: EditorWorkspace) -> Occurrence:
    """The name at a character, which can be renamed. Raises RefusedRenamingError."""
    occurrence = names.at(offset)
    if occurrence is None:
        raise RefusedRenamingError("there is no name here to rename")
    refuse_in_general(occurrence.symbol, editor)
    return occurrence


def declaration_of(
    names: DocumentNames, symbol: NamedSymbol, editor: EditorWorkspace
) -> lsp.Location:
    """Where a symbol is declared."""
    span = symbol.span
    positions = editor.positions(names.text_of(span))
    return lsp.Location(uri_of(span.source.name), positions.of(span))


def references_to(
    symbol: NamedSymbol, names: DocumentNames, editor: EditorWorkspace
) -> list[tuple[lsp.Location, Occurrence]]:
    """All places of a symbol's name."""
    places: dict[tuple[str, int], tuple[lsp.Location, Occurrence]] = {}
    for book in books_with(symbol, names, editor):
        uri = uri_of(book.checked.path or book.checked.name)
        positions = editor.positions(book.checked.text)
        for occurrence in book.all():
            if occurrence.symbol.is_same(symbol):
                location = lsp.Location(uri, positions.of(occurrence.span))
                places.setdefault((uri, occurrence.span.start), (location, occurrence))
    declared = uri_of(symbol.span.source.name)
    return [places[place] for place in sorted(places, key=lambda at: (at[0] != declared, at))]


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
    rules = (item for item in names.chain.items_at(variable) if isinstance(item, tree.RuleItem))
    return next((rule.name.text for rule in rules), "")

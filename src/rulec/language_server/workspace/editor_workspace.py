"""The folders and documents of an editor; each document is checked while it is typed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from lsprotocol import types as lsp
from pygls import uris

from rulec.cancellation import step
from rulec.diagnostics import Diagnostic, RulecError, Source
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.resources import rulebooks_folder
from rulec.rulebook.files.open_documents import shown
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.files.source_walk import sources_below
from rulec.rulebook.loader import (
    ResolvedTrees,
    RulebookFile,
    Trees,
    resolved,
    trees_of,
    vocabulary_findings,
)
from rulec.rulebook.overlay.rulebook_overlay import RuleEntry
from rulec.rulebook.resolve import (
    BookNames,
    TranslatedRule,
    names_of,
    translated,
)
from rulec.settings import search_path
from rulec.syntax import decode, parse


@dataclass(frozen=True, slots=True)
class CheckedDocument:
    """A document with its parse result; findings refer to places in its text.

    ``text`` is that of the document, of which ``source`` may lack rules.
    """

    name: str
    path: Path | None
    text: str
    source: Source
    resolved: ResolvedTrees
    findings: tuple[Diagnostic, ...]


@dataclass(slots=True)
class Document:
    """A source that is open in the editor, or one of the workspace's files."""

    uri: str
    text: str
    version: int | None = None
    checked: CheckedDocument | None = None
    """The result of the last check, as long as no document has changed since."""

    @property
    def path(self) -> Path | None:
        """Its file, which may not exist yet; None for a document without one."""
        return path_of(self.uri)

    @property
    def name(self) -> str:
        """Its name in messages."""
        # An address may contain a lone surrogate, which no path lookup accepts.
        return str(self.path or self.uri.encode("utf-8", "backslashreplace").decode())


def path_of(uri: str) -> Path | None:
    """The file of an address; None if it has none."""
    if not uri.startswith("file:"):
        return None
    try:
        path = uris.to_fs_path(uri) or ""
        os.fsencode(path)
    except ValueError:  # an invalid address, or one with a lone surrogate
        return None
    return Path(path) if path and "\0" not in path else None


def uri_of(file: str | Path) -> str:
    """The address of a file, or of a document without a file that has this name."""
    text = str(file)
    if "://" in text or text.startswith("untitled:"):
        return text
    return uris.from_fs_path(os.path.abspath(text)) or text  # noqa: PTH100 - keeps what links say


@dataclass(slots=True)
class EditorWorkspace:
    """The documents open in an editor; they replace the files with the same paths."""

    folders: tuple[Path, ...] = ()
    encoding: lsp.PositionEncodingKind | str = lsp.PositionEncodingKind.Utf16
    documents: dict[str, Document] = field(default_factory=dict)
    _files: dict[str, Document] = field(default_factory=dict)
    _positions: TextPositions | None = None

    def open(self, uri: str, text: str, version: int | None = None) -> Document:
        """Open a document, or replace the text of an open one."""
        # As for files: a line ends in a single character, which no column counts.
        text = text.replace("\r\n", "\n").replace("\r", "\n")
        known = self.documents.get(uri)
        if known is None:
            known = self.documents[uri] = self._files.pop(uri, Document(uri, text))
        known.text, known.version = text, version
        self.forget_checks()
        return known

    def close(self, uri: str) -> None:
        """Forget a document; its file is used again."""
        self.documents.pop(uri, None)
        self.forget_checks()

    def forget_checks(self) -> None:
        """Something has changed that any document may depend on."""
        for document in (*self.documents.values(), *self._files.values()):
            document.checked = None

    def document(self, uri: str) -> Document | None:
        """A document that is open, or a file that can be read."""
        known = self.documents.get(uri)
        if known is not None:
            return known
        path = path_of(uri)
        if path is None:
            return None
        try:
            text = decode(str(path), read_bytes(path)).text
        except RulecError:
            return None
        file = self._files.setdefault(uri, Document(uri, text))
        file.text = text
        return file

    @contextmanager
    def as_shown(self) -> Iterator[None]:
        """Read files as they are in the editor."""
        texts = {
            os.path.realpath(document.path): document.text.encode("utf-8", "surrogatepass")
            for document in list(self.documents.values())
            if document.path is not None
        }
        with shown(texts):
            yield

    def check(self, document: Document) -> CheckedDocument:
        """Check a document. The findings are those of ``rulec check``.

        Raises RulecError for wrong settings.
        """
        with self.as_shown():
            resolved = self._resolved(document)
        source = resolved.trees.books[-1].span.source
        document.checked = CheckedDocument(
            document.name,
            document.path,
            document.text,
            source,
            resolved=resolved,
            findings=resolved.findings,
        )
        return document.checked

    def _resolved(self, document: Document) -> ResolvedTrees:
        path, source = document.path, Source(document.name, document.text)
        file, mistakes = parse(source)
        folders = search_path(None if path is None else path.parent)
        if file.kind == "vocabulary":
            trees = Trees(
                document.name, (file,), vocabularies=(), sources=(), mistakes=(), dependencies=()
            )
            findings = vocabulary_findings(file, document.name, mistakes)
            return ResolvedTrees(trees, names_of((file,), at=""), None, findings)
        data = document.text.encode("utf-8", "surrogatepass")
        book = RulebookFile(source, data, path, folders)
        return resolved(trees_of(book, file, mistakes), translate=_translated)

    def positions(self, text: str) -> TextPositions:
        """The positions of a text as this editor counts them."""
        if self._positions is None or self._positions.text is not text:
            self._positions = TextPositions(text, self.encoding)
        return self._positions

    def sources(self) -> list[str]:
        """The addresses of all sources in the workspace's folders, and of open documents."""
        addresses = dict.fromkeys(self.documents)
        known = {os.path.realpath(entry.path) for entry in self.documents.values() if entry.path}
        for folder in self.folders:
            for path in sources_below(str(folder)).paths:
                real = os.path.realpath(path)
                if real not in known:
                    known.add(real)
                    addresses[uri_of(path)] = None
        return list(addresses)

    def is_read_only(self, file: str | Path) -> bool:
        """Whether a file should not be changed: outside of the workspace, or rulec's own."""
        path = Path(os.path.realpath(file))
        if any(path == Path(os.path.realpath(open_path)) for open_path in self._open_paths()):
            return path.is_relative_to(os.path.realpath(rulebooks_folder())) and not any(
                path.is_relative_to(os.path.realpath(folder)) for folder in self.folders
            )
        return not any(path.is_relative_to(os.path.realpath(folder)) for folder in self.folders)

    def _open_paths(self) -> Iterable[Path]:
        return [entry.path for entry in self.documents.values() if entry.path is not None]


def _translated(entry: RuleEntry, names: BookNames, confirmed: bool) -> TranslatedRule:
    step()
    return translated(entry, names, confirmed)

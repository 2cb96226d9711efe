"""The folders and documents of an editor; each document is checked while it is typed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from lsprotocol import types as lsp
from pygls import uris

from rulec.diagnostics import Diagnostic, RulecError, Source
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.resources import rulebooks_folder
from rulec.rulebook.allowances import judged_allowances
from rulec.rulebook.files.open_documents import shown
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.files.source_walk import sources_below
from rulec.rulebook.loader import RulebookFile, Trees, in_order, reported, trees_of
from rulec.rulebook.resolution_memory import ResolutionMemory, ResolvedTrees
from rulec.rulebook.resolve import names_of, resolve_vocabulary
from rulec.settings import search_path
from rulec.syntax import decode
from rulec.syntax.incremental.parsed_text import ParsedText, parsed_text, renewed
from rulec.vocabulary.pint_units import pint_unit


@dataclass(frozen=True, slots=True)
class CheckedDocument:
    """A document with its parse result; findings refer to places in its text.

    ``resolved`` has its trees and names; None if the text could not be parsed at all.
    """

    name: str
    path: Path | None
    parsed: ParsedText
    resolved: ResolvedTrees | None
    findings: tuple[Diagnostic, ...]

    @property
    def text(self) -> str:
        """The text that was checked."""
        return self.parsed.text


@dataclass(slots=True)
class Document:
    """A source that is open in the editor, or one of the workspace's files."""

    uri: str
    text: str
    version: int | None = None
    parsed: ParsedText | None = None
    memory: ResolutionMemory = field(default_factory=ResolutionMemory)
    checked: CheckedDocument | None = None
    """The result of the last check of a large document."""

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
        known.text, known.version, known.checked = text, version, None
        return known

    def close(self, uri: str) -> None:
        """Forget a document; its file is used again."""
        self.documents.pop(uri, None)

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
        """Check a document; only its edited parts are parsed again.

        The findings are those of ``rulec check``. Raises RulecError for wrong settings.
        """
        path, name = document.path, document.name
        source = Source(name, document.text)
        document.parsed = parsed = parsed_text(source, document.parsed)
        with self.as_shown():
            folders = search_path(None if path is None else path.parent)
            if parsed.file.kind == "vocabulary":
                return _checked_vocabulary(name, path, parsed)
            data = document.text.encode("utf-8", "surrogatepass")
            try:
                trees = trees_of(RulebookFile(source, data, path, folders), parsed.file, ())
            except RulecError as error:
                return CheckedDocument(name, path, parsed, None, error.diagnostics)
            resolved = document.memory.resolved(trees)
        diagnostics = [*parsed.mistakes, *map(parsed.in_text, resolved.findings)]
        findings = reported(trees, diagnostics, source, parsed.placed)
        return CheckedDocument(name, path, parsed, resolved, findings)

    def rest(self) -> None:
        """Do work in a pause that would slow down a later keystroke."""
        # Pint takes 0.5 s to import, on the first unknown unit.
        pint_unit("")
        for document in list(self.documents.values()):
            parsed = document.parsed and renewed(document.parsed)
            if parsed is not document.parsed:
                document.parsed = parsed
                with suppress(RulecError):
                    self.check(document)

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


def _checked_vocabulary(name: str, path: Path | None, parsed: ParsedText) -> CheckedDocument:
    _, meanings = resolve_vocabulary(parsed.file)
    trees = Trees(name, (parsed.file,), vocabularies=(), sources=(), mistakes=(), dependencies=())
    diagnostics = judged_allowances([*parsed.mistakes, *meanings], Source(name, parsed.text))
    findings = in_order(name, diagnostics)
    names = names_of((parsed.file,), at="")
    return CheckedDocument(name, path, parsed, ResolvedTrees(trees, names, None, ()), findings)

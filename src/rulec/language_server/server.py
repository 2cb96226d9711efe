"""The server: what an editor sends, and which function answers."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types as lsp
from pygls.lsp.server import LanguageServer

from rulec.diagnostics import Diagnostic, RulecError, Source
from rulec.language_server import published_diagnostics as published
from rulec.language_server.document_names import DocumentNames, names_in_document
from rulec.language_server.document_outline import folds, outline
from rulec.language_server.editor_workspace import (
    CheckedDocument,
    Document,
    EditorWorkspace,
    path_of,
)
from rulec.language_server.hover_texts import hover_text
from rulec.language_server.name_places import declaration_of, references_to
from rulec.language_server.text_positions import TextPositions
from rulec.syntax.formatting import format_source
from rulec.version import __version__

_IDLE_S = 0.3
"""So long after the last edit the other open documents are checked, which may depend on it."""


class RulecServer(LanguageServer):
    """One editor's server."""

    def __init__(self) -> None:
        super().__init__("rulec", __version__, lsp.TextDocumentSyncKind.Full)
        self.editor = EditorWorkspace()
        self.found: dict[str, dict[str, list[Diagnostic]]] = {}
        self.waiting: asyncio.TimerHandle | None = None

    def check(self, document: Document) -> CheckedDocument | None:
        """Check a document and publish what is found, in whatever file."""
        uri = document.uri
        try:
            checked = self.editor.check(document)
            findings: Iterable[Diagnostic] = checked.findings
        except RulecError as error:  # the project's settings
            checked, findings = None, error.diagnostics
        before = self.found.get(uri, {})
        self.found[uri] = published.by_file(findings, uri)
        for file in dict.fromkeys((uri, *before, *self.found[uri])):
            self.publish(file)
        return checked

    def publish(self, uri: str) -> None:
        """Send everything that has been found in a file."""
        document = self.editor.document(uri)
        found = published.union(self.found, uri)
        self.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(
                uri,
                published.diagnostics_of(found, document.text if document else "", self.editor),
                self.editor.documents[uri].version if uri in self.editor.documents else None,
            )
        )

    def check_others(self, uri: str) -> None:
        """Check what is open besides a document, now that nobody types."""
        for document in list(self.editor.documents.values()):
            if document.uri != uri:
                self.check(document)

    def check_others_later(self, uri: str) -> None:
        """Check what is open besides a document, once nobody types any more."""
        if self.waiting is not None:
            self.waiting.cancel()
        loop = asyncio.get_running_loop()
        self.waiting = loop.call_later(_IDLE_S, self.check_others, uri)

    def names(self, uri: str) -> tuple[DocumentNames, TextPositions] | None:
        """The names of a document, and the positions of its text."""
        document = self.editor.document(uri)
        if document is None:
            return None
        try:
            names = names_in_document(self.editor.check(document))
        except RulecError:
            return None
        return None if names is None else (names, self.editor.positions(document.text))


def language_server() -> RulecServer:
    """A server with all that it can do."""
    server = RulecServer()
    _documents(server)
    _names(server)
    _layout(server)
    return server


def _documents(server: RulecServer) -> None:
    @server.feature(lsp.INITIALIZED)
    def initialized(_: lsp.InitializedParams) -> None:
        folders = [path_of(folder.uri) for folder in server.workspace.folders.values()]
        root = path_of(server.workspace.root_uri or "")
        own: list[Path] = [folder for folder in folders if folder is not None]
        server.editor.folders = tuple(own or ([root] if root is not None else []))
        encoding = server.workspace.position_encoding
        server.editor.encoding = encoding or lsp.PositionEncodingKind.Utf16

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS)
    def folders_changed(params: lsp.DidChangeWorkspaceFoldersParams) -> None:
        gone = {path_of(folder.uri) for folder in params.event.removed}
        kept = [folder for folder in server.editor.folders if folder not in gone]
        added = [path_of(folder.uri) for folder in params.event.added]
        server.editor.folders = (*kept, *(folder for folder in added if folder is not None))

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: lsp.DidOpenTextDocumentParams) -> None:
        document = params.text_document
        server.check(server.editor.open(document.uri, document.text, document.version))
        server.check_others_later(document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: lsp.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        text = server.workspace.get_text_document(uri).source
        server.check(server.editor.open(uri, text, params.text_document.version))
        server.check_others_later(uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: lsp.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.editor.close(uri)
        for file in dict.fromkeys((uri, *server.found.pop(uri, {}))):
            server.publish(file)
        server.check_others_later(uri)

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def files_changed(_: lsp.DidChangeWatchedFilesParams) -> None:
        server.check_others("")


def _names(server: RulecServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hover(params: lsp.HoverParams) -> lsp.Hover | None:
        known = server.names(params.text_document.uri)
        if known is None:
            return None
        names, positions = known
        one = names.at(positions.offset(params.position))
        if one is None:
            return None
        text = lsp.MarkupContent(lsp.MarkupKind.Markdown, hover_text(names, one))
        return lsp.Hover(text, positions.range(*names.bounds(one.span)))

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def definition(params: lsp.DefinitionParams) -> lsp.Location | None:
        known = server.names(params.text_document.uri)
        if known is None:
            return None
        names, positions = known
        one = names.at(positions.offset(params.position))
        return None if one is None else declaration_of(names, one.thing, server.editor)

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def references(params: lsp.ReferenceParams) -> list[lsp.Location]:
        known = server.names(params.text_document.uri)
        if known is None:
            return []
        names, positions = known
        one = names.at(positions.offset(params.position))
        if one is None:
            return []
        return [
            place.location
            for place in references_to(one.thing, names, server.editor)
            if params.context.include_declaration or not place.declares
        ]


def _layout(server: RulecServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def symbols(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        known = server.names(params.text_document.uri)
        return [] if known is None else outline(*known)

    @server.feature(lsp.TEXT_DOCUMENT_FOLDING_RANGE)
    def folding(params: lsp.FoldingRangeParams) -> list[lsp.FoldingRange]:
        known = server.names(params.text_document.uri)
        return [] if known is None else folds(*known)

    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def formatting(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        document = server.editor.document(params.text_document.uri)
        if document is None:
            return []
        try:
            text = format_source(Source(document.name, document.text))
        except RulecError:  # it has mistakes of spelling, which are shown already
            return []
        if text == document.text:
            return []
        return [lsp.TextEdit(server.editor.positions(document.text).whole(), text)]


def serve() -> None:
    """Serve one editor over standard input and output, until it says to exit."""
    language_server().start_io()

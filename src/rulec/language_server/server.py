"""The server: maps each request of an editor to the function that answers it."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams

from rulec.diagnostics import RulecError, Source
from rulec.language_server.document_outline import folds, outline
from rulec.language_server.editor_session import EditorSession, collect_in_pauses
from rulec.language_server.lenses import code_lenses as lenses
from rulec.language_server.lenses.code_lenses import (
    ExampleAnswer,
    code_lenses,
    english,
    example_answer,
    parent_answer,
)
from rulec.language_server.lenses.inlay_hints import inlay_hints
from rulec.language_server.names.hover_texts import hover_text
from rulec.language_server.names.name_occurrences import DocumentNames
from rulec.language_server.names.renaming import (
    RefusedRenamingError,
    declaration_of,
    references_to,
    renamed,
    to_rename,
    workspace_edit,
)
from rulec.language_server.workspace.editor_workspace import path_of
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.language_server.writing.quick_fixes import code_action, quick_fixes
from rulec.language_server.writing.word_completion import completions, signature
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.syntax.formatting import format_source


def language_server() -> EditorSession:
    """A server with all its features."""
    server = EditorSession()
    _documents(server)
    _names(server)
    _writing(server)
    _layout(server)
    add_commands(server)
    return server


def _documents(server: EditorSession) -> None:
    @server.feature(lsp.INITIALIZED)
    def initialized(_: lsp.InitializedParams) -> None:
        folders = [path_of(folder.uri) for folder in server.workspace.folders.values()]
        root = path_of(server.workspace.root_uri or "")
        own: list[Path] = [folder for folder in folders if folder is not None]
        server.editor.folders = tuple(own or ([root] if root is not None else []))
        encoding = server.workspace.position_encoding
        server.editor.encoding = encoding or lsp.PositionEncodingKind.Utf16

    @server.feature(lsp.EXIT)
    def exiting(*_: object) -> None:
        server.status = 0 if server.protocol._shutdown else 1

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
        server.give_up(uri)
        server.editor.close(uri)
        for file in dict.fromkeys((uri, *server.findings.pop(uri, {}))):
            server.publish(file)
        server.check_others_later(uri)

    @server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def files_changed(_: lsp.DidChangeWatchedFilesParams) -> None:
        server.editor.forget_checks()
        server.check_others("")


def _asked(
    server: EditorSession,
    feature: str,
    options: Any = None,
    *,
    otherwise: Any = None,
    around: bool = False,
) -> Callable[[Callable[[Any, DocumentNames, TextPositions], Any]], None]:
    """Register an answer from the names in a document, and what is said ``otherwise``.

    ``around``: it is about a place, and a view around that is enough while a check is due.
    """

    def registered(answer: Callable[[Any, DocumentNames, TextPositions], Any]) -> None:
        @server.feature(feature, options)
        def asked(params: Any) -> Any:
            uri = params.text_document.uri
            known = server.names_around(uri, params.position) if around else server.names(uri)
            try:
                return otherwise if known is None else answer(params, *known)
            except RefusedRenamingError as refused:
                raise JsonRpcInvalidParams(str(refused)) from None

    return registered


def _names(server: EditorSession) -> None:
    @_asked(server, lsp.TEXT_DOCUMENT_HOVER, around=True)
    def hover(
        params: lsp.HoverParams, names: DocumentNames, positions: TextPositions
    ) -> lsp.Hover | None:
        occurrence = names.at(positions.offset(params.position))
        if occurrence is None:
            return None
        text = lsp.MarkupContent(lsp.MarkupKind.Markdown, hover_text(names, occurrence))
        return lsp.Hover(text, positions.of(occurrence.span))

    @_asked(server, lsp.TEXT_DOCUMENT_DEFINITION, around=True)
    def definition(
        params: lsp.DefinitionParams, names: DocumentNames, positions: TextPositions
    ) -> lsp.Location | None:
        occurrence = names.at(positions.offset(params.position))
        if occurrence is None:
            return None
        return declaration_of(names, occurrence.symbol, server.editor)

    @_asked(server, lsp.TEXT_DOCUMENT_REFERENCES, otherwise=[])
    def references(
        params: lsp.ReferenceParams, names: DocumentNames, positions: TextPositions
    ) -> list[lsp.Location]:
        named = names.at(positions.offset(params.position))
        return [
            location
            for location, occurrence in (
                references_to(named.symbol, names, server.editor) if named else ()
            )
            if params.context.include_declaration or not occurrence.declares
        ]

    @_asked(server, lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare(
        params: lsp.PrepareRenameParams, names: DocumentNames, positions: TextPositions
    ) -> lsp.PrepareRenamePlaceholder:
        named = to_rename(names, positions.offset(params.position), server.editor)
        return lsp.PrepareRenamePlaceholder(positions.of(named.span), named.symbol.name)

    @_asked(server, lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def rename(
        params: lsp.RenameParams, names: DocumentNames, positions: TextPositions
    ) -> lsp.WorkspaceEdit:
        named = to_rename(names, positions.offset(params.position), server.editor)
        changes = renamed(named.symbol, params.new_name, names, server.editor)
        return workspace_edit(changes, server.editor)


def _writing(server: EditorSession) -> None:
    signs = lsp.CompletionOptions(trigger_characters=["(", " ", ","])

    @_asked(server, lsp.TEXT_DOCUMENT_COMPLETION, signs, otherwise=[], around=True)
    def completion(
        params: lsp.CompletionParams, names: DocumentNames, positions: TextPositions
    ) -> list[lsp.CompletionItem]:
        return completions(names, positions.offset(params.position), positions, server.editor)

    calls = lsp.SignatureHelpOptions(trigger_characters=["(", ","])

    @_asked(server, lsp.TEXT_DOCUMENT_SIGNATURE_HELP, calls, around=True)
    def signature_help(
        params: lsp.SignatureHelpParams, names: DocumentNames, positions: TextPositions
    ) -> lsp.SignatureHelp | None:
        return signature(names, positions.offset(params.position))

    @server.feature(
        lsp.TEXT_DOCUMENT_CODE_ACTION,
        lsp.CodeActionOptions(code_action_kinds=[lsp.CodeActionKind.QuickFix]),
    )
    def actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        uri = params.text_document.uri
        document = server.editor.document(uri)
        if document is None or uri in server.checks_due:
            return []
        try:
            checked = server.editor.check(document)
        except RulecError:
            return []
        fixes = quick_fixes(checked, document, params.range, server.editor)
        return [code_action(fix, uri, checked.text, server.editor) for fix in fixes]


def _layout(server: EditorSession) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def formatting(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        document = server.editor.document(params.text_document.uri)
        if document is None:
            return []
        try:
            text = format_source(Source(document.name, document.text))
        except RulecError:  # its syntax errors are shown already
            return []
        if text == document.text:
            return []
        return [lsp.TextEdit(server.editor.positions(document.text).whole(), text)]

    of_documents: dict[str, Callable[[Any, DocumentNames, TextPositions], Any]] = {
        lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL: lambda _, names, text: outline(names, text),
        lsp.TEXT_DOCUMENT_FOLDING_RANGE: lambda _, names, text: folds(names, text),
        lsp.TEXT_DOCUMENT_INLAY_HINT: lambda asked, names, text: inlay_hints(
            names, text, asked.range
        ),
        lsp.TEXT_DOCUMENT_CODE_LENS: lambda asked, names, text: code_lenses(
            names, text, asked.text_document.uri, server.answers
        ),
    }
    for feature, answer in of_documents.items():
        _asked(server, feature, otherwise=[])(answer)


def serve() -> int:
    """Serve one editor over standard input and output; returns the exit status that it requests."""
    collect_in_pauses()
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        # A thread blocked on reading standard input cannot be ended otherwise.
        signal.signal(number, lambda number, _: os._exit(128 + number))
    server = language_server()
    # pygls closes its output on exit, but standard output is flushed afterwards.
    with open(sys.stdout.fileno(), "wb", closefd=False) as replies:
        server.start_io(stdout=replies)
    return server.status


def add_commands(server: EditorSession) -> None:
    """Register the commands of code lenses; each takes a document and a rule's name.

    Compilation runs in the background, so that typing goes on. Answers are shown and returned.
    """

    def command(name: str) -> Callable[[_Ask], None]:
        """Register what a command asks; a reason why it has no answer is shown, too."""

        def registered(ask: _Ask) -> None:
            @server.command(name)
            async def asked(uri: str, rule: str) -> str:
                try:
                    return await ask(uri, rule)
                except (_NoAnswerError, RulecError) as reason:
                    return _shown(server, str(reason))

        return registered

    @command(lenses.RUN)
    async def run(uri: str, rule: str) -> str:
        answer = await _examples(server, _rule_asked_about(server, uri, rule))
        return _shown(server, answer.in_words(rule))

    @command(lenses.ENGLISH)
    async def in_english(uri: str, rule: str) -> str:
        _, book, of_rule = _rule_asked_about(server, uri, rule)
        return _shown(server, await asyncio.to_thread(english, book, of_rule))

    @command(lenses.COMPARE)
    async def compare(uri: str, rule: str) -> str:
        names, book, of_rule = _rule_asked_about(server, uri, rule)
        if len(names.chain.books) < 2:
            raise _NoAnswerError("the rulebook extends no other")
        above = names.chain.books[-2].span.source.name
        with server.editor.as_shown():
            parent = read_rulebook(above, (), book.at, book.traffic).rulebook
        answer = await asyncio.to_thread(parent_answer, book, parent, rule)
        server.answers.keep_few()
        server.answers.parents[lenses.parent_key(of_rule, names)] = answer
        server.refresh_lenses()
        return _shown(server, answer.text)

    @command(lenses.INSERT)
    async def insert(uri: str, rule: str) -> str:
        await _examples(server, _rule_asked_about(server, uri, rule))
        # Typing goes on meanwhile: the place is that in the text of now.
        names, _, of_rule = _rule_asked_about(server, uri, rule)
        answer = server.answers.of_examples(of_rule)
        if answer is None:
            raise _NoAnswerError(f"{rule} has been changed meanwhile: ask again")
        missing = answer.missing[0] if answer.missing else ""
        change = lenses.inserted_example(names, rule, missing) if missing else None
        if not of_rule.examples:
            raise _NoAnswerError(f"{rule} has no example: `rulec show` proposes the first ones")
        if change is None:
            raise _NoAnswerError(f"{rule}: every edge is tested")
        if not _takes_edits(server):
            return _shown(server, missing)
        edit = workspace_edit({uri: [change]}, server.editor)
        await server.workspace_apply_edit_async(lsp.ApplyWorkspaceEditParams(edit))
        return missing


class _NoAnswerError(Exception):
    """Why a command has no answer."""


_Ask = Callable[[str, str], Awaitable[str]]
"""Answers about a document, by its address, and a rule's name."""

RuleInDocument = tuple[DocumentNames, Rulebook, Rule]


def _rule_asked_about(server: EditorSession, uri: str, name: str) -> RuleInDocument:
    """A document, its rulebook and a rule in it. Raises _NoAnswerError if there are none."""
    known = server.names(uri)
    book = None if known is None else known[0].checked.resolved.rulebook
    if known is None or book is None:
        raise _NoAnswerError("the rulebook has mistakes: fix them first")
    names, _ = known
    rule = lenses.rule_of(names, name)
    if rule is None:
        raise _NoAnswerError(f"the rulebook has no rule `{name}`")
    return names, book, rule


async def _examples(server: EditorSession, subject: RuleInDocument) -> ExampleAnswer:
    _, book, rule = subject
    answer = await asyncio.to_thread(example_answer, book, rule)
    server.answers.keep_few()
    server.answers.examples[rule.formula] = rule.examples, answer
    server.refresh_lenses()
    return answer


def _takes_edits(server: EditorSession) -> bool:
    workspace = server.client_capabilities.workspace
    return bool(workspace and workspace.apply_edit)


def _shown(server: EditorSession, text: str) -> str:
    server.window_show_message(lsp.ShowMessageParams(lsp.MessageType.Info, text))
    return text

"""The state of one editor's session: workspace, results, published diagnostics."""

from __future__ import annotations

import asyncio
import gc
import logging
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInternalError,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcServerNotInitialized,
)
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol

from rulec.diagnostics import Diagnostic, RulecError
from rulec.language_server.lenses.code_lenses import KnownAnswers
from rulec.language_server.names.name_occurrences import DocumentNames, names_in_document
from rulec.language_server.workspace import published_diagnostics as published
from rulec.language_server.workspace.editor_workspace import Document, EditorWorkspace
from rulec.language_server.workspace.published_diagnostics import (
    LARGE,
    BackgroundCheck,
    view_around,
)
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.version import __version__
from rulec.vocabulary.pint_units import pint_unit

_IDLE_S = 0.3
"""Seconds after the last edit until other open documents, which may depend on it, are checked."""

REST_S = 2.0
"""Seconds after the last edit until work is done that would slow down a keystroke."""

_NEVER = 1_000_000


class EditorSession(LanguageServer):
    """A server with the state of its editor."""

    def __init__(self) -> None:
        kind = lsp.TextDocumentSyncKind.Full
        super().__init__("rulec", __version__, kind, protocol_cls=StrictProtocol)
        self.status = 0
        self.editor = EditorWorkspace()
        self.findings: dict[str, dict[str, list[Diagnostic]]] = {}
        self.answers = KnownAnswers()
        self.waiting: list[asyncio.TimerHandle] = []
        self.checks_due: dict[str, BackgroundCheck] = {}

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Report an error in a message: to the client that sent it, or else to the log."""
        if isinstance(error, UNREADABLE) and isinstance(self.protocol, StrictProtocol):
            self.protocol.refuse(None, JsonRpcParseError(str(error)))
        elif source is JsonRpcInternalError and isinstance(error, OSError):
            pass  # Nothing can be sent to the client: pygls would try to send it that, endlessly.
        elif not isinstance(error, JsonRpcException):
            super().report_server_error(error, source)

    def check(self, document: Document) -> None:
        """Check a document and publish its findings: a large one in the background."""
        self.give_up(document.uri)
        if len(document.text) > LARGE:
            loop = asyncio.get_running_loop()
            due = BackgroundCheck(document, self.editor, loop, self._checked)
            self.checks_due[document.uri] = due
            due.start()
            return
        try:
            findings = self.editor.check(document).findings
        except RulecError as error:  # in the project's settings
            findings = error.diagnostics
        self._found(document.uri, findings)

    def give_up(self, uri: str) -> None:
        """Give up the check that is under way for a document, if there is one."""
        if due := self.checks_due.pop(uri, None):
            due.is_cancelled = True

    def _checked(self, document: Document, findings: Iterable[Diagnostic]) -> None:
        self.checks_due.pop(document.uri, None)
        self._found(document.uri, findings)
        self._ask_again()

    def _found(self, uri: str, findings: Iterable[Diagnostic]) -> None:
        """Publish the findings of a document's check, whichever file they are in."""
        before = self.findings.get(uri, {})
        self.findings[uri] = published.by_file(findings, uri)
        for file in dict.fromkeys((uri, *before, *self.findings[uri])):
            self.publish(file)

    def _ask_again(self) -> None:
        """Have the editor ask for what it got no answer to while a check was waited for."""
        self.refresh_lenses()
        workspace = self.client_capabilities.workspace
        if workspace and workspace.inlay_hint and workspace.inlay_hint.refresh_support:
            self.workspace_inlay_hint_refresh(None)

    def refresh_lenses(self) -> None:
        """Have the editor ask for lenses anew, if it can be told to."""
        workspace = self.client_capabilities.workspace
        if workspace and workspace.code_lens and workspace.code_lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    def publish(self, uri: str) -> None:
        """Send everything that has been found in a file."""
        document = self.editor.document(uri)
        diagnostics = published.union(self.findings, uri)
        self.text_document_publish_diagnostics(
            lsp.PublishDiagnosticsParams(
                uri,
                published.diagnostics_of(
                    diagnostics, document.text if document else "", self.editor
                ),
                self.editor.documents[uri].version if uri in self.editor.documents else None,
            )
        )

    def check_others(self, uri: str) -> None:
        """Check the other open documents, now that typing has paused."""
        for document in list(self.editor.documents.values()):
            if document.uri != uri and document.uri not in self.checks_due:
                self.check(document)

    def check_others_later(self, uri: str) -> None:
        """Check the other open documents once typing pauses."""
        for timer in self.waiting:
            timer.cancel()
        loop = asyncio.get_running_loop()
        self.waiting = [
            loop.call_later(_IDLE_S, self.check_others, uri),
            loop.call_later(REST_S, self.rest),
        ]

    def rest(self) -> None:
        """Use a pause in typing."""
        # Pint takes 0.5 s to import, on the first unknown unit.
        pint_unit("")
        gc.collect()

    def names(self, uri: str) -> tuple[DocumentNames, TextPositions] | None:
        """The names in a document, and the positions of its text; None while a check is due."""
        document = self.editor.document(uri)
        if document is None or uri in self.checks_due:
            return None
        known = document.checked if uri in self.editor.documents else None
        with suppress(RulecError):
            names = names_in_document(known or self.editor.check(document))
            return names, self.editor.positions(document.text)
        return None

    def names_around(
        self, uri: str, position: lsp.Position
    ) -> tuple[DocumentNames, TextPositions] | None:
        """The same, for a place in the document; while a check is due, from a view around it."""
        document = self.editor.document(uri)
        if document is None or uri not in self.checks_due:
            return self.names(uri)
        positions = self.editor.positions(document.text)
        view = Document(uri, view_around(document.text, positions.offset(position)))
        with self.checks_due[uri].pause, suppress(RulecError):
            checked = self.editor.check(view)
            return names_in_document(replace(checked, text=document.text)), positions
        return None


def collect_in_pauses() -> None:
    """Leave full garbage collections to pauses: one takes 0.1 s, a noticeable delay."""
    young, middle, _ = gc.get_threshold()
    gc.set_threshold(young, middle, _NEVER)


UNREADABLE = (ValueError, RecursionError)
"""What reading a message raises that is not JSON, or is nested too deeply."""


def _is_no_refusal(record: logging.LogRecord) -> bool:
    """Whether a log record is about more than a refusal, which its reply explains already.

    Of a message whose parts do not fit its method, and of a reply that cannot be written, a line
    stays, and not the traceback below it.
    """
    record.msg, record.args = record.getMessage().partition("\n")[0], ()
    problem = record.exc_info[1] if record.exc_info else None
    if isinstance(problem, OSError) and record.msg.startswith("Error sending data"):
        record.exc_info = None
    kinds = (JsonRpcException, *(UNREADABLE if record.name == "pygls.server" else ()))
    return not isinstance(problem, kinds)


# Editors show each error logged by pygls as a crash of the server, even for an invalid new name.
for _logger in ("pygls.protocol.json_rpc", "pygls.server"):
    logging.getLogger(_logger).addFilter(_is_no_refusal)


_TAKEN = "a command takes two texts: a document's address and a rule's name"


def _names_a_rule(message: Any) -> bool:
    """Whether a command has its arguments, without which pygls would call it all the same."""
    arguments = getattr(getattr(message, "params", None), "arguments", None) or ()
    return len(arguments) == 2 and all(isinstance(one, str) for one in arguments)


class StrictProtocol(LanguageServerProtocol):
    """Sends an error to the waiting client where pygls would only log it."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message as an object; an invalid request is refused."""
        try:
            return super().structure_message(data)
        except JsonRpcException as problem:
            if "id" in data and "method" in data:
                self.refuse(data["id"], problem)
            raise

    def handle_message(self, message: Any) -> None:
        """Answer a message, or refuse it: invalid, too early, or too late."""
        number, method = (getattr(message, name, None) for name in ("id", "method"))
        is_begun = self._workspace is not None or method in (lsp.INITIALIZE, lsp.EXIT)
        if getattr(message, "jsonrpc", "") != self.VERSION:
            number = message.get("id") if isinstance(message, dict) else number
            self.refuse(number, JsonRpcInvalidRequest("this is no message of JSON-RPC 2.0"))
        elif method == lsp.INITIALIZE and self._workspace is not None:
            # pygls would begin anew, without the documents that are open.
            self.refuse(number, JsonRpcInvalidRequest("the server has been initialized already"))
        elif is_begun and method == lsp.WORKSPACE_EXECUTE_COMMAND and not _names_a_rule(message):
            self.refuse(number, JsonRpcInvalidParams(_TAKEN))
        elif is_begun and not (self._shutdown and method and number is not None):
            super().handle_message(message)
        elif number is not None and is_begun:
            self.refuse(number, JsonRpcInvalidRequest("the server has been shut down"))
        elif number is not None:
            self.refuse(number, JsonRpcServerNotInitialized())

    def refuse(self, number: Any, problem: JsonRpcException) -> None:
        """Reply with an error, also to a message without a number."""
        error = {"code": problem.code, "message": problem.message}
        self._send_data({"jsonrpc": self.VERSION, "id": number, "error": error})

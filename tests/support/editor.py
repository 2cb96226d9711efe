"""An editor: pygls' own client, which speaks with `rulec lsp` over standard input and output."""

import asyncio
import sys

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

LONGEST_S = 60
"""So long an answer is waited for on a machine that does much else."""


class Editor:
    """A client with its server, in calls that return when the answer is there."""

    def __init__(self, folder, encodings=None):
        self.folder = folder
        self.loop = asyncio.new_event_loop()
        self.client = LanguageClient("tests", "1")
        self.found = {}
        self.messages = []
        self.refreshed = 0
        self.edits = []
        self._listen()
        self.capabilities = self.run(self._begin(encodings)).capabilities

    def _listen(self):
        @self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params):
            self.found[params.uri] = params

        @self.client.feature(lsp.WINDOW_SHOW_MESSAGE)
        def message(params):
            self.messages.append(params)

        @self.client.feature(lsp.WORKSPACE_APPLY_EDIT)
        def apply(params):
            self.edits.append(params.edit)
            return lsp.ApplyWorkspaceEditResult(applied=True)

        @self.client.feature(lsp.WORKSPACE_CODE_LENS_REFRESH)
        def refresh(_):
            self.refreshed += 1

    async def _begin(self, encodings):
        await self.client.start_io(sys.executable, "-m", "rulec", "lsp", "--stdio")
        folder = lsp.WorkspaceFolder(self.folder.as_uri(), "tests")
        answer = await self.client.initialize_async(
            lsp.InitializeParams(
                capabilities=lsp.ClientCapabilities(
                    general=lsp.GeneralClientCapabilities(position_encodings=encodings),
                    workspace=lsp.WorkspaceClientCapabilities(
                        apply_edit=True,
                        code_lens=lsp.CodeLensWorkspaceClientCapabilities(refresh_support=True),
                    ),
                ),
                root_uri=self.folder.as_uri(),
                workspace_folders=[folder],
            )
        )
        self.client.initialized(lsp.InitializedParams())
        return answer

    def run(self, waiting):
        return self.loop.run_until_complete(asyncio.wait_for(waiting, LONGEST_S))

    def ask(self, method, params):
        """The answer to a request."""

        async def asking():
            return await self.client.protocol.send_request_async(method, params)

        answer = self.run(asking())
        return list(answer) if isinstance(answer, tuple) else answer

    def uri(self, name):
        return (self.folder / name).as_uri()

    def open(self, name, text):
        """Show a document, and wait for what is found in it."""
        uri = self.uri(name)
        self.found.pop(uri, None)
        self.client.text_document_did_open(
            lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, "rulec", 1, text))
        )
        return self.diagnostics(uri, 1)

    def change(self, name, text, version):
        """Show another text, and wait for what is found in it."""
        uri = self.uri(name)
        self.client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(version, uri),
                [lsp.TextDocumentContentChangeWholeDocument(text)],
            )
        )
        return self.diagnostics(uri, version)

    def close(self, name):
        self.client.text_document_did_close(
            lsp.DidCloseTextDocumentParams(lsp.TextDocumentIdentifier(self.uri(name)))
        )

    def diagnostics(self, uri, version):
        """What was published about a version of a document."""

        def is_there(found):
            return found is not None and found.version == version

        return list(self.until(lambda: self.found.get(uri), is_there).diagnostics)

    def until(self, value, good):
        """A value that is good, as soon as there is one."""

        async def waiting():
            while not good(value()):
                await asyncio.sleep(0.01)

        self.run(waiting())
        return value()

    def position_params(self, kind, name, position, **more):
        return kind(
            text_document=lsp.TextDocumentIdentifier(self.uri(name)), position=position, **more
        )

    def end(self):
        self.run(self.client.shutdown_async(None))
        self.client.exit(None)
        self.run(self.client.stop())
        self.loop.close()


def at(text, before, inside="", *, nth=0):
    """The position in UTF-16 behind the nth ``before`` (or ``inside`` of it) in a text."""
    index = -1
    for _ in range(nth + 1):
        index = text.index(before, index + 1)
    index += before.index(inside) if inside else len(before)
    line = text.count("\n", 0, index)
    start = text.rfind("\n", 0, index) + 1
    return lsp.Position(line, len(text[start:index].encode("utf-16-le")) // 2)


def shown(text, where):
    """The characters of a range in UTF-16."""
    lines = text.split("\n")

    def offset(position):
        line = lines[position.line].encode("utf-16-le")
        column = len(line[: 2 * position.character].decode("utf-16-le"))
        return sum(len(one) + 1 for one in lines[: position.line]) + column

    return text[offset(where.start) : offset(where.end)]


def edited(text, edits):
    """The text after edits, all of them in its ASCII lines."""
    for edit in sorted(edits, key=lambda one: one.range.start, reverse=True):
        old = shown(text, edit.range)
        line = sum(len(one) + 1 for one in text.split("\n")[: edit.range.start.line])
        start = line + edit.range.start.character
        assert text[start : start + len(old)] == old
        text = text[:start] + edit.new_text + text[start + len(old) :]
    return text

"""Documents of odd addresses and sizes: the server goes on to answer about all others."""

import os

import pytest
from lsprotocol import types as lsp

from support.editor import Editor

SOUND = "rulebook sound\nsignal p default false\nhard rule r { require always p }\n"
NONE = "file://[::1/a.rules"
"""No address at all: the protocol's library opens no document for it."""

ODD = [
    "file:///tmp/\ud800.rules",
    "file:///tmp/%ED%A0%80.rules",
    "file:///tmp/a%00b.rules",
    "file:",
    "file://elsewhere/share/a.rules",
    NONE,
    "untitled:\n::error::x\x1b[2J",
    f"file:///{'a' * 10_000}.rules",
    "",
]


@pytest.fixture(scope="module")
def editor(tmp_path_factory):
    folder = tmp_path_factory.mktemp("workspace")
    os.mkfifo(folder / "pipe.rules")
    (folder / "environ.rules").symlink_to("/proc/self/environ")
    (folder / "zero.rules").symlink_to("/dev/zero")
    own = Editor(folder)
    yield own
    own.end()


def symbols(editor, uri):
    params = lsp.DocumentSymbolParams(lsp.TextDocumentIdentifier(uri))
    return [one.name for one in editor.ask(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, params)]


def test_odd_addresses_are_of_documents_without_a_file(editor):
    for uri in ODD:
        document = lsp.TextDocumentItem(uri, "rulec", 1, SOUND)
        editor.client.text_document_did_open(lsp.DidOpenTextDocumentParams(document))
    assert editor.open("sound.rules", SOUND) == []
    assert {uri: symbols(editor, uri) for uri in ODD} == {
        **{uri: ["p", "r"] for uri in ODD},
        NONE: [],
    }
    # Of those that are open, too, once nobody types
    editor.change("sound.rules", SOUND.replace("p", "q"), 2)
    assert symbols(editor, editor.uri("sound.rules")) == ["q", "r"]


@pytest.mark.parametrize("name", ["pipe.rules", "environ.rules", "zero.rules", ""])
def test_what_is_no_source_is_not_read(name, editor):
    assert symbols(editor, editor.uri(name)) == []


def test_a_document_of_megabytes_is_refused_like_a_file(editor):
    (found,) = editor.open("big.rules", "rulebook b\n" + "# x\n" * 1_300_000)
    assert found.code == "R0102"
    assert symbols(editor, editor.uri("big.rules")) == []

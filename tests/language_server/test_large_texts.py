"""Of a text that is too large to be read piece by piece, only the newest version is checked."""

import asyncio

import pytest
from lsprotocol import types as lsp

from rulec.language_server import editor_session
from rulec.language_server.editor_session import EditorSession

URI = "file:///nowhere/large.rules"
TEXT = "rulebook large\nsignal p default false\nhard rule r {{ require never p }}\n# {}\n"


@pytest.fixture
def session(monkeypatch):
    """A session in which every text is large, with the versions that it has checked."""
    monkeypatch.setattr(editor_session, "MOST_CHARACTERS", 10)
    monkeypatch.setattr(editor_session, "_IDLE_S", 0.01)
    session, checked = EditorSession(), []
    monkeypatch.setattr(session, "publish", lambda uri: None)
    monkeypatch.setattr(session, "_ask_again", lambda: checked.append("asked again"))
    check = session.check
    monkeypatch.setattr(
        session, "check", lambda document: (checked.append(document.version), check(document))
    )
    return session, checked


def test_only_the_newest_version_is_checked(session):
    session, checked = session

    async def typing():
        for version in range(2, 7):
            session.check_changed(session.editor.open(URI, TEXT.format(version), version))
            assert session.names(URI) is None
            session.check_others("")
        assert checked == []
        await asyncio.sleep(0.1)

    asyncio.run(typing())
    assert checked == [6, "asked again"]
    assert session.names(URI) is not None


def test_what_is_closed_meanwhile_is_not_checked(session):
    session, checked = session

    async def typing():
        session.check_changed(session.editor.open(URI, TEXT.format(2), 2))
        session.editor.close(URI)
        await asyncio.sleep(0.1)

    asyncio.run(typing())
    assert checked == []


def test_a_text_that_is_not_large_is_checked_at_once(session, monkeypatch):
    session, checked = session
    monkeypatch.setattr(editor_session, "MOST_CHARACTERS", 1000)
    session.check_changed(session.editor.open(URI, TEXT.format(2), 2))
    assert checked == [2]
    assert isinstance(session.names(URI)[1].whole(), lsp.Range)

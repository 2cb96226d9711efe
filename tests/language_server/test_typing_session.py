"""A stored session of typing: what is shown after its keys is what `rulec check` says.

Of a text that is too large to be read piece by piece, only the newest version is shown.
"""

import asyncio

import pytest
from lsprotocol import types as lsp

from rulec.language_server import editor_session
from rulec.language_server.editor_session import REST_S, EditorSession
from rulec.language_server.workspace.editor_workspace import EditorWorkspace
from rulec.resources import rulebooks_folder
from rulec.rulebook.loader import diagnose
from support.typing.typing_session import typed


@pytest.fixture(scope="module")
def session():
    return list(typed((rulebooks_folder() / "de/de.rules").read_text(encoding="utf-8")))


def found(text, path):
    return diagnose(str(path), text.encode(), path).findings


def test_it_ends_with_a_rulebook_without_errors(session, tmp_path):
    path = tmp_path / "de.rules"
    wrong = [one for one in found(session[-1][1], path) if one.severity == "error"]
    assert wrong == []
    assert "keep_clear_of_tracks" in session[-1][1]
    assert max(waited for waited, _ in session) > REST_S


@pytest.mark.long
def test_what_is_shown_is_what_check_says(session, tmp_path):
    path = tmp_path / "de.rules"
    workspace = EditorWorkspace((tmp_path,))
    for number, (_, text) in enumerate(session):
        checked = workspace.check(workspace.open(path.as_uri(), text))
        if number % 5 == 0:
            assert checked.findings == found(text, path), number


LARGE = "file:///nowhere/large.rules"
TEXT = "rulebook large\nsignal p default false\nhard rule r {{ require never p }}\n# {}\n"


@pytest.fixture
def large_texts(monkeypatch):
    """A session in which every text is large, with the versions whose findings it published."""
    monkeypatch.setattr(editor_session, "LARGE", 10)
    session, published = EditorSession(), []
    versions = session.editor.documents
    monkeypatch.setattr(session, "publish", lambda uri: published.append(versions[uri].version))
    monkeypatch.setattr(session, "_ask_again", lambda: published.append("asked again"))
    return session, published


async def until_checked(session):
    while session.checks_due:
        await asyncio.sleep(0.01)


def test_only_the_newest_version_is_shown(large_texts):
    session, published = large_texts

    async def typing():
        for version in range(2, 7):
            session.check(session.editor.open(LARGE, TEXT.format(version), version))
            assert session.names(LARGE) is None
            session.check_others(LARGE)
        assert published == []
        await until_checked(session)
        await asyncio.sleep(0.1)

    asyncio.run(typing())
    assert published == [6, "asked again"]
    assert session.names(LARGE) is not None


def test_what_is_closed_meanwhile_is_not_shown(large_texts):
    session, published = large_texts

    async def typing():
        session.check(session.editor.open(LARGE, TEXT.format(2), 2))
        session.editor.close(LARGE)
        session.give_up(LARGE)
        await asyncio.sleep(0.1)

    asyncio.run(typing())
    assert published == []


def test_a_text_that_is_not_large_is_checked_at_once(large_texts, monkeypatch):
    session, published = large_texts
    monkeypatch.setattr(editor_session, "LARGE", 1000)
    session.check(session.editor.open(LARGE, TEXT.format(2), 2))
    assert published == [2]
    assert isinstance(session.names(LARGE)[1].whole(), lsp.Range)

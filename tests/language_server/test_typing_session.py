"""A stored session of typing: what is shown after its keys is what `rulec check` says."""

import pytest

from rulec.language_server.editor_session import REST_S
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
    for number, (waited, text) in enumerate(session):
        if waited >= REST_S:
            workspace.rest()
        checked = workspace.check(workspace.open(path.as_uri(), text))
        if number % 5 == 0:
            assert checked.findings == found(text, path), number

"""Large rulebooks: answers do not wait for the check, and the check is that of `rulec check`."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types as lsp

from rulec.cancellation import CancelledError, is_wanted, step
from rulec.language_server.names.name_occurrences import names_in_document
from rulec.language_server.workspace.editor_workspace import Document, EditorWorkspace
from rulec.language_server.workspace.published_diagnostics import (
    LARGE,
    BackgroundCheck,
    view_around,
)
from rulec.resources import rulebooks_folder
from support.editor import Editor, at

HEAD = "rulebook large\nuse paper\ndefine gone(v: vehicle) = f(v)\n"
RULE = """
hard rule r{0} (v: vehicle) {{
  says    "Number {0}, of many rules that differ by their number alone."
  require always (b(v) and next (b(v) until r(v)) implies not next gone(v))
  accept  {{ b(v); l(v); f(v) }}
}}
"""


def large(rules):
    return HEAD + "".join(RULE.format(number) for number in range(rules))


@pytest.fixture
def own_editor(tmp_path):
    editor = Editor(tmp_path)
    yield editor
    editor.end()


def show(editor, text, version=1):
    document = lsp.TextDocumentItem(editor.uri("large.rules"), "rulec", version, text)
    editor.client.text_document_did_open(lsp.DidOpenTextDocumentParams(document))


def hover(editor, text, before, inside, nth):
    where = at(text, before, inside, nth=nth)
    params = editor.position_params(lsp.HoverParams, "large.rules", where)
    return editor.ask(lsp.TEXT_DOCUMENT_HOVER, params)


def test_a_hover_is_answered_before_the_check_has_ended(own_editor):
    wrong = "hard rule last { require always nobody }\n"
    text = large(1500) + wrong
    assert len(text) > 5 * LARGE
    show(own_editor, text)
    for nth in (0, 700, 1499):
        shown = hover(own_editor, text, "next gone(v)", "gone", nth)
        assert "define gone(v: vehicle)" in shown.contents.value
        assert shown.range.start.line == at(text, "next gone(v)", "gone", nth=nth).line
        assert own_editor.uri("large.rules") not in own_editor.found
    (found,) = own_editor.diagnostics(own_editor.uri("large.rules"), 1)
    assert (found.code, found.range.start.line) == ("R0202", text.count("\n") - 1)
    after = hover(own_editor, text, "next gone(v)", "gone", 700)
    assert after.contents == shown.contents


def test_the_next_change_gives_a_check_up(own_editor):
    text = large(1500)
    show(own_editor, text)
    short = HEAD + "hard rule r { require always nobody }\n"
    assert [found.code for found in own_editor.change("large.rules", short, 2)] == ["R0202"]
    own_editor.close("large.rules")


def test_a_check_that_is_given_up_ends_between_two_steps():
    answers = [True, True, False]
    step()  # by default, nothing is given up
    token = is_wanted.set(lambda: answers.pop(0))
    step()
    step()
    with pytest.raises(CancelledError):
        step()
    is_wanted.reset(token)


def test_a_paused_check_waits(tmp_path):
    ended = threading.Event()

    class Loop:
        def call_soon_threadsafe(self, done, *arguments):
            done(*arguments)
            ended.set()

    document = Document((tmp_path / "large.rules").as_uri(), large(20))
    check = BackgroundCheck(document, EditorWorkspace(), Loop(), lambda *_: None)
    with check.pause:
        check.start()
        assert not ended.wait(0.2)
    assert ended.wait(60)
    assert document.checked is not None


BOOKS = [rulebooks_folder() / name / f"{name}.rules" for name in ("esterle2019", "un-r157", "ie")]
TEXTS = {path: path.read_text(encoding="utf-8") for path in BOOKS}
FULL = {}


def names_of(path, text):
    document = Document(path.as_uri(), text)
    return names_in_document(EditorWorkspace().check(document))


@given(st.sampled_from(BOOKS), st.floats(0, 1, exclude_max=True))
def test_a_name_in_a_view_is_what_it_is_in_the_whole_text(path, share):
    """But names of other rules are not in it."""
    text = TEXTS[path]
    offset = int(share * len(text))
    view = view_around(text, offset)
    assert len(view) == len(text)
    if path not in FULL:
        FULL[path] = names_of(path, text)
    whole, seen = FULL[path].at(offset), names_of(path, view).at(offset)
    if whole is None or whole.symbol.kind in ("rule", "topic", "level"):
        return
    assert seen is not None
    assert (seen.symbol.kind, seen.symbol.name) == (whole.symbol.kind, whole.symbol.name)
    assert seen.span.start == whole.span.start

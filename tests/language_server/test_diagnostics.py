"""What is wrong with a document, as it is typed: what `rulec check` says of it."""

import sys

from lsprotocol import types as lsp

import rulec
from rulec.cli.main import main
from support.editor import at, shown

TOWN = """\
rulebook town
signal fog, slow
hard rule r {
  require always (fog implies slow)
}
"""


def test_a_sound_document_has_none(editor):
    assert editor.open("sound.rules", TOWN) == []


def test_a_mistake_has_its_place_its_code_and_the_way_out(editor):
    text = TOWN.replace("implies slow", "implies slwo")
    (found,) = editor.open("misspelt.rules", text)
    assert shown(text, found.range) == "slwo"
    assert found.severity == lsp.DiagnosticSeverity.Error
    assert found.source == "rulec"
    assert "help: did you mean `slow`?" in found.message


def test_mistakes_come_and_go_with_the_text(editor):
    assert editor.open("edited.rules", TOWN) == []
    assert len(editor.change("edited.rules", TOWN.replace("fog implies", "fog"), 2)) == 1
    assert editor.change("edited.rules", TOWN, 3) == []


def test_a_label_is_related_information(editor):
    text = TOWN.replace("signal fog, slow", "signal fog, slow, fog")
    (found,) = editor.open("twice.rules", text)
    (first,) = found.related_information
    assert shown(text, first.location.range) == "fog"
    assert first.location.range.start == at(text, "signal fog, slow, fog", "fog")


def test_positions_count_utf_16_code_units(editor):
    text = TOWN.replace("require always (fog", 'says "𝔽𝕠𝕘" require always (𝒻')
    text = text.replace("implies slow", "implies gone")
    found = editor.open("wide.rules", text)
    assert [shown(text, one.range) for one in found if one.code == "R0202"] == ["𝒻", "gone"]


def test_a_document_that_is_not_saved_is_read_by_others(editor):
    words = "vocabulary words {\n  signal fog\n}\n"
    book = "rulebook user\nuse words\nhard rule r { require never fog }\n"
    editor.open("words.rules", words)
    assert editor.open("user.rules", book) == []
    editor.change("words.rules", words.replace("fog", "mist"), 2)
    uri = editor.uri("user.rules")
    found = editor.until(lambda: editor.found[uri].diagnostics, bool)
    assert [shown(book, one.range) for one in found] == ["fog"]
    editor.close("words.rules")
    found = editor.until(
        lambda: editor.found[uri].diagnostics, lambda now: now and now[0].code == "R0703"
    )
    assert shown(book, found[0].range) == "words"


def test_wrong_settings_are_told_where_they_are(editor):
    folder = editor.folder / "settings"
    folder.mkdir()
    (folder / "rulec.toml").write_text("search_path = 1\n")
    editor.open("settings/a.rules", TOWN)
    uri = (folder / "rulec.toml").as_uri()
    found = editor.until(lambda: editor.found.get(uri), bool).diagnostics
    assert [one.code for one in found] == ["R0704"]


def test_without_pygls_the_verb_says_what_installs_it(monkeypatch, capsys):
    for name in [name for name in sys.modules if name.startswith("rulec.language_server.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pygls", None)
    monkeypatch.setitem(sys.modules, "pygls.lsp.server", None)
    assert main(["lsp"]) == 2
    told = capsys.readouterr().err
    assert "error[R0760]" in told
    assert "[lsp]'`" in told
    assert rulec.explain("R0760").kind == "circumstance"

"""``rulec.toml``: found upward, read with care, obeyed by every verb."""

import pytest

from rulec.cli.main import main
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.diagnostics import RulecError
from rulec.settings import search_path


def project(folder, text):
    (folder / "books").mkdir()
    (folder / "deep" / "inside").mkdir(parents=True)
    (folder / "rulec.toml").write_text(text)
    return folder / "deep" / "inside"


def test_the_nearest_file_upward_counts(tmp_path):
    inside = project(tmp_path, 'search_path = ["books"]')
    assert search_path(inside) == (tmp_path / "books",)
    assert search_path(tmp_path) == (tmp_path / "books",)
    (inside / "rulec.toml").write_text("")
    assert search_path(inside) == ()


def test_without_a_file_there_are_no_folders(tmp_path):
    assert search_path(tmp_path) == ()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("search_path = [", "not TOML"),
        ("searchpath = []", "no setting `searchpath`"),
        ('search_path = "books"', "not a list of folders"),
        ("search_path = [1]", "not a list of folders"),
        ('search_path = ["boks"]', "names `boks`, which is no folder"),
    ],
)
def test_what_is_wrong(tmp_path, text, words):
    inside = project(tmp_path, text)
    with pytest.raises(RulecError) as caught:
        search_path(inside)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0704"
    assert words in diagnostic.message
    assert diagnostic.place.file == str(tmp_path / "rulec.toml")


def test_names_are_looked_for_there(tmp_path, monkeypatch, capsys):
    inside = project(tmp_path, 'search_path = ["books"]')
    (tmp_path / "books" / "words.rules").write_text("vocabulary words { signal p default true }\n")
    (tmp_path / "books" / "mine.rules").write_text(
        "rulebook mine\nuse words\nhard rule A { require p }\n"
    )
    (inside / "t.jsonl").write_text('{"states": [{}]}\n')
    monkeypatch.chdir(inside)
    assert main(["verify", "t.jsonl", "--rulebook", "mine"]) == 0
    assert main(["maneuvers", "s1", "--rulebook", "mine"]) == 0
    assert main(["compile", "mine", "-o", "out"]) == 0
    assert (inside / "out" / "A.hoa").exists()
    assert main(["check", "mine", "words"]) == 0
    assert main(["test", "mine"]) == 0
    capsys.readouterr()
    assert main(["list"]) == 0
    listed = capsys.readouterr().out
    assert "mine" in listed
    assert "words" in listed
    assert "mine" in [item.value for item in complete_rulebooks(None, None, "")]
    monkeypatch.chdir(tmp_path.parent)
    assert main(["compile", "mine", "-o", str(inside / "out")]) == 2
    assert "there is no rulebook `mine`" in capsys.readouterr().err

"""``rulec.toml``: found upward, read with care, obeyed by every verb."""

import os

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
        ('search_path = [""]', "`search_path` has an empty text in its list"),
        ('exclude = ["old/", " "]', "`exclude` has an empty text in its list"),
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


@pytest.mark.parametrize("name", ["..", "../books", "/tmp", "link", "books/../..", "nul\\u0000"])
def test_folders_out_of_the_tree_are_refused(name, tmp_path):
    (tmp_path / "tree").mkdir()
    project(tmp_path / "tree", f'search_path = ["{name}"]')
    (tmp_path / "books").mkdir()
    (tmp_path / "tree" / "link").symlink_to(tmp_path / "books")
    with pytest.raises(RulecError) as caught:
        search_path(tmp_path / "tree")
    assert [one.code for one in caught.value.diagnostics] == ["R0732"]


def test_a_work_tree_of_git_is_one_tree(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "shared").mkdir()
    (tmp_path / "part").mkdir()
    project(tmp_path / "part", 'search_path = ["../shared"]')
    assert search_path(tmp_path / "part") == (tmp_path / "part" / "../shared",)


def test_names_that_are_too_long_are_no_folders(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(project(tmp_path, f'search_path = ["{"a" * 300}"]'))
    assert main(["list"]) == 2
    assert "error[R0704]" in capsys.readouterr().err


def test_a_pipe_is_no_file_of_settings(tmp_path):
    inside = project(tmp_path, 'search_path = ["books"]')
    os.mkfifo(inside / "rulec.toml")
    with pytest.raises(RulecError, match="R0731"):
        search_path(inside)
    (inside / "rulec.toml").unlink()
    (inside / "rulec.toml").symlink_to("nowhere")
    with pytest.raises(RulecError, match="R0701"):
        search_path(inside)


def test_a_link_to_settings_elsewhere_is_refused(tmp_path):
    (tmp_path / "secret").write_text("PASSWORD = hunter2")
    (tmp_path / "tree").mkdir()
    (tmp_path / "tree" / "rulec.toml").symlink_to(tmp_path / "secret")
    with pytest.raises(RulecError) as caught:
        search_path(tmp_path / "tree")
    (one,) = caught.value.diagnostics
    assert (one.code, one.place.excerpt) == ("R0730", "")


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

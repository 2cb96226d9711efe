"""Many files at once: which are meant, and that checking says what loading says."""

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.resources import rulebooks_folder
from rulec.rulebook.batch.batch_check import check, find_sources
from rulec.rulebook.loader import diagnose
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from rulec.syntax import decode, parse

PROGRAMS = Path(__file__).resolve().parents[1] / "programs"
FILES = sorted(PROGRAMS.rglob("*.rules"))
VOCABULARIES = [
    path.read_bytes()
    for folder in (PROGRAMS / "bad" / "vocabulary", rulebooks_folder() / "vocabulary")
    for path in sorted(folder.glob("*.rules"))
]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_checking_says_what_loading_says(path):
    try:
        loading = read_rulebook(path).warnings
    except RulecError as error:
        loading = error.diagnostics
    found = diagnose(str(path), path.read_bytes(), path).findings
    tree, _ = parse(decode(str(path), path.read_bytes()))
    if tree.kind == "vocabulary" and tree.name is not None:
        # A vocabulary cannot be loaded as a rulebook, and can be checked.
        assert all(one.code != "R0206" for one in found)
    else:
        assert found == loading


@given(st.sampled_from(VOCABULARIES), st.data())
def test_a_mutated_vocabulary_has_mistakes_with_places_or_none(text, data):
    start = data.draw(st.integers(0, len(text)))
    end = min(len(text), start + data.draw(st.integers(0, 20)))
    middle = data.draw(st.binary(max_size=4) | st.sampled_from([b"{", b"}", b" is ", b"type a "]))
    for one in diagnose("fuzz.rules", text[:start] + middle + text[end:]).findings:
        assert one.place is not None
        assert one.place.file == "fuzz.rules"


def test_names_paths_and_folders(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("paper").mkdir()
    Path("paper/mine.rules").write_text("vocabulary mine { signal p }")
    Path("words").mkdir()
    Path("words/words.rules").write_text("vocabulary words { signal p }")
    # A name is a name, though there is a folder of that name.
    assert [path.name for path in find_sources("paper").paths] == ["paper.rules"]
    assert find_sources("./paper").paths == [Path("paper/mine.rules")]
    assert find_sources("words").paths == [Path("words/words.rules")]
    assert find_sources("words", [tmp_path / "words"]).paths == [tmp_path / "words" / "words.rules"]
    assert find_sources("none.rules").paths == [Path("none.rules")]


def test_one_file_under_two_names_is_checked_once(tmp_path):
    (tmp_path / "a.rules").write_text("vocabulary a { signal p q }")
    (tmp_path / "b.rules").symlink_to(tmp_path / "a.rules")
    done = check([str(tmp_path)], lambda: b"")
    assert done.files == (str(tmp_path / "a.rules"),)
    assert [one.code for one in done.findings] == ["R0104"]


def test_a_circle_is_said_once_whichever_of_its_rulebooks_finds_it(tmp_path):
    for name, base in (("a", "b"), ("b", "c"), ("c", "a"), ("outside", "b"), ("self", "self")):
        (tmp_path / f"{name}.rules").write_text(f"rulebook {name}\nextends {base}\n")
    done = check([str(tmp_path)], lambda: b"")
    assert [(one.code, one.message.partition(": ")[2]) for one in done.findings] == [
        ("R0213", "`a` extends `b` extends `c` extends `a`"),
        ("R0213", "`self` extends `self`"),
    ]
    # What leads to the circle is no part of it.
    (found,) = check([str(tmp_path / "outside.rules")], lambda: b"").findings
    assert found.message.endswith(": `b` extends `c` extends `a` extends `b`")


def test_a_folder_that_cannot_be_read_is_said(tmp_path, monkeypatch):
    (tmp_path / "a.rules").write_text("vocabulary a { signal p }")
    (tmp_path / "locked").mkdir()
    scan = os.scandir

    def locked(path):
        if Path(path).name == "locked":
            raise PermissionError(13, "Permission denied", os.fspath(path))
        return scan(path)

    monkeypatch.setattr(os, "scandir", locked)
    done = check([str(tmp_path)], lambda: b"")
    (one,) = done.unread
    assert (one.code, one.place.file) == ("R0701", str(tmp_path / "locked"))
    assert "permission denied" in one.message

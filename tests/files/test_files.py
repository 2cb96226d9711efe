"""Texts from any editor, and files that appear whole or not at all."""

import unicodedata

import pytest

from rulec.diagnostics import RulecError
from rulec.files import decoded, written_whole


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_line_ends_of_every_kind(line_end):
    source = decoded("a", f"one{line_end}two{line_end}".encode())
    assert source.text == "one\ntwo\n"
    assert source.position(4) == (2, 1)


def test_names_that_look_alike_are_alike():
    assert decoded("a", unicodedata.normalize("NFD", "Überholen").encode()).text == "Überholen"


def test_a_byte_order_mark_is_no_text():
    assert decoded("a", b"\xef\xbb\xbfone").text == "one"


def test_a_file_is_replaced_whole(tmp_path):
    file = tmp_path / "file"
    file.write_text("old")
    with written_whole(file) as stream:
        stream.write(b"new")
        assert file.read_text() == "old"
    assert file.read_text() == "new"
    assert list(tmp_path.iterdir()) == [file]


def test_a_file_stays_when_its_successor_fails(tmp_path):
    file = tmp_path / "file"
    file.write_text("old")

    def half():
        with written_whole(file) as stream:
            stream.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        half()
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_new_file_can_be_read_by_whom_the_umask_says(tmp_path):
    ordinary, ours = tmp_path / "ordinary", tmp_path / "ours"
    ordinary.write_text("")
    with written_whole(ours):
        pass
    assert ours.stat().st_mode == ordinary.stat().st_mode


def test_a_folder_in_the_way(tmp_path):
    with pytest.raises(RulecError) as caught, written_whole(tmp_path):
        pass
    assert caught.value.diagnostics[0].code == "R0702"

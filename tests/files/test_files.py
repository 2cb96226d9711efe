"""Texts from any editor, and files that appear whole or not at all."""

import gzip
import io
import resource
import unicodedata
from pathlib import Path

import pytest

from rulec import files
from rulec.diagnostics import RulecError
from rulec.files import decoded, opened, write_together, written_whole


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


def test_what_is_packed_is_unpacked_on_the_way(tmp_path):
    file = tmp_path / "file.gz"
    file.write_bytes(gzip.compress(b"0123456789"))
    with opened(file) as stream:
        assert stream.read(3) == b"012"
        assert stream.seek(-2, io.SEEK_END) == 8
        assert stream.read() == b"89"
        stream.seek(0)
        assert stream.peek(2)[:2] == b"01"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (gzip.compress(bytes(range(256)), mtime=0)[:-30], "it is packed, and ends too soon"),
        (gzip.compress(b"a", mtime=0)[:10] + b"\xff" * 20, "it is packed, and damaged"),
        (gzip.compress(b"a" * 1001, mtime=0), "larger than 1,000 bytes when unpacked"),
    ],
)
def test_what_is_packed_and_cannot_be_unpacked(tmp_path, monkeypatch, content, says):
    monkeypatch.setattr(files, "LARGEST_UNPACKED", 1000)
    file = tmp_path / "file.gz"
    file.write_bytes(content)
    with pytest.raises(RulecError) as refused, opened(file) as stream:
        stream.read()
    (found,) = refused.value.diagnostics
    assert (found.code, found.place.file) == ("R0701", str(file))
    assert says in found.message


def test_any_number_of_files_appear_together_however_few_may_be_open(tmp_path):
    usual = resource.getrlimit(resource.RLIMIT_NOFILE)
    n_open = len(list(Path("/proc/self/fd").iterdir()))
    resource.setrlimit(resource.RLIMIT_NOFILE, (n_open + 10, usual[1]))
    try:
        write_together({tmp_path / str(number): b"new" for number in range(40)})
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, usual)
    assert sorted(int(file.name) for file in tmp_path.iterdir()) == list(range(40))


def test_where_one_of_several_files_cannot_be_written_none_appears(tmp_path):
    (tmp_path / "b").mkdir()
    with pytest.raises(RulecError, match="it is a folder"):
        write_together({tmp_path / name: b"new" for name in "abc"})
    assert [file.name for file in tmp_path.iterdir()] == ["b"]


def test_a_file_that_cannot_be_renamed_in_the_end_is_a_message(tmp_path, monkeypatch):
    def refused(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", refused)
    with pytest.raises(RulecError, match="no space left"):
        write_together({tmp_path / name: b"new" for name in "ab"})
    assert list(tmp_path.iterdir()) == []

"""Texts from any editor, and files that appear whole or not at all."""

import errno
import gzip
import io
import os
import resource
import shutil
import signal
import unicodedata
from functools import partial
from pathlib import Path

import pytest

from rulec.diagnostics import RulecError
from rulec.files import read_files, written_files
from rulec.files.file_sets import MANIFEST, write_together
from rulec.files.read_files import decoded, opened
from rulec.files.written_files import refusals, written_whole


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


@pytest.mark.parametrize(
    ("number", "way_out"),
    [
        (errno.EROFS, "give a file in a folder that may be written to"),
        (errno.ENOSPC, "make room there, or give a file on another disk"),
        (errno.EACCES, "change its permissions, or give a file in a folder that you may write to"),
    ],
)
def test_what_cannot_be_written_has_a_way_out(number, way_out, tmp_path):
    with pytest.raises(RulecError) as problem, refusals(tmp_path / "out"):
        raise OSError(number, os.strerror(number))
    assert problem.value.diagnostics[0].help == way_out


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
    monkeypatch.setattr(read_files, "LARGEST_UNPACKED", 1000)
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
        write_together(tmp_path, {str(number): b"new" for number in range(40)})
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, usual)
    assert sorted(int(file.name) for file in tmp_path.iterdir()) == list(range(40))


def test_where_one_of_several_files_cannot_be_written_none_appears(tmp_path):
    (tmp_path / "b").mkdir()
    with pytest.raises(RulecError, match="it is a folder"):
        write_together(tmp_path, dict.fromkeys("abc", b"new"))
    assert [file.name for file in tmp_path.iterdir()] == ["b"]


def test_a_file_that_cannot_be_renamed_in_the_end_is_a_message(tmp_path, monkeypatch):
    def refused(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", refused)
    with pytest.raises(RulecError, match="no space left"):
        write_together(tmp_path, dict.fromkeys("ab", b"new"))
    assert list(tmp_path.iterdir()) == []


class Killed(BaseException):
    """What stands for SIGKILL, behind which nothing is cleaned up."""


def killed_after(n, write, monkeypatch):
    """Do what writes, killed before its n-th change of a folder; whether that came to it."""
    left = [n]

    def counted(real, *arguments, **more):
        if left[0] <= 0:
            raise Killed
        left[0] -= 1
        return real(*arguments, **more)

    with monkeypatch.context() as patch:
        for step in ("replace", "unlink"):
            patch.setattr(os, step, partial(counted, getattr(os, step)))
        try:
            write()
        except Killed:
            return True
    return False


def test_a_set_that_was_killed_is_finished_or_undone_by_the_next(tmp_path, monkeypatch):
    new = dict.fromkeys("abc", b"new")
    for n in range(100):
        for name in new:
            (tmp_path / name).write_bytes(b"old")
        if not killed_after(n, lambda: write_together(tmp_path, new), monkeypatch):
            break
        is_begun = (tmp_path / MANIFEST).exists()
        write_together(tmp_path, {"d": b""})
        now = {(tmp_path / name).read_bytes() for name in new}
        assert now == {b"new"} if is_begun else now in ({b"old"}, {b"new"})
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b", "c", "d"]
    assert 4 <= n < 100


def interrupted_before(n, write, monkeypatch):
    """Do what writes; Ctrl-C comes before its n-th call to the system. Whether it came to it."""
    left = [n]

    def counted(real, *arguments, **more):
        left[0] -= 1
        if left[0] == -1:
            os.kill(os.getpid(), signal.SIGINT)
        return real(*arguments, **more)

    with monkeypatch.context() as patch:
        for step in ("replace", "unlink", "open", "fsync", "fstat", "scandir", "stat", "close"):
            patch.setattr(os, step, partial(counted, getattr(os, step)))
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            write()
        except KeyboardInterrupt:
            return True
        finally:
            signal.signal(signal.SIGINT, before)
    return False


def test_a_set_that_is_interrupted_is_whole_and_leaves_nothing_else(tmp_path, monkeypatch):
    new = dict.fromkeys("abc", b"new")
    found = []
    for n in range(300):
        for name in new:
            (tmp_path / name).write_bytes(b"old")
        if not interrupted_before(n, lambda: write_together(tmp_path, new), monkeypatch):
            break
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b", "c"]
        (content,) = {(tmp_path / name).read_bytes() for name in new}
        found.append(content)
    assert 20 <= n < 300
    assert set(found) == {b"old", b"new"}
    assert found == sorted(found, reverse=True)


@pytest.mark.parametrize(
    "planted",
    [
        '{"inode": 5, "files": {".rulec-0123456789abcdef-0.part": ["../victim", 1, 1]}}',
        '{"inode": 5, "files": {"../secret": ["b", 1, 1]}}',
        '{"inode": 5, "files": {".rulec-0123456789abcdef-0.part": 5}}',
        "[" * 100_000,
        "[]",
    ],
)
def test_a_planted_manifest_reaches_nothing_elsewhere(planted, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (tmp_path / "victim").write_text("victim")
    (tmp_path / "secret").write_text("secret")
    (folder / ".rulec-0123456789abcdef-0.part").symlink_to("../secret")
    (folder / MANIFEST).write_text(planted)
    write_together(folder, {"a": b"new"})
    assert (tmp_path / "victim").read_text() == "victim"
    assert (tmp_path / "secret").read_text() == "secret"
    assert not (folder / MANIFEST).exists()


def test_a_manifest_that_comes_with_a_checkout_is_not_obeyed(tmp_path, monkeypatch):
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ours.mkdir()
    for n in range(100):
        (ours / "a").write_bytes(b"old")
        killed_after(n, lambda: write_together(ours, {"a": b"new"}), monkeypatch)
        if (ours / MANIFEST).exists():
            break
    shutil.copytree(ours, theirs)
    for folder, content in ((ours, b"new"), (theirs, b"old")):
        write_together(folder, {"d": b""})
        assert (folder / "a").read_bytes() == content
        assert sorted(path.name for path in folder.iterdir()) == ["a", "d"]


@pytest.mark.parametrize("code", ["R0730", "R0731"])
def test_a_set_is_written_neither_through_links_out_nor_into_pipes(code, tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    (tmp_path / "target").write_text("old")
    if code == "R0730":
        (folder / "b").symlink_to("../target")
    else:
        os.mkfifo(folder / "b")
    with pytest.raises(RulecError) as caught:
        write_together(folder, dict.fromkeys("ab", b"new"))
    assert [one.code for one in caught.value.diagnostics] == [code]
    assert [path.name for path in folder.iterdir()] == ["b"]
    assert (tmp_path / "target").read_text() == "old"


def test_one_file_is_not_written_through_a_link_out_of_its_tree(tmp_path):
    (tmp_path / "tree").mkdir()
    (tmp_path / "target").write_text("old")
    (tmp_path / "tree" / "out").symlink_to("../target")
    with pytest.raises(RulecError) as caught, written_whole(tmp_path / "tree" / "out"):
        pass
    assert caught.value.diagnostics[0].code == "R0730"
    assert (tmp_path / "target").read_text() == "old"


def test_the_longest_names_can_be_written(tmp_path):
    file = tmp_path / ("ü" * 127 + "x")
    for _ in range(2):
        with written_whole(file) as stream:
            stream.write(b"new")
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


@pytest.mark.skipif(os.getuid() != 0, reason="only root gives files away")
def test_an_owner_is_kept(tmp_path):
    file = tmp_path / "file"
    file.write_text("old")
    os.chown(file, 1234, 2345)
    file.chmod(0o640)
    with written_whole(file, in_place=True) as stream:
        stream.write(b"new")
    now = file.stat()
    assert (now.st_uid, now.st_gid, now.st_mode & 0o777) == (1234, 2345, 0o640)


def test_an_owner_who_cannot_be_kept_and_a_second_name_are_reasons_not_to(tmp_path, monkeypatch):
    file = tmp_path / "file"
    file.write_text("old")

    def code_of_writing():
        with pytest.raises(RulecError) as caught, written_whole(file, in_place=True) as stream:
            stream.write(b"new")
        return caught.value.diagnostics[0].code

    with monkeypatch.context() as patch:
        patch.setattr(written_files, "as_before", lambda name, path: False)
        assert code_of_writing() == "R0734"
    os.link(file, tmp_path / "other")
    assert code_of_writing() == "R0734"
    assert file.read_text() == "old"

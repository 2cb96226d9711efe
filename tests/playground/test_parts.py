"""What the page is put together from, and what is said where a part cannot be had."""

import re
from zipfile import ZipFile

import pytest

from tools import programs
from tools.playground import __main__ as playground
from tools.playground import parts
from tools.playground.parts import HERE
from tools.programs import MissingPartError


def test_libraries_are_python_alone_and_the_same_each_time(tmp_path):
    files = [tmp_path / name for name in ("one.zip", "other.zip")]
    for file in files:
        parts.put_libraries(file)
    assert files[0].read_bytes() == files[1].read_bytes()
    names = ZipFile(files[0]).namelist()
    assert {"lark/lark.py", "click/core.py"} < set(names)
    assert not [name for name in names if re.search(r"\.(so|pyd|pyx|c)$", name)]
    assert any("LICENSE" in name and name.startswith("lark-") for name in names)


def test_a_library_that_is_not_there_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(parts, "LIBRARIES", ("no-such-library",))
    with pytest.raises(MissingPartError, match="no-such-library is not installed"):
        parts.put_libraries(tmp_path / "libraries.zip")


def test_without_npm_there_is_a_way_out_and_nothing_is_written(monkeypatch, tmp_path):
    monkeypatch.setattr(programs.shutil, "which", lambda _: None)
    with pytest.raises(MissingPartError, match=r"install Node\.js"):
        playground.build(tmp_path / "page")
    assert list(tmp_path.iterdir()) == []


def test_what_a_failing_tool_says_is_passed_on(tmp_path):
    (tmp_path / "tool").write_text("#!/bin/sh\necho no network; exit 3\n")
    (tmp_path / "tool").chmod(0o755)
    with pytest.raises(MissingPartError, match="tool ended with 3:\nno network"):
        programs.run([tmp_path / "tool"], tmp_path)


def test_a_folder_with_other_files_is_left_alone(tmp_path, monkeypatch, capsys):
    (tmp_path / "letters.txt").write_text("dear all")
    monkeypatch.setattr("sys.argv", ["playground", "-o", str(tmp_path)])
    assert playground.main() == 2
    assert "contains other files" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["letters.txt"]


def test_every_file_that_the_page_names_is_a_part_of_it():
    made = {"words.json", "samples.json", playground.MARK, "LICENSE"}
    sources = {path.name: path.read_text(encoding="utf-8") for path in (HERE / "page").iterdir()}
    named = {
        name
        for text in sources.values()
        for name in re.findall(r'"(?:\./)?([\w-]+\.(?:js|css|json))"|href="(LICENSE)"', text)
        for name in name
        if name
    }
    assert named == (sources.keys() | made) - {"index.html"}


def test_nothing_comes_from_another_host():
    for path in (HERE / "page").iterdir():
        assert not re.search(r"https?://", path.read_text(encoding="utf-8")), path.name

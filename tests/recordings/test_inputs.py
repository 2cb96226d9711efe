"""The files that are meant by paths, folders and patterns."""

import gzip
import os
from pathlib import Path

import pytest

from rulec.recordings.recording_inputs import input_files
from support.builders.recordings import ROAD_XML
from support.mutations.format_samples import RECORDINGS


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Two scenarios, one of them packed and deeper; a net, notes, and a hidden scenario."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drives" / "deep").mkdir(parents=True)
    (tmp_path / "drives" / ".git").mkdir()
    (tmp_path / "drives" / "b.xml").write_text(ROAD_XML)
    (tmp_path / "drives" / "deep" / "a.xml.gz").write_bytes(gzip.compress(ROAD_XML.encode()))
    (tmp_path / "drives" / "road.net.xml").write_text("<net/>")
    (tmp_path / "drives" / "notes.txt").write_text("no traffic")
    (tmp_path / "drives" / "traces.jsonl").write_text('{"states": []}')
    (tmp_path / "drives" / ".git" / "c.xml").write_text(ROAD_XML)
    (tmp_path / "drives" / ".d.xml").write_text(ROAD_XML)
    return tmp_path


def test_a_folder_stands_for_the_recordings_in_and_below_it(folder):
    found = input_files(["drives"])
    assert found.paths == ("drives/b.xml", "drives/deep/a.xml.gz")
    (searched,) = found.searched
    assert (searched.path, searched.recordings) == ("drives", 2)
    assert {file.path: file.why for file in searched.left_alone} == {
        "drives/notes.txt": "without recorded traffic",
        "drives/road.net.xml": "without recorded traffic",
        "drives/traces.jsonl": "of rulec's own",
    }
    assert searched.in_words == (
        "2 recordings in drives; left alone: 2 without recorded traffic (drives/notes.txt, "
        "drives/road.net.xml); 1 of rulec's own (drives/traces.jsonl)"
    )
    assert found.problems == ()


def test_a_pattern_is_wild_where_no_file_is_called_so(folder):
    assert input_files(["drives/*.xml"]).paths == ("drives/b.xml", "drives/road.net.xml")
    assert input_files(["drives/**/*.gz"]).paths == ("drives/deep/a.xml.gz",)
    (folder / "drives" / "[1].xml").write_text(ROAD_XML)
    assert input_files(["drives/[1].xml"]).paths == ("drives/[1].xml",)


def test_every_file_once_and_in_the_order_that_is_given(folder):
    found = input_files(["drives/deep/a.xml.gz", "-", "drives", "no_such.xml"])
    assert found.paths == ("drives/deep/a.xml.gz", "-", "drives/b.xml", "no_such.xml")


def test_a_pattern_like_which_nothing_is_called(folder):
    found = input_files(["drives/b.xml", "*.osi"])
    assert found.paths == ("drives/b.xml",)
    (problem,) = found.problems
    assert (problem.diagnostics[0].code, problem.diagnostics[0].place.file) == ("R0701", "*.osi")


def test_a_folder_without_recordings(folder):
    (folder / "empty").mkdir()
    found = input_files(["empty"])
    (problem,) = found.problems
    assert found.paths == ()
    assert "there is no recorded traffic in this folder" in problem.diagnostics[0].message
    assert "formats that are read" in problem.diagnostics[0].help
    (folder / "empty" / "t.jsonl").write_text("{}")
    (problem,) = input_files(["empty"]).problems
    assert problem.diagnostics[0].help.endswith("traces are given by files, as by `empty/*.jsonl`")


def test_a_broken_file_of_a_folder_is_not_passed_over(folder):
    # Whoever reads it says what is wrong with it.
    (folder / "drives" / "c.xml").write_text("<commonRoad")
    (folder / "drives" / "d.xml").write_bytes(gzip.compress(ROAD_XML.encode())[:9])
    paths = input_files(["drives"]).paths
    assert {"drives/c.xml", "drives/d.xml"} <= set(paths)


def test_parts_of_a_scenario_are_one_recording(folder):
    parts = folder / "parts"
    parts.mkdir()
    for name in ("DEU_A-1.pb", "DEU_A-1_1_T-1.pb", "DEU_A-1_1_T-1-SC.pb", "DEU_B-2_1_T-1.pb"):
        (parts / name).write_bytes(b"\n")
    assert input_files(["parts"]).paths == ("parts/DEU_A-1_1_T-1.pb", "parts/DEU_B-2_1_T-1.pb")


def test_links_are_not_followed_and_pipes_not_opened(folder):
    (folder / "drives" / "loop").symlink_to(folder / "drives", target_is_directory=True)
    os.mkfifo(folder / "drives" / "pipe.xml")
    assert input_files(["drives"]).paths == ("drives/b.xml", "drives/deep/a.xml.gz")


def test_links_out_of_the_folder_are_refused_and_the_rest_is_read(folder):
    (folder / "drives" / "out.xml").symlink_to("/etc/hostname")
    found = input_files(["drives"])
    assert found.paths == ("drives/b.xml", "drives/deep/a.xml.gz")
    assert [one.code for error in found.problems for one in error.diagnostics] == ["R0730"]


def test_links_out_of_the_tree_that_a_pattern_matches_are_refused(folder):
    (folder / "drives" / "out.xml").symlink_to("/etc/hostname")
    found = input_files(["drives/*.xml"])
    assert found.paths == ("drives/b.xml", "drives/road.net.xml")
    assert [one.code for error in found.problems for one in error.diagnostics] == ["R0730"]


@pytest.mark.parametrize("name", RECORDINGS)
def test_what_lies_beside_a_recording_is_passed_over(tmp_path, name):
    """Maps, types, meta files and other parts of it are counted, and not judged one by one."""
    for number, sample in enumerate(RECORDINGS[name]()):
        folder = tmp_path / str(number)
        files = sample.packed()
        for key, file in files.items():
            (folder / key).parent.mkdir(parents=True, exist_ok=True)
            (folder / key).write_bytes(file.whole())
        found = input_files([str(folder)])
        assert found.problems == ()
        if found.searched:
            # A map or problems in a file of its own name the others, and may be asked for
            (path,) = found.paths
            assert path == str(folder / sample.entry.replace("-SC.pb", ".pb"))
            (searched,) = found.searched
            assert (searched.path, searched.recordings) == (str(folder), 1)
            beside = {folder / key for key in files} - {Path(path)}
            assert {Path(file.path) for file in searched.left_alone} == beside
        else:
            assert found.paths == (str(folder),)

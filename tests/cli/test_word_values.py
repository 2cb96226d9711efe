"""`rulec explain WORD FILE`: the values of a word by time, and where they are not known."""

import json

import pytest

from rulec.cli.main import main

BOOK = """rulebook b
type car
quantity speed in km/h default 0
quantity gap(c: car) in m default 100
signal near(c: car) default false
place is one of here, there default here
define near(c: car) = gap(c) < 5 m
hard rule r(c: car) { require always (near(c) implies speed < 10 km/h or here) }
"""
STATES = [
    {"speed": 10, "gap": {"v": 3, "w": 50}},
    {"speed": {"from": 10, "to": 12}, "gap": {"v": 4, "w": 50}},
    {"speed": None, "gap": {"v": {"from": 4, "to": 6}, "w": 50}, "place": "there"},
    {"speed": 20, "gap": {"v": 9, "w": 50}, "place": "there"},
]


def said(capsys, *arguments):
    status = main([*arguments])
    own = capsys.readouterr()
    return status, own.out + own.err


@pytest.fixture
def files(tmp_path):
    book, trace = tmp_path / "b.rules", tmp_path / "t.jsonl"
    book.write_text(BOOK)
    told = ["speed", "gap", "place", "car"]
    whole = {"id": "a", "step_s": 0.5, "objects": {"v": "car", "w": "car"}, "states": STATES}
    trace.write_text(json.dumps({**whole, "told": told}))
    return str(book), str(trace)


def test_a_defined_word(files, capsys):
    book, trace = files
    status, text = said(capsys, "explain", "near", trace, "-r", book)
    assert status == 0
    assert text.splitlines()[1:] == [
        "  near of v: 0 to 0.5 s: yes",
        "  near of v: 1 s: not known",
        "  near of v: 1.5 s: no",
        "  near of w: 0 to 1.5 s: no",
    ]


def test_a_number_and_a_value(files, capsys):
    book, trace = files
    lines = said(capsys, "explain", "speed", trace, "-r", book)[1].splitlines()
    assert lines[1:] == [
        "  0 to 0.5 s: 10 to 12 km/h, each known within 2 km/h",
        "  1 s: not known",
        "  1.5 s: 20 km/h",
    ]
    lines = said(capsys, "explain", "there", trace, "-r", book)[1].splitlines()
    assert lines[1:] == ["  0 to 0.5 s: here", "  1 to 1.5 s: there"]


def test_as_json(files, capsys):
    book, trace = files
    _, text = said(capsys, "explain", "near", trace, "-r", book, "--output-format", "json")
    first = json.loads(text.splitlines()[0])
    assert (first["objects"], first["value"], first["to_s"]) == ({"near of": "v"}, "yes", 0.5)


def test_no_such_word(files, capsys):
    book, trace = files
    status, text = said(capsys, "explain", "nears", trace, "-r", book)
    assert status == 2
    assert "nears" in text


@pytest.mark.parametrize(
    ("file", "problem"),
    [
        ("none.xml", "no such file or directory"),
        ("no*.xml", "no file is called like that"),
        (".", "there is no recorded traffic in this folder"),
    ],
)
def test_files_that_are_not_there(file, problem, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, text = said(capsys, "explain", "gap", file)
    assert status == 2
    assert problem in text
    assert "vocabulary" not in text

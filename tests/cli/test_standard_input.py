"""`-` is standard input where a rulebook or a saved monitor is meant, whatever files are called."""

import io
import json
import os

import pytest

from rulec.cli.main import main
from rulec.files.read_files import STANDARD_INPUT_COPY

WORDS = "vocabulary words { signal p default false }"
MINE = "rulebook mine\nuse words\nhard rule r { require always p }\n"
OTHER = "rulebook other\nuse words\nhard rule r { require always not p }\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in (("words", WORDS), ("other", OTHER), ("standard input", OTHER), ("-", "no")):
        (tmp_path / f"{name}.rules").write_text(text)
    (tmp_path / "-").write_text("not this")
    trace = {"id": "t", "step_s": 1, "states": [{"p": False}]}
    (tmp_path / "t.jsonl").write_text(json.dumps(trace))
    return tmp_path


@pytest.fixture
def given(monkeypatch, capsys):
    def call(data, *arguments):
        stream = io.TextIOWrapper(io.BytesIO(data.encode() if isinstance(data, str) else data))
        monkeypatch.setattr("sys.stdin", stream)
        status = main(arguments)
        assert STANDARD_INPUT_COPY not in os.environ
        return status, *capsys.readouterr()

    return call


def test_a_source_is_read_with_the_vocabulary_of_the_working_folder(given):
    assert given(MINE, "show", "-")[0] == 0
    assert given(MINE, "verify", "t.jsonl", "-r", "-")[0] == 1


def test_a_compiled_rulebook_is_one_too(given, folder):
    assert given(MINE, "compile", "-", "-o", "out")[0] == 0
    compiled = (folder / "out" / "mine.json").read_bytes()
    assert given(compiled, "verify", "t.jsonl", "-r", "-")[0] == 1


def test_what_is_wrong_with_it_is_said_by_a_name_that_no_file_has(given):
    status, _, err = given(MINE.replace("always p", "always q"), "test", "-")
    assert status == 2
    assert "standard input 2.rules:3:" in err


@pytest.mark.parametrize(
    "arguments",
    [
        ["verify", "-", "-r", "-"],
        ["diff", "-", "-"],
        ["monitor", "-"],
        ["show", "--audit", "-", "--compare", "-"],
    ],
)
def test_it_is_one_thing(given, arguments):
    status, _, err = given(MINE, *arguments)
    assert status == 2
    assert "standard input" in err


def test_a_saved_monitor_may_be_its_first_line(given, folder):
    assert (
        given('{"state": {"p": true}}\n', "monitor", "./other.rules", "--save", "saved.json")[0]
        == 1
    )
    saved = (folder / "saved.json").read_text()
    status, out, _ = given(
        f'{saved}{{"state": {{"p": false}}}}\n', "monitor", "./other.rules", "--restore", "-"
    )
    assert (status, len(out.splitlines())) == (1, 1)
    assert (
        "R0510"
        in given('{"state": {"p": false}}\n', "monitor", "./other.rules", "--restore", "-")[2]
    )


LAW = "# Act\n\n### Article 1 Keeping right\n\n(1) Keep right.\n"


@pytest.mark.parametrize(
    ("data", "arguments", "says"),
    [
        (LAW, ["show", "--audit", "./other.rules", "--law", "-"], ""),
        (
            "# no articles",
            ["show", "--audit", "./other.rules", "--law", "-"],
            "standard input 2.rules",
        ),
        ("{}", ["compile", "--check", "-"], "standard input.json"),
        ("{}", ["maneuvers", "s1", "-r", "./other.rules", "--after", "-"], "standard input.json"),
        ("", ["maneuvers", "s1", "-r", "./other.rules", "--after", "-"], "standard input\n"),
    ],
)
def test_other_files_may_come_by_it_too(data, arguments, says, given):
    status, _, err = given(data, *arguments)
    assert (status, says in err) == (2 if says else 0, True), err


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["rates", "-"], "by their file's name"),
        (["fleet", "-", "-r", "./other.rules", "-o", "out"], "each process reads"),
        (["find", "p", "t.jsonl", "-u", "-"], "found by its name"),
    ],
)
def test_where_it_cannot_be_the_reason_is_said(arguments, why, given):
    status, _, err = given("", *arguments)
    assert (status, "`-` is standard input" in err, why in err) == (2, True, True), err

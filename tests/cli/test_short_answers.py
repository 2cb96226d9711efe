"""What was found comes first, and fits a screen: at most 12 lines, and 6 for each violated rule."""

import re
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.report.text.terminal_text import cell_width
from support.builders.recorded_data import DATA

ENDINGS = (".xml", ".pb", ".osi", ".mcap", ".pkl", ".parquet", ".tfrecord", ".gz")
SAMPLES = ["docs/samples/following.xml", "docs/samples/passing.fcd.xml"]
SHARED = [
    pytest.param(str(file), marks=pytest.mark.long, id=file.name)
    for file in sorted(DATA.rglob("*"))
    if file.name.endswith(ENDINGS)
]
RULE = re.compile(r"  [\w.]+( \[.*)?: [\d,]+ drives?$")


@pytest.mark.parametrize("book", ["de", "jp"])
@pytest.mark.parametrize("file", [*SAMPLES, *SHARED])
def test_a_recording_is_answered_in_a_dozen_lines(file, book, capsys):
    status = main(["verify", file, "-r", book])
    captured = capsys.readouterr()
    lines = captured.out.splitlines()
    if not lines:
        # A map, or a file that no reader takes for a recording
        assert status == 2
        assert "error[R" in captured.err
        return
    violated = [line for line in lines if RULE.fullmatch(line) or line.endswith(" …")]
    rules = [line for line in violated if re.match(r"  \S", line)]
    assert len(lines) <= 12 + 6 * len(rules), lines
    assert [line for line in lines if cell_width(line) > 80] == []
    assert bool(rules) or status != 1
    assert not any("satisfied" in line for line in lines)


SAID = {
    "show": (["show", "de"], 110),
    "diff": (["diff", "de", "fr"], 60),
    "test": (["test", "de"], 3),
    "tree": (["show", "--tree", "de"], 40),
    "audit": (["show", "--audit", "de"], 40),
    "test --coverage": (["test", "de", "--coverage"], 40),
    "diff --topic": (["diff", "de", "fr", "gb", "--topic", "overtaking"], 50),
    "maneuvers": (["maneuvers", SAMPLES[0], "-r", "de", "--ego", "1", "--list", "1"], 30),
}


@pytest.mark.parametrize("verb", SAID)
def test_a_verb_is_answered_on_a_screen(verb, capsys):
    arguments, most = SAID[verb]
    main(arguments)
    lines = capsys.readouterr().out.splitlines()
    assert 0 < len(lines) <= most


def test_a_new_book_begins_with_what_its_law_decides(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "x", "--extends", "vienna"]) == 0
    assert len(Path("x.rules").read_text(encoding="utf-8").splitlines()) <= 80

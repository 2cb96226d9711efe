"""No line of an answer is wider than the terminal, nor than 80 columns in a pipe."""

import fcntl
import os
import pty
import struct
import sys
import termios
from pathlib import Path
from threading import Thread

import pytest
from click import unstyle

from rulec.cli.main import main
from rulec.report.text.terminal_text import cell_width

OWN = """\
rulebook own
extends esterle2019
drop rule R2 because "It is no rule of ours, whatever others may think about it, and we say so."
override rule R3 (p: pedestrian) {
  cite    "Own Act on Pedestrians, Crossings, and What Vehicles Have to Do There, Art. 123(4)(a)"
  says    "Stop for people who are on a crossing, or want to be, or look as if they did."
  require always not f(p)
  accept  { b(p) }
  reject  { f(p) }
}
hard rule a_rule_whose_name_alone_takes_half_of_a_line_or_more_of_it (v: vehicle) {
  cite    "道路交通法第二十条及び第二十一条の規定による車両の通行に関する規則その他の関係法令の規定"
  says    "車両は道路の左側端に寄つて通行しなければならない。ただし、他の車両を追い越すときは、"
  require always (b(v) and not CONGESTED implies next (b(v) or l(v) or r(v)) or CONGESTED)
}
"""

SAMPLES = Path(__file__).parents[2] / "docs" / "samples"
FOLLOWING, PASSING = str(SAMPLES / "following.xml"), str(SAMPLES / "passing.fcd.xml")
TRACES = str(SAMPLES / "traces.jsonl")

ANSWERS = {
    "list": ["list"],
    "list codes": ["list", "codes"],
    "list rules": ["list", "rules", "vienna", "jp", "--topic", "overtaking"],
    "show": ["show", "jp"],
    "show own": ["show", "./own.rules"],
    "show --all": ["show", "vienna", "--all"],
    "show RULE": ["show", "vienna", "overtaking_without_sight"],
    "show own RULE": [
        "show",
        "./own.rules",
        "a_rule_whose_name_alone_takes_half_of_a_line_or_more_of_it",
    ],
    "diff": ["diff", "esterle2019", "./own.rules"],
    "diff -v": ["diff", "esterle2019", "./own.rules", "-v"],
    "diff RULE": ["diff", "vienna", "at", "overtaking_without_sight"],
    "diff --topic": ["diff", "jp", "vienna", "us-ca", "--topic", "overtaking"],
    "diff --topic -v": ["diff", "jp", "vienna", "--topic", "overtaking", "-v"],
    "diff --all": ["diff", "--all", "esterle2019", "./own.rules"],
    "tree": ["show", "--tree", "us-ca"],
    "tree --all": ["show", "--tree", "us-ca", "--all"],
    "tree of all": ["show", "--tree"],
    "audit": ["show", "--audit", "jp"],
    "audit --all": ["show", "--audit", "jp", "./own.rules", "--all"],
    "audit --compare": ["show", "--audit", "./own.rules", "--compare", "esterle2019"],
    "audit --source": ["show", "--audit", "vienna", "--source", "commonroad"],
    "test": ["test", "./own.rules"],
    "test --coverage": ["test", "./own.rules", "--coverage"],
    "test -v": ["test", "./own.rules", "--coverage", "-v"],
    "analyze": ["analyze", "./own.rules"],
    "test of what fails": ["test", "./wrong.rules"],
    "check": ["check", "./own.rules"],
    "check of what is wrong": ["check", "./misspelt.rules"],
    "explain WORD": ["explain", "lane_change", "time_to_react"],
    "explain CODE": ["explain", "R0201"],
    "help": ["help", "diff"],
    "verify": ["verify", FOLLOWING, "-r", "de"],
    "verify --why": ["verify", FOLLOWING, "-r", "de", "--why", "--explain", "2"],
    "verify traces": ["verify", TRACES, "-r", "esterle2019"],
    "verify by books": ["verify", FOLLOWING, "-r", "de", "-r", "fr", "-r", "jp", "-r", "us-ca"],
    "verify files": ["verify", FOLLOWING, PASSING, "-r", "de"],
    "maneuvers": ["maneuvers", FOLLOWING, "-r", "de", "--ego", "1", "--list", "2", "--why"],
    "maneuvers of the paper": ["maneuvers", "s2", "-r", "esterle2019", "--rank", "2"],
    "maneuvers by books": ["maneuvers", "s1", "s2", "-r", "esterle2019", "-r", "./own.rules"],
    "find": ["find", "(v: vehicle) gap(v) < 20 m", FOLLOWING],
    "formats": ["list", "formats"],
    "fleet": ["fleet", FOLLOWING, "-r", "de", "-r", "fr", "-o", "findings"],
}
"""Each verb's answers. In a pipe, messages about mistakes keep to one line, for other programs."""

PIPE = 80


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("COLUMNS", raising=False)
    wrong = OWN.replace("accept  { b(p) }", 'accept "of whom one does not know whether" { f(p) }')
    misspelt = OWN.replace("next (b(v)", "next (b_is_not_a_word_of_this_vocabulary(v)")
    for name, text in (("own", OWN), ("wrong", wrong), ("misspelt", misspelt)):
        (tmp_path / f"{name}.rules").write_text(text, encoding="utf-8")


def in_terminal(arguments, columns, monkeypatch):
    """What a command prints on a pseudo-terminal of a width."""
    master, slave = pty.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    printed = []

    def read():
        try:
            while part := os.read(master, 65536):
                printed.append(part)
        except OSError:  # nobody writes to it any more
            pass

    reader = Thread(target=read)
    reader.start()
    before = os.dup(1)
    os.dup2(slave, 1)
    try:
        with os.fdopen(slave, "w", encoding="utf-8") as stream, monkeypatch.context() as patch:
            patch.setattr(sys, "stdout", stream)
            main(arguments)
    finally:
        os.dup2(before, 1)
        os.close(before)
    reader.join()
    os.close(master)
    return b"".join(printed).decode().replace("\r\n", "\n")


def too_wide(text, columns):
    return [line for line in unstyle(text).splitlines() if cell_width(line) > columns]


@pytest.mark.parametrize("columns", [60, 80, 120])
@pytest.mark.parametrize("answer", ANSWERS)
def test_on_a_terminal(answer, columns, folder, monkeypatch, capsys):
    text = in_terminal(ANSWERS[answer], columns, monkeypatch)
    assert text.strip()
    assert too_wide(text, columns) == []


@pytest.mark.parametrize("answer", [name for name in ANSWERS if " of what " not in name])
def test_in_a_pipe(answer, folder, capsys):
    main(ANSWERS[answer])
    text = capsys.readouterr().out
    assert text.strip()
    assert too_wide(text, PIPE) == []


def test_a_terminal_s_width_is_used(folder, monkeypatch, capsys):
    narrow, wide = (in_terminal(["show", "vienna"], columns, monkeypatch) for columns in (60, 120))
    assert len(wide) > 1.3 * len(narrow)
    assert len(narrow.splitlines()) <= len(wide.splitlines()) + 2

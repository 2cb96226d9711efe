"""Whole texts that people read, as they were when somebody last read them.

A change of words shows here as a difference: read it, then let ``pytest --refresh-snapshots`` store
the texts.
"""

from pathlib import Path

import pytest

from rulec.cli.main import main
from support.snapshots import timeless

ROOT = Path(__file__).resolve().parents[2]
TRACES = "docs/samples/traces.jsonl"
RECORDING = "docs/samples/passing.fcd.xml"

FAILING = """\
rulebook failing
use paper
hard rule calm {
  says    "Never congested."
  require never CONGESTED
  accept  { CONGESTED }
  reject  { CONGESTED }
}
"""
WRONG = """\
rulebook wrong
use paper
hard rule calm {
  require never CONGESTD
  accept  { CONGESTED }
}
"""
UNLIKE = """\
rulebook unlike
extends esterle2019
drop rule R2 because "It is not ours."
override rule R3 (p: pedestrian) {
  require always not f(p)
  accept  { b(p) }
  reject  { f(p) }
}
"""

TEXTS = {
    "verify_explained": ["verify", TRACES, "-r", "esterle2019", "--explain", "5"],
    "verify_every_part": ["verify", TRACES, "-r", "esterle2019", "--explain", "5", "--every-part"],
    "recording_table": ["verify", RECORDING, "-r", "de", "--explain", "0"],
    "maneuvers": ["maneuvers", "s1", "-r", "esterle2019", "--list", "2"],
    "maneuvers_why": ["maneuvers", "s2", "-r", "esterle2019", "--why", "--rank", "2"],
    "maneuvers_classes": ["maneuvers", "s1", "-r", "esterle2019", "--classes", "2"],
    "diff": ["diff", "esterle2019", "UNLIKE", "--at", "2020-01-01", "-v"],
    "diff_markdown": [
        "diff",
        "esterle2019",
        "UNLIKE",
        "--output-format",
        "markdown",
        "--at",
        "2020-01-01",
    ],
    "diff_csv": ["diff", "esterle2019", "UNLIKE", "--output-format", "csv", "--at", "2020-01-01"],
    "diff_all": ["diff", "--all", "esterle2019", "UNLIKE", "--at", "2020-01-01"],
    "test": ["test", "esterle2019", "--coverage", "-v"],
    "test_failing": ["test", "FAILING", "--coverage", "-v"],
    "test_junit": ["test", "FAILING", "--output-format", "junit"],
    "check": ["check", "WRONG"],
    "check_concise": ["check", "WRONG", "--output-format", "concise"],
    "check_github": ["check", "WRONG", "--output-format", "github"],
    "show_brief": ["show", "esterle2019", "--all"],
    "show_rule": ["show", "esterle2019", "R1"],
    "automaton": ["show", "esterle2019", "R3", "--automaton", "text"],
    "automaton_dot": ["show", "esterle2019", "R3", "--automaton", "dot"],
    "automaton_svg": ["show", "esterle2019", "R3", "--automaton", "svg"],
    "audit": ["show", "--audit", "esterle2019", "--all"],
    "audit_markdown": [
        "show",
        "--audit",
        "UNLIKE",
        "--output-format",
        "markdown",
        "--at",
        "2020-01-01",
    ],
    "tree": ["show", "--tree", "UNLIKE", "--at", "2020-01-01", "--all"],
    "tree_all": ["show", "--tree"],
    "explain": ["explain", "R0101"],
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_is_as_it_was(name, snapshots, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    paths = {}
    for word, text in (("FAILING", FAILING), ("WRONG", WRONG), ("UNLIKE", UNLIKE)):
        paths[word] = str(tmp_path / f"{word.lower()}.rules")
        Path(paths[word]).write_text(text, encoding="utf-8")
    main([paths.get(argument, argument) for argument in TEXTS[name]])
    written = capsys.readouterr()
    text = f"{written.out}--- standard error\n{written.err}"
    text = text.replace(str(tmp_path), "FOLDER").replace(str(ROOT), "ROOT")
    snapshots.check(name, timeless(text))


def test_no_text_is_left_over(request):
    stored = {path.stem for path in (request.path.parent / "snapshots").iterdir()}
    assert stored == set(TEXTS)

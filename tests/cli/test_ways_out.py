"""What newcomers get wrong, and the way out that they are shown."""

import gzip
import json
import sys
from importlib import metadata

import pytest

from rulec.cli.main import main
from rulec.cli.usage_help import EXAMPLES
from rulec.cli.verb_table import COMMANDS
from rulec.resources import install_command
from rulec.rulebook.files.words_in_files import words_of_vocabularies


def said(capsys, *arguments):
    status = main(list(arguments))
    captured = capsys.readouterr()
    return status, captured.out + captured.err


@pytest.mark.parametrize(
    ("rules", "way_out"),
    [
        (
            "use road\nhard rule r (v: vehicle) { require never standing(v) }",
            "it is defined in the rulebook `schemas`: `extends schemas`, or copy it",
        ),
        (
            "use paper\nhard rule r { require always speed < 50 km/h }",
            "it is a word of the vocabulary `road`: `use road`",
        ),
        (
            "signal p\nhard rule keep right { require always p }",
            "a name is one word: `keep_right`",
        ),
        (
            "param gap_min : length = 1.5\nsignal p\nhard rule r { require always p }",
            "write the unit, such as `1.5 m`",
        ),
        (
            "signal p, q\nhard rule r { require never p require never q }",
            "join them by `and`, or write a rule for each",
        ),
        (
            'signal p\nhard rule r { cite "1" cite "2" require never p }',
            "keep one of them",
        ),
        ("extends germany", "did you mean `de` (Germany)?"),
    ],
)
def test_in_a_rulebook(rules, way_out, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.rules").write_text(f"rulebook mine\n{rules}\n")
    status, text = said(capsys, "check", "./mine.rules")
    assert (status, text.count("  = help: ")) == (1, 1)
    assert f"  = help: {way_out}\n" in text


@pytest.mark.parametrize(
    ("arguments", "way_out"),
    [
        (["show", "germany"], "  = help: did you mean `de` (Germany)?"),
        (
            ["verify", "x"],
            "  = help: `rulec list rulebooks` shows the available ones, such as `de`",
        ),
        (["explain", "spede"], "did you mean the word `speed`?"),
        (["verify", "-r", "de"], "  = help: such as `rulec verify traces.jsonl -r de`"),
        (
            ["verify", "-r", "de"],
            "rulec maneuvers --traces s2 -r de -o traces.jsonl` writes some",
        ),
        (["new"], "  = help: such as `rulec new belgium`"),
        (["compile", "de"], "  = help: such as `rulec compile de -o build/de`"),
        (["doc", "deutschland"], "  = help: did you mean `de` (Germany)?"),
        (["list", "rulebook"], "error: there is no `rulebook`; did you mean `rulebooks`?"),
        (["draw", "de"], "`rulec draw` has no command `de`; it has drive, graph, scene, trace"),
        (["draw", "scen"], "did you mean `scene`?"),
        (["analyze", "de.rules"], "  = help: `de` ships with rulec: leave out `.rules`"),
        (["build", "de"], "did you mean `compile`?"),
        (["de"], "to name a rulebook, put a command before it, as in `rulec check de`"),
        (["show", "R3"], "`R3` is a rule; give its rulebook, too: `rulec show esterle2019 R3`"),
        (
            ["show", "de", "--automaton", "png"],
            "--automaton: there is no `png`; it is one of text,",
        ),
        (["diff", "de"], "with which rulebook is it to be compared? As in `rulec diff de nl`"),
        (["diff", "de", "nl", "fr"], "for 3, use `rulec diff --all de nl fr`"),
        (["test", "de", "--fail"], "no option `--fail`; did you mean `--fail-on-empty`?"),
        (["test", "de", "--own"], "error: there is no option `--own`\n"),
        (["verify", "x", "-r", "de", "-o", "x.html"], "`rulec draw`.\n  = usage"),
        (["maneuvers", "s2", "-r", "de", "--list", "many"], "--list: `many` is no whole number"),
        (["compile", "de", "-o", "x", "--step", "0,5"], "decimals have a point: 0.5"),
        (["verify", "https://x.org/a.xml", "-r", "nl"], "download it first"),
        (["monitor", "de", "fr"], "`fr` is an argument too many\n  = help: it takes one at a time"),
        (
            ["maneuvers", "--traces", "s1", "s2", "-o", "t.csv"],
            "for s in s2 s3; do rulec maneuvers --traces",
        ),
        (
            ["help", "--completion", "bash", "a", "b"],
            "error: `a b` is 2 arguments too many\n  = usage",
        ),
        (["show", "de", "--at"], "error: --at is given without a value"),
        (["check", "--fail-on", "error", "--fail-on", "error"], "--fail-on is given twice"),
        (["show", "de", *(["--at", "2026-01-01"] * 3)], "--at is given 3 times, and takes one"),
        (["show", "de", "--at", "2026"], "error: --at: `2026` is no date: a date is written"),
        (["maneuvers", "x.xml", "--at", "40"], "for a moment in seconds there is `--at-time 40`"),
        (["verify", "--watch"], "no option `--watch` here; `rulec check` and `rulec test` have it"),
        (
            ["monitor", "de", "--rule", "R1"],
            "no option `--rule` here; `rulec verify`, `rulec test`",
        ),
        # An argument's name is nothing to type.
        (["compile", "de", "--rulebok", "x"], "error: there is no option `--rulebok`\n"),
        # A device is not to be removed.
        (["check", "/dev/null"], "  = help: leave it out, or give `-` to read standard input\n"),
        (["explain"], "error: give a code or a word, such as `R0104` or `gap`, or --all\n"),
        (["verify"], "error: `FILE...` is missing\n"),
        (["verify", "x"], "error: `-r` or `--rulebook` is missing\n"),
        (["test", "-r", "de"], "the rulebook is given without `-r`, as in `rulec test de`"),
        (["monitor", "--rulebook", "de"], "without `--rulebook`, as in `rulec monitor de`"),
        (["explain", "-r", "de"], "error: give a code or a word, such as `R0104`"),
        (["rates", "f.csv", "-r", "de"], "the verbs that judge have it, such as `rulec verify`"),
        (
            ["maneuvers", "s2", "-r", "de", "--list", "-1"],
            "error: --list: `-1` is out of range: it is 0 or more\n",
        ),
        (["test", "de", "--fail-under", "101"], "out of range: it is from 0 to 100\n"),
        (["verify", "x.xml", "de"], "  = help: a rulebook is given by `-r de`"),
        (["verify", "x.xml", "mine.rules"], "  = help: a rulebook is given by `-r mine.rules`"),
        (["new", "Belgium 2"], "  = help: such as `belgium_2`"),
        (
            ["maneuvers", "s1", "-r", "esterle2019", "--step", "0.307692"],
            "a step of 0.25 s or 0.4 s",
        ),
    ],
)
def test_in_a_command(arguments, way_out, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, text = said(capsys, *arguments)
    assert status == 2
    assert way_out in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["draw", "scene", "s1", "-o", "s.svg"],
        ["draw", "graph", "s1", "-o", "s.svg"],
        ["draw", "trace", "t.jsonl", "-o", "s.svg"],
        ["draw", "drive", "drive.xml", "-o", "s.svg"],
        ["maneuvers", "--traces", "s1", "-o", "t.csv"],
        ["maneuvers", "--envelopes", "s1", "-o", "e.csv"],
        ["find", "true", "t.jsonl"],
    ],
)
def test_what_is_of_one_rulebook(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "laws").mkdir()
    for rulebooks in (["-r", "de", "-r", "fr"], ["-r", "laws"], ["--rulebook=la*/*.rules"]):
        status, text = said(capsys, *arguments, *rulebooks)
        assert (status, "; give each rulebook a call of its own\n" in text) == (2, True)
    assert [path.name for path in tmp_path.iterdir()] == ["laws"]
    status, text = said(capsys, "monitor", "laws")
    assert (status, "a monitor goes by one rulebook" in text) == (2, True)


def test_a_name_is_a_rulebook_although_a_folder_is_called_so(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "esterle2019").mkdir()
    (tmp_path / "t.jsonl").write_text('{"states": [{"CONGESTED": true}]}')
    assert said(capsys, "find", "CONGESTED", "t.jsonl", "-r", "esterle2019")[0] == 0


def test_an_argument_of_bytes_that_are_no_text(capsys):
    assert main(["show", "\udcff"]) == 2
    assert "is a rule" not in capsys.readouterr().err


@pytest.mark.parametrize("number", ["nan", "inf", "1e400"])
@pytest.mark.parametrize(
    "arguments",
    [
        ("maneuvers", "s2", "-r", "esterle2019", "--at-time"),
        ("maneuvers", "s2", "-r", "esterle2019", "--ego-width"),
        ("maneuvers", "s2", "-r", "esterle2019", "--congested-below"),
        ("draw", "drive", "a.xml", "-r", "esterle2019", "--at-time"),
    ],
)
def test_a_number_that_is_none(arguments, number, capsys):
    assert main([*arguments, number]) == 2
    assert capsys.readouterr().err.startswith(f"error: {arguments[-1]}: ")


def test_a_trace_in_the_words_of_another_vocabulary(tmp_path, capsys):
    trace = tmp_path / "t.jsonl"
    trace.write_text(
        json.dumps({"states": [{"position": {"v": "b"}}], "objects": {"v": "vehicle"}})
    )
    status, text = said(capsys, "verify", str(trace), "-r", "un-r79")
    assert status == 2
    assert "it is a word of the vocabulary `paper`: judge by a rulebook that uses that" in text


def test_a_unit_is_no_word_of_a_vocabulary(tmp_path, capsys):
    trace = tmp_path / "t.jsonl"
    trace.write_text(json.dumps({"states": [{"t": 0}]}))
    status, text = said(capsys, "verify", str(trace), "-r", "esterle2019")
    assert status == 2
    assert "  = help: known: `position`, `surface`, `CONGESTED`\n" in text
    every = words_of_vocabularies()
    assert every["paper"] >= {"vehicle", "position", "b", "CONGESTED"}
    assert every["road"].isdisjoint({"t", "m", "km", "road", "v", "o", "default"})
    assert {"fourth_or_further_lane", "hazard_lights", "gap", "tram"} < every["road"]


@pytest.mark.parametrize(
    ("origin", "has_pip", "command"),
    [
        (None, True, "PYTHON -m pip install 'rulec[rates]'"),
        (None, False, "uv pip install --python PYTHON 'rulec[rates]'"),
        (
            {"url": "file:///a%20b/rulec", "dir_info": {"editable": True}},
            True,
            "PYTHON -m pip install -e '/a b/rulec[rates]'",
        ),
        (
            {"url": "file:///tmp/rulec-1.whl", "archive_info": {}},
            True,
            "PYTHON -m pip install '/tmp/rulec-1.whl[rates]'",
        ),
        ({"url": "https://example.com/rulec"}, True, "PYTHON -m pip install 'rulec[rates]'"),
    ],
)
def test_an_extra_is_installed_where_rulec_runs(origin, has_pip, command, monkeypatch):
    class Installed:
        def read_text(self, name):
            return None if origin is None else json.dumps(origin)

    monkeypatch.setattr(metadata, "distribution", lambda name: Installed())
    monkeypatch.setattr("rulec.resources.find_spec", lambda name: object() if has_pip else None)
    monkeypatch.setattr(sys, "executable", "PYTHON")
    install_command.cache_clear()
    try:
        assert install_command("rates") == command
    finally:
        install_command.cache_clear()


def test_what_a_newcomer_mistypes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cars.csv").write_text("track,t,x,y\na,0,1,2\n")
    (tmp_path / "harbour.rules").write_text(
        "rulebook harbour\nsignal p\nhard rule r { require p }\n"
    )
    (tmp_path / "t.jsonl").write_text('{"state": {}}\n')
    (tmp_path / "build").mkdir()
    compiled = '{"format": "rulec compiled rulebook"}'
    (tmp_path / "build" / "nl.json").write_text(compiled)
    verify = ["verify", "cars.csv", "-r", "esterle2019"]
    for arguments, says, says_not in (
        (
            ["verify", "cars.csv", "-rulebook", "de"],
            "`-rulebook`; did you mean `--rulebook`?",
            "ul`",
        ),
        (["verify", "carz.csv", "-r", "esterle2019"], "did you mean `cars.csv`?", "1 trace"),
        (["verify", "harbour.rules", "-r", "esterle2019"], "this is a rulebook", "but text"),
        (["check", "cars.csv"], "this file is no rulebook; `rulec verify cars.csv", "cars.rules"),
        (["check", "nobooks"], "available: `./harbour.rules`", "\n\n\n"),
        (["verify", "cars.csv", "-r", "build"], "given by its file: `build/nl.json`", "end in"),
        ([*verify, "--threshold", "near_m=200m"], "in m, not `200m`.", "?."),
        ([*verify, "--threshold", "nera_m=5"], "did you mean `near_m`?\n", "?."),
        ([*verify, "--input-format", "table"], "--input-format: there is no `table`", "--format:"),
        ([*verify, "--format", "table"], "--format: there is no `table`", "--input-format:"),
        (["monitor", "esterle2019", "--step", "0.1s"], "in seconds, without a unit", "R0"),
        (
            ["monitor", "esterle2019", "--restore", "t.jsonl"],
            "give a file that `rulec monitor --save` has written",
            "restore it",
        ),
    ):
        status, text = said(capsys, *arguments)
        assert (status, says in text, says_not in text) == (2, True, False), text


def test_a_file_of_another_kind(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rules.txt").write_text("rulebook rules\n")
    (tmp_path / "README.md").write_text("# A\n\nB\n")
    (tmp_path / "states.jsonl").write_text('{"id": "t", "states": [{}]}\n')
    for verb in ("check", "test"):
        status, text = said(capsys, verb, "rules.txt")
        assert (status, "ends in `.rules`: call it `rules.rules`" in text) == (2, True)
    (tmp_path / "law.docx").write_bytes(b"PK\x03\x04\x14\xa3")
    (tmp_path / "law.rules").write_bytes(b"%PDF-1.4\n\xe2")
    status, text = said(capsys, "check", "law.docx")
    assert (status, "save it as plain text, in UTF-8, with a name" in text) == (2, True)
    status, text = said(capsys, "check", "law.rules")
    assert (status, "the file is a PDF, not plain text" in text) == (1, True)
    said(capsys, "compile", "esterle2019", "-o", "out")
    compiled = (tmp_path / "out" / "esterle2019.json").read_bytes()
    (tmp_path / "law.json.gz").write_bytes(gzip.compress(compiled))
    status, text = said(capsys, "show", "law.json.gz")
    assert (status, "ends in `.json`, packed or not: call it `law.json`" in text) == (2, True)
    status, text = said(capsys, "show", "./law.json.gz")
    assert (status, "the ending `.json`; packed with gzip it may stay" in text) == (2, True)
    (tmp_path / "law.json.gz").rename("law.json")
    assert said(capsys, "show", "law.json")[0] == 0
    status, text = said(capsys, "verify", "README.md", "-r", "esterle2019")
    assert (status, text.count("error["), "these are not traces but text" in text) == (2, 1, True)
    status, text = said(capsys, "maneuvers", "states.jsonl", "-r", "esterle2019")
    assert (status, "this is not a scenario" in text) == (2, True)


def test_a_new_rulebook_of_a_name_that_ships(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    status, text = said(capsys, "new", "de")
    assert (status, "rulec: a `de` ships with rulec, too" in text) == (0, True)


def test_every_example_of_a_command_is_one():
    for verb, (example, *_) in EXAMPLES.items():
        assert example.startswith(f"rulec {verb}")
        assert verb.startswith("draw ") or verb in COMMANDS


def test_of_many_files_in_the_folder_some_are_named_and_rulebooks_that_ship(
    tmp_path, monkeypatch, capsys
):
    for number in range(9):
        text = f"rulebook b{number}\nsignal p\nhard rule r {{ require always p }}\n"
        (tmp_path / f"b{number}.rules").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert main(["check", "nobooks"]) == 2
    said = "".join(capsys.readouterr())
    assert "available: `./b0.rules`, `./b1.rules`, `./b2.rules`, `./b3.rules`, `at`, " in said

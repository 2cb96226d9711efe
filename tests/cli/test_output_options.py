"""One rule for all verbs: the ending of a file says what is written into it."""

import io
import os
import re
import sys
from pathlib import Path

import click
import pytest

from rulec.cli.main import VERBS, main, rulec
from rulec.cli.options.output_options import TABLES, chosen_format, endings_of
from rulec.cli.verb_table import COMMANDS as VERB_COMMANDS
from rulec.resources import scenarios_folder
from support.builders import sumo_files, track_tables

PICTURES = endings_of("svg", "png")
FOUND = endings_of("full", "concise", "json", "sarif")


@pytest.mark.parametrize(
    ("endings", "file", "form"),
    [
        (PICTURES, "a.svg", "svg"),
        (PICTURES, "b/a.PNG", "png"),
        (PICTURES, "-", "svg"),
        (TABLES, "a.jsonl", "jsonl"),
        (TABLES, "a.ndjson", "jsonl"),
        (TABLES, "a.pq", "parquet"),
        (FOUND, "a.json", "json"),
        (FOUND, "a.sarif.json", "sarif"),
        (FOUND, "a.txt", "full"),
        # Nothing ends a device's name.
        (TABLES, os.devnull, "jsonl"),
    ],
)
def test_the_ending_decides(endings, file, form):
    assert chosen_format(endings, file) == form


@pytest.mark.parametrize(
    ("file", "named"), [("a", "png"), ("a.xyz", "png"), ("a.png", "png"), ("-", "png")]
)
def test_a_format_is_named_where_the_ending_says_nothing(file, named):
    assert chosen_format(PICTURES, file, named) == named


def test_formats_may_share_an_ending():
    assert chosen_format(FOUND, "a.txt", "concise") == "concise"


@pytest.mark.parametrize(("file", "named"), [("a.csv", "jsonl"), ("a.PQ", "csv")])
def test_an_ending_and_a_name_that_contradict_each_other(file, named):
    with pytest.raises(click.UsageError) as refused:
        chosen_format(TABLES, file, named)
    assert f"and not {named}" in refused.value.message


@pytest.mark.parametrize("file", ["a", "a.txt", "a.svg.bak", "png", "a\0", "x" * 5000])
def test_an_ending_that_says_nothing_is_refused_with_those_that_do(file):
    with pytest.raises(click.UsageError) as refused:
        chosen_format(PICTURES, file)
    assert "Let it end in one of .svg, .png, or name the format" in refused.value.message


WITHOUT = {
    "compile": "writes a folder of files whose formats are given",
    "fleet": "writes a folder of files in one format, which engines add to",
    "new": "writes a rulebook that is called as it is named",
    "fmt": "changes files in place",
    "help --completion": "prints a script for the shell that is named",
    "help": "prints what `--help` prints",
    "lsp": "answers an editor",
}
"""Verbs that have one output of one kind, with the reason."""


def commands(group, *names):
    """All commands below a group, with their names."""
    context = click.Context(group)
    for name in VERB_COMMANDS if group is rulec else group.list_commands(context):
        command = group.get_command(context, name)
        if isinstance(command, click.Group):
            yield from commands(command, *names, name)
        else:
            yield (*names, name), command


COMMANDS = {" ".join(names): command for names, command in commands(rulec)}


def needed(command):
    """Arguments with which the command would begin; nothing has such names."""
    for parameter in command.params:
        if parameter.required and "--output" not in parameter.opts:
            is_option = isinstance(parameter, click.Option)
            yield from ([parameter.opts[0]] if is_option else [])
            yield "nothing.at.all"


def options_of(command):
    return {name: option for option in command.params for name in option.opts}


def test_all_verbs_are_looked_at():
    assert {name.split()[0] for name in COMMANDS} == VERBS.keys()
    assert WITHOUT.keys() <= COMMANDS.keys()


@pytest.mark.parametrize("name", WITHOUT)
def test_a_verb_without_the_rule_has_no_part_of_it(name):
    options = options_of(COMMANDS[name])
    assert not {"--output-format", "--json"} & options.keys()
    if "-o" in options:
        assert options["-o"].metavar == "DIR"


@pytest.mark.parametrize("name", [name for name in COMMANDS if name not in WITHOUT])
class TestEveryVerb:
    def test_it_has_all_options(self, name):
        options = options_of(COMMANDS[name])
        assert "-o" in options
        choices = options["--output-format"].type.choices
        assert ("--json" in options) == ("json" in choices)

    def test_an_unknown_ending_is_refused_before_anything_is_read(self, name, capsys, tmp_path):
        file = tmp_path / "answer.xyz"
        command = COMMANDS[name]
        assert main([*name.split(), *needed(command), "-o", str(file)]) == 2
        err = capsys.readouterr().err
        assert f"`{file}` does not say by its ending what to write" in err
        assert re.search(r"Let it end in one of (\.[a-z1.]+, )+or name the format", err)
        assert not file.exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["list", "-o", "a.txt", "--json"], "it is text, and not json"),
        (["list", "--json", "--output-format", "text"], "contradict each other"),
        (["list", "-o", "a.txt", "-o", "b.txt"], "-o is given twice"),
        (["check", "a.json", "-o", "./a.json"], "is named already, and would be overwritten"),
        (["diff", "./a.json", "fr", "--witness", "a.json"], "would be overwritten"),
        (["monitor", "a.json", "--save", "./a.json"], "would be overwritten"),
        (["monitor", "de", "--save", "a.json", "-o", "./a.json"], "would be overwritten"),
        (["monitor", "de", "--save", "-"], "standard output takes one answer"),
        (["compile", "./a.json", "-o", "."], "would be overwritten"),
        (["compile", "de", "-o", "-"], "`-` is standard output, and no folder"),
        (["new", "depot", "-o", "-"], "`-` is standard output, and no folder"),
        (
            ["diff", "de", "fr", "--witness", "a.json", "-o", "a.json"],
            "is named already, and would be overwritten",
        ),
    ],
)
def test_what_is_refused(arguments, says, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.json").write_text("kept")
    assert main(arguments) == 2
    assert says in capsys.readouterr().err
    assert Path("a.json").read_text() == "kept"
    assert [path.name for path in Path().iterdir()] == ["a.json"]


def named_file(command):
    """What `needed` gives, with the name of a file that there is."""
    return ["in.data" if one == "nothing.at.all" else one for one in needed(command)]


WITH_INPUTS = [
    name for name in COMMANDS if name not in WITHOUT and "in.data" in named_file(COMMANDS[name])
]


@pytest.mark.parametrize("name", WITH_INPUTS)
def test_no_answer_takes_the_place_of_what_is_read(name, capsys, tmp_path, monkeypatch):
    """However its path is written: whichever of its names, and links."""
    monkeypatch.chdir(tmp_path)
    Path("in.data").write_text("kept")
    Path("link").symlink_to("in.data")
    os.link("in.data", "hard")
    Path("below").mkdir()
    form = options_of(COMMANDS[name])["--output-format"].type.choices[0]
    paths = ["in.data", "./in.data", "below/../in.data", str(tmp_path / "in.data"), "link", "hard"]
    for path in paths:
        to = ["-o", path, "--output-format", form]
        assert main([*name.split(), *named_file(COMMANDS[name]), *to]) == 2
        assert "error[R0735]" in capsys.readouterr().err
    assert Path("in.data").read_text() == "kept"
    assert len(WITH_INPUTS) > 12


def test_a_source_that_is_there_is_never_written_over(tmp_path, monkeypatch, capsys):
    """Also not one that is found by its name, or used by another."""
    monkeypatch.chdir(tmp_path)
    Path("rulec.toml").write_text('search_path = ["."]')
    Path("words.rules").write_text("vocabulary words { signal p }")
    Path("mine.rules").write_text("rulebook mine use words hard rule r { require always p }")
    for path in ("words.rules", "mine.rules"):
        before = Path(path).read_text()
        assert main(["doc", "mine", "-o", path, "--output-format", "markdown"]) == 2
        assert "error[R0735]" in capsys.readouterr().err
        assert Path(path).read_text() == before


def test_the_minus_is_standard_input_and_output_whatever_files_are_called(
    tmp_path, monkeypatch, capsysbinary
):
    monkeypatch.chdir(tmp_path)
    for name in ("-", "-.rules", "a.jsonl"):
        Path(name).write_text("kept")
    trace = b'{"objects": {"v": "vehicle"}, "states": [{"position": {"v": "b"}}]}\n'
    scenario = (scenarios_folder() / "s1.toml").read_bytes()

    def run(*arguments, given=b""):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given)))
        status = main(arguments)
        return status, capsysbinary.readouterr().out

    assert run("verify", "-", "-r", "esterle2019", given=trace)[0] == 0
    assert b"<svg" in run("draw", "trace", "-", "-r", "esterle2019", "-o", "-", given=trace)[1]
    assert run("maneuvers", "-", "-r", "esterle2019", given=scenario)[0] == 0
    assert run("diff", "esterle2019", "esterle2019", "--witness", "-", "-o", "d.txt")[0] == 0
    out = run("monitor", "esterle2019", "--save", "-", "-o", "m.txt", given=b"{}\n")[1]
    assert b'"version"' in out
    assert run("check", "-", given=b"rulebook a")[0] == 1
    assert run("doc", "esterle2019", "-o", "-")[1].startswith(b"<!")
    assert {Path(name).read_text() for name in ("-", "-.rules", "a.jsonl")} == {"kept"}


STATES = b'{"state": {"loud": false}}\n{"state": {"loud": true}}\n'
BOOK = "rulebook tiny\nsignal loud default false\nhard rule quiet { require never loud }\n"


@pytest.mark.parametrize(
    ("arguments", "ending", "form"),
    [
        (["check", "./tiny.rules"], ".sarif.json", "sarif"),
        (["check", "./tiny.rules"], ".txt", "full"),
        (["analyze", "./tiny.rules"], ".json", "json"),
        (["test", "./tiny.rules"], ".xml", "junit"),
        (["show", "--audit", "./tiny.rules"], ".md", "markdown"),
        (["explain", "R0101"], ".markdown", "markdown"),
        (["list", "codes"], ".json", "json"),
        (["show", "--tree", "./tiny.rules"], ".txt", "text"),
        (["monitor", "./tiny.rules", "--step", "1"], ".jsonl", "json"),
        (["maneuvers", "s1", "-r", "./tiny.rules"], ".json", "json"),
    ],
)
def test_a_file_gets_what_standard_output_does(
    arguments, ending, form, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)

    def run(*more):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(STATES)))
        return main([*arguments, *more]), capsys.readouterr().out

    status, shown = run("--output-format", form)
    assert status in (0, 1)
    file = f"answer{ending}"
    assert run("-o", file) == (status, f"wrote {file}\n")
    seconds = re.compile(r'"seconds": [0-9.e-]+')
    assert seconds.sub("", Path(file).read_text()) == seconds.sub("", shown)


def test_a_monitor_that_is_interrupted_leaves_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tiny.rules").write_text(BOOK)

    class Interrupted(io.BytesIO):
        def read1(self, size=-1):
            raise KeyboardInterrupt

    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(Interrupted()))
    assert main(["monitor", "./tiny.rules", "--step", "1", "-o", "a.jsonl"]) == 130
    assert [path.name for path in Path().iterdir()] == ["tiny.rules"]


@pytest.mark.parametrize("name", ["--output-format", "--format"])
def test_the_former_name_is_taken_and_not_shown(name, capsys, tmp_path):
    file = tmp_path / "traces"
    assert main(["maneuvers", "--traces", "s1", "-o", str(file), name, "csv", "--first", "1"]) == 0
    assert file.read_text().startswith("trace,step,")
    capsys.readouterr()
    assert main(["maneuvers", "--traces", "--help"]) == 0
    assert "--format " not in capsys.readouterr().out


def test_what_a_link_leads_to_is_not_overwritten(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("words.rules").write_text("vocabulary words { signal p }")
    Path("mine.rules").write_text("rulebook mine use words hard rule r { require always p }")
    Path("page.html").symlink_to("link.html")
    Path("link.html").symlink_to("words.rules")
    assert main(["doc", "./mine.rules", "-o", "page.html"]) == 2
    assert "`words.rules` is a source, and would be overwritten" in capsys.readouterr().err
    assert Path("words.rules").read_text() == "vocabulary words { signal p }"
    Path("link.html").unlink()
    assert main(["doc", "./mine.rules", "-o", "page.html"]) == 0
    assert Path("link.html").read_text().startswith("<!DOCTYPE html>")


BESIDE = {
    "rulec.toml": ("", ["check", "esterle2019", "--output-format", "json"]),
    "road.net.xml": (sumo_files.ROAD_NET, ["verify", "cars.csv", "-r", "esterle2019"]),
    "road.rou.xml": ("<routes/>", ["verify", "cars.csv", "-r", "esterle2019"]),
    "log_map_archive_a.json": ("{}", ["verify", "cars.csv", "-r", "esterle2019"]),
    "lanes.csv": (track_tables.LANES, ["verify", "cars.csv", "-r", "esterle2019"]),
}


@pytest.mark.parametrize("name", BESIDE)
def test_what_is_read_without_being_named_is_not_overwritten(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    content, words = BESIDE[name]
    Path(name).write_text(content)
    Path("cars.csv").write_text("track,t,x,y\n1,0,0,0\n1,0.1,1,0\n")
    assert main([*words, "-o", name]) == 2
    assert "error[R0735]" in capsys.readouterr().err
    assert Path(name).read_text() == content


@pytest.mark.parametrize("name", ["a.csv", "a.parquet", "a.xml", "a.mcap", "a.json"])
def test_an_answer_replaces_an_older_one(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("lanes.csv").write_text(track_tables.LANES)
    rows = [*track_tables.driving("1"), *track_tables.driving("2", speed=8.0, y=3.5)]
    Path("cars.csv").write_text(track_tables.table("track,t,x,y", *rows))
    for _ in range(2):
        words = ["verify", "cars.csv", "--map", "lanes.csv", "-r", "esterle2019", "-o", name]
        assert main(words) in {0, 1}


@pytest.mark.parametrize(
    ("file", "why"),
    [("gone/found.csv", "no such file or directory"), ("notes/found.csv", "not a folder")],
)
def test_a_file_that_cannot_be_written_is_refused_before_anything_is_read(
    file, why, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("notes").touch()
    assert main(["verify", "missing.xml", "-r", "de", "-o", file]) == 2
    err = capsys.readouterr().err
    assert err.startswith("error[R0702]: the file cannot be written: ")
    assert why in err
    assert "missing.xml" not in err


BROKEN = "rulebook broken\nuse road\nhard rule r { require always buit_up }\n"


def test_an_old_file_is_not_taken_for_the_answer_of_a_failed_call(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("whole.rules").write_text(BROKEN.replace("buit", "built").replace("broken", "whole"))
    Path("broken.rules").write_text(BROKEN)
    Path("t.jsonl").write_text('{"states": [{"built_up": true}]}\n')
    outputs = ["-o", "new.jsonl", "-o", "old.json"]
    assert main(["verify", "t.jsonl", "-r", "./whole.rules", *outputs]) == 0
    assert "earlier" not in capsys.readouterr().err
    Path("new.jsonl").unlink()
    before = Path("old.json").read_bytes(), Path("old.json").stat().st_mtime_ns
    assert main(["verify", "t.jsonl", "-r", "./broken.rules", *outputs]) == 2
    err = capsys.readouterr().err
    assert err.startswith("rulec: old.json was not written; it is that of an earlier call\n")
    assert err.count("earlier") == 1
    assert (Path("old.json").read_bytes(), Path("old.json").stat().st_mtime_ns) == before
    assert not Path("new.jsonl").exists()
    # A file that says what is wrong is an answer; so is one that says the same as before.
    for _ in range(2):
        assert main(["check", "broken.rules", "-o", "found.json"]) == 1
        assert "earlier" not in capsys.readouterr().err

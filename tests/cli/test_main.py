"""What all verbs share: help, statuses, terminals, pipes and Ctrl-C."""

import os
import pty
import subprocess
import sys

import pytest

from rulec.cli.main import main
from rulec.cli.verb_table import COMMANDS, FORMER, VERBS, called

RULEC = [sys.executable, "-c", "from rulec.cli.main import main; raise SystemExit(main())"]


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == "rulec 0.1.0\n"


def test_the_version_alone_needs_nothing_else_to_be_loaded():
    program = (
        "import atexit, sys; sys.argv = ['rulec', '--version']\n"
        "atexit.register(lambda: print('click' in sys.modules))\n"
        "from rulec.cli.entry_point import run\n"
        "run()"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "rulec 0.1.0\nFalse\n", "")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(command, capsys):
    assert main([*command.split(), "--help"]) == 0
    assert "Usage: rulec" in capsys.readouterr().out


def test_help_lists_the_verbs_and_the_exit_status(capsys):
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(verb in out for verb in VERBS)
    assert "Exit status" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["verfy"], "did you mean `verify`?"),
        (["maneuvers", "s2"], "`-r` or `--rulebook` is missing"),
        (
            ["maneuvers", "s2", "-r", "esterle2019", "--adjacency", "near"],
            "it is one of touch, edge, forward",
        ),
        (["maneuvers", "s2", "-r", "esterle2019", "--list", "-1"], "--list"),
        (["compile", "de", "--emit", "HOA"], "did you mean `automata`?"),
        (["compile", "de", "--emit", "smv"], "did you mean `ltl`?"),
        (["list", "words"], "did you mean `vocabularies`?"),
    ],
)
def test_wrong_usage_is_status_2(arguments, words, capsys):
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert words in captured.err


def test_a_bug_is_status_70_with_a_line_to_report(monkeypatch, capsys):
    def broken(*_, **__):
        raise KeyError("oops")

    monkeypatch.setattr("rulec.api.rulebook_compilation.machines", broken)
    assert main(["verify", "x", "-r", "esterle2019"]) == 70
    err = capsys.readouterr().err
    assert "bug in rulec" in err
    assert "RULEC_TRACEBACK=1" in err
    assert "Traceback" not in err


def on_terminal(arguments, environment):
    """What the program shows on a terminal."""
    ours, theirs = pty.openpty()
    inherited = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    process = subprocess.Popen(
        [*RULEC, *arguments],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env={**inherited, "TERM": "xterm-256color", "COLUMNS": "100", **environment},
    )
    os.close(theirs)
    shown = b""
    try:
        while chunk := os.read(ours, 65536):
            shown += chunk
    except OSError:  # the program has closed its side
        pass
    os.close(ours)
    process.wait()
    return shown.decode()


def test_a_terminal_gets_colour_and_progress(tmp_path):
    file = str(tmp_path / "t.jsonl")
    shown = on_terminal(["maneuvers", "--traces", "s3", "--step", "0.5", "-o", file], {})
    assert "writing" in shown
    assert "%" in shown
    shown = on_terminal(["verify", file, "-r", "esterle2019"], {})
    assert "\x1b[31m" in shown
    assert "2,400 violated" in shown


def test_no_color_is_obeyed():
    arguments = ["maneuvers", "s2", "-r", "nope"]
    assert "\x1b[" in on_terminal(arguments, {})
    shown = on_terminal(arguments, {"NO_COLOR": "1"})
    assert "\x1b[" not in shown
    assert "error" in shown


@pytest.mark.parametrize("verb", ["check", "test"])
def test_findings_have_colour_for_people_only(verb, tmp_path):
    file = tmp_path / "a.rules"
    formula = "always p" if verb == "test" else "p =>"
    file.write_text(f"rulebook a signal p hard rule r {{ require {formula} reject {{ p }} }}")
    arguments = [verb, str(file)]
    assert "\x1b[1;31merror[R0" in on_terminal(arguments, {"NO_COLOR": ""})
    assert "\x1b" not in on_terminal(arguments, {"NO_COLOR": "1"})
    assert "\x1b" not in on_terminal([*arguments, "--output-format", "json"], {"NO_COLOR": ""})


def test_a_pipe_gets_neither(tmp_path):
    done = subprocess.run(
        [*RULEC, "maneuvers", "--traces", "s2", "-o", str(tmp_path / "t.jsonl")],
        capture_output=True,
        check=True,
    )
    assert done.stderr == b""
    assert b"\x1b" not in done.stdout


@pytest.mark.parametrize("former", FORMER)
def test_a_former_verb_is_taken_for_another_version_and_says_what_it_is_called(former, capsys):
    assert main([former, "--help"]) == 0
    out, err = capsys.readouterr()
    assert err == f"rulec: `rulec {former}` is now called `rulec {FORMER[former]}`\n"
    assert main([*FORMER[former].split(), "--help"]) == 0
    assert capsys.readouterr() == (out, "")
    assert main(["help", former]) == 0
    assert capsys.readouterr().out == out


@pytest.mark.parametrize("command", [command for command in COMMANDS if " " in command])
def test_a_verb_says_what_else_it_is_asked_and_where_that_is_described(command, capsys):
    verb = command.split()[0]
    assert main([verb, "--help"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    told = f"rulec help {command}" if verb == "list" else f"rulec {command} --help"
    assert f"`{told}`" in shown
    assert main(told.split()[1:]) == 0
    assert capsys.readouterr().out.startswith(f"Usage: rulec {command} ")


def test_there_are_few_verbs_and_former_ones_are_hidden(capsys):
    assert len(VERBS) <= 20
    assert not FORMER.keys() & VERBS.keys()
    assert set(FORMER.values()) <= COMMANDS.keys()
    assert main(["treee"]) == 2
    assert "did you mean `show --tree`?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "name", "rest"),
    [
        (["show", "de", "--tree", "--all"], "show --tree", ["de", "--all"]),
        (["show", "--", "--tree"], "show", ["--", "--tree"]),
        (["tree", "de"], "show --tree", ["de"]),
        (["list", "formats", "sumo"], "list formats", ["sumo"]),
        (["list", "rulebooks"], "list", ["rulebooks"]),
        (["check", "--tree"], "check", ["--tree"]),
    ],
)
def test_a_verb_is_asked_something_else_by_a_word_of_its_own(words, name, rest):
    assert called(words) == (name, rest)

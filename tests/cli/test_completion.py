"""Shell completion: what is offered, and that shells take the scripts."""

import os
import shutil
import subprocess
import sys

import pytest
from click.shell_completion import BashComplete, FishComplete, ZshComplete

from rulec.cli.main import main, rulec
from rulec.cli.verb_table import VERBS
from rulec.report.findings.code_registry import all_codes

SHELLS = ("bash", "fish", "zsh")


def offered(words, incomplete, kind=BashComplete):
    program = kind(rulec, {}, "rulec", "_RULEC_COMPLETE")
    return [(one.type, one.value) for one in program.get_completions(words, incomplete)]


@pytest.mark.parametrize("kind", [BashComplete, FishComplete, ZshComplete])
def test_verbs(kind):
    assert offered([], "", kind) == [("plain", verb) for verb in VERBS]
    assert offered([], "ch", kind) == [("plain", "check")]


FILES = ("file", "the word so far")


@pytest.mark.parametrize(
    ("words", "incomplete", "expected"),
    [
        (["check"], "est", [FILES, ("plain", "esterle2019")]),
        (["check", "esterle2019"], "pap", [FILES, ("plain", "paper")]),
        (["test"], "est", [FILES, ("plain", "esterle2019")]),
        (["show", "--audit"], "est", [FILES, ("plain", "esterle2019")]),
        (["show", "--audit", "--fail-on"], "unc", [("plain", "uncited")]),
        (["doc"], "est", [FILES, ("plain", "esterle2019")]),
        (["show", "--tree"], "est", [FILES, ("plain", "esterle2019")]),
        (["compile"], "est", [FILES, ("plain", "esterle2019")]),
        (["compile"], "./my", [FILES]),
        (["verify", "x.jsonl", "-r"], "est", [FILES, ("plain", "esterle2019")]),
        (["maneuvers"], "s1", [FILES, ("plain", "s1")]),
        (["maneuvers", "--traces"], "s2", [FILES, ("plain", "s2")]),
        (["show"], "est", [FILES, ("plain", "esterle2019")]),
        (["show", "esterle2019"], "R", [("plain", name) for name in ("R1", "R2", "R3")]),
        (["show", "there_is_none"], "", []),
        (["show", "esterle2019", "--automaton"], "s", [("plain", "svg")]),
        (["explain"], "r0201", [("plain", "R0201")]),
        (["help", "--completion"], "f", [("plain", "fish")]),
        (["list"], "r", [("plain", "rulebooks"), ("plain", "rules")]),
        (["check", "--output-format"], "s", [("plain", "sarif")]),
    ],
)
def test_arguments(words, incomplete, expected):
    expected = [("file", incomplete) if one is FILES else one for one in expected]
    assert offered(words, incomplete) == expected


def test_verbs_are_described_by_whole_sentences():
    program = FishComplete(rulec, {}, "rulec", "_RULEC_COMPLETE")
    assert {one.value: one.help for one in program.get_completions([], "")} == VERBS


def test_codes_come_with_their_titles():
    program = ZshComplete(rulec, {}, "rulec", "_RULEC_COMPLETE")
    (one,) = program.get_completions(["explain"], "R0403")
    assert one.help == all_codes()["R0403"].title


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script(shell, capsys):
    assert main(["help", "--completion", shell]) == 0
    script = capsys.readouterr().out
    assert f"_RULEC_COMPLETE={shell}_complete" in script
    assert "%(" not in script


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_itself_takes_the_script(shell, capsys, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"there is no {shell} here")
    main(["help", "--completion", shell])
    script = tmp_path / "script"
    script.write_text(capsys.readouterr().out)
    subprocess.run([shell, "-n", str(script)], check=True)


def test_fish_offers_files_in_folders_and_whole_descriptions(capsys, tmp_path):
    if shutil.which("fish") is None:
        pytest.skip("there is no fish here")
    main(["help", "--completion", "fish"])
    (tmp_path / "script").write_text(capsys.readouterr().out)
    (tmp_path / "books").mkdir()
    (tmp_path / "books" / "mine.rules").touch()
    program = tmp_path / "rulec"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rulec "$@"\n')
    program.chmod(0o755)

    def completed(line):
        done = subprocess.run(
            ["fish", "--no-config", "-c", f"source script; complete -C '{line}'"],
            cwd=tmp_path,
            env={
                **os.environ,
                "PATH": f"{tmp_path}:{os.environ['PATH']}",
                "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            },
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    assert completed("rulec check books/m") == ["books/mine.rules"]
    (explained,) = completed("rulec explain R0208")
    assert explained == f"R0208\t{all_codes()['R0208'].title}"
    assert "," in all_codes()["R0208"].title


def test_the_program_answers_the_script():
    done = subprocess.run(
        [sys.executable, "-c", "from rulec.cli.entry_point import run; raise SystemExit(run())"],
        env={
            **os.environ,
            "_RULEC_COMPLETE": "bash_complete",
            "COMP_WORDS": "rulec maneuvers s",
            "COMP_CWORD": "2",
        },
        capture_output=True,
        text=True,
        check=True,
    )
    assert "plain,s1" in done.stdout.splitlines()
    assert done.stderr == ""


def test_another_shell(capsys):
    assert main(["help", "--completion", "csh"]) == 2
    assert "it is one of bash, " in capsys.readouterr().err

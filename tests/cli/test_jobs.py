"""Work in several processes, as users see it: the same bytes, a killed process, Ctrl-C."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rulec.cli.main import main
from support.builders.recorded_cars import three_cars
from support.builders.terminal_signals import as_from_a_terminal
from support.snapshots import timeless

BOOK = "rulebook tiny\nuse road\nhard rule slow { require always speed <= 45 km/h }\n"

RULEC = [sys.executable, "-c", "from rulec.cli.entry_point import run; raise SystemExit(run())"]

IN_WORKERS = """
import os, signal, sys, time
from pathlib import Path
if "--multiprocessing-fork" in sys.orig_argv:
    from rulec.batch import recording_judge
    judge = recording_judge.judged_file
    def odd(settings, path):
        marker = Path(path + "." + str(os.getpid()))
        if "odd" in path and len(list(marker.parent.glob("*.xml.*"))) < LEAST:
            marker.touch()
            yield from list(judge(settings, path))[:1] if settings.to_line else ()
            DEED
        yield from judge(settings, path)
    recording_judge.judged_file = odd
"""
"""A module that Python imports when it starts: workers do something odd with one file."""


@pytest.fixture
def drives(tmp_path):
    """Four recordings of 3 vehicles, and a rulebook that one of each violates."""
    (tmp_path / "tiny.rules").write_text(BOOK)
    (tmp_path / "drives").mkdir()
    first = Path(three_cars(tmp_path / "drives"))
    for name in ("a", "b", "odd", "z"):
        (tmp_path / "drives" / f"{name}.xml").write_bytes(first.read_bytes())
    first.unlink()
    return tmp_path


def with_workers(folder, deed, least=99):
    """The environment of a process whose workers do this."""
    text = IN_WORKERS.replace("DEED", deed).replace("LEAST", str(least))
    (folder / "sitecustomize.py").write_text(text)
    return {**os.environ, "PYTHONPATH": str(folder)}


def verify(folder, *arguments, env=None):
    command = [*RULEC, "verify", "drives", "-r", "./tiny.rules", *arguments]
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


DIE = "os.kill(os.getpid(), signal.SIGKILL)"


def test_a_worker_that_is_killed_once_changes_nothing(drives):
    expected = verify(drives, "--json", "-j", "1")
    found = verify(drives, "--json", "-j", "2", env=with_workers(drives, DIE, least=1))
    assert found[:2] == expected[:2]
    assert len(found[1].splitlines()) == 12
    assert "the process that judged drives/odd.xml was stopped by signal 9; another" in found[2]


@pytest.mark.long
def test_a_worker_that_is_killed_again_is_reported(drives):
    status, out, err = verify(drives, "-j", "2", env=with_workers(drives, DIE))
    assert status == 2
    assert "3 recordings with 9 drives" in out
    assert "error[R0708]" in err
    assert "--> drives/odd.xml" in err


RULES = """\
rulebook odd
signal p, q
hard rule a { require always p accept { p; p } accept "odd" { not p } }
hard rule b { require always (p and q) }
hard rule c { require eventually not p }
soft rule d { require never (p and not p) }
"""


@pytest.mark.parametrize(("verb", "jobs"), [("analyze", "2"), ("test", "4")])
def test_output_of_questions_and_examples_does_not_depend_on_processes(
    verb, jobs, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("odd.rules").write_text(RULES)
    Path("empty.rules").write_text("rulebook empty\n")
    books = ["./odd.rules", "no.rules", "./empty.rules"]
    found = []
    for number in ("1", jobs):
        status = main([verb, *books, "-j", number])
        out, err = capsys.readouterr()
        found.append((status, timeless(out), err))
    assert found[0] == found[1]
    assert found[0][0] == 2
    assert ("R0804" if verb == "analyze" else "example `odd`") in found[0][1]
    assert "no.rules" in found[0][2]


@pytest.mark.parametrize(
    "ending", ["csv", "parquet", pytest.param("jsonl", marks=pytest.mark.long)]
)
def test_drives_are_written_alike_by_any_number_of_processes(ending, drives, monkeypatch, capsys):
    monkeypatch.chdir(drives)
    command = ["maneuvers", "--traces", "drives/a.xml", "--recorded", "-r", "./tiny.rules"]
    for jobs in ("1", "2"):
        assert main([*command, "-o", f"{jobs}.{ending}", "-j", jobs]) == 0
        assert capsys.readouterr().out == f"wrote 3 drives to {jobs}.{ending}\n"
    assert Path(f"1.{ending}").read_bytes() == Path(f"2.{ending}").read_bytes()
    assert main([*command, "-o", f"few.{ending}", "-j", "2", "--first", "2"]) == 0
    if ending != "parquet":
        assert Path(f"1.{ending}").read_bytes().startswith(Path(f"few.{ending}").read_bytes())
    assert main(["verify", f"few.{ending}", "-r", "./tiny.rules"]) in (0, 1)
    assert "2 traces: " in capsys.readouterr().out


NUMBERS = {
    "-1": "--jobs: it has to be a whole number from 0 to 256; 0 is one for each processor",
    "x": "it has to be a whole number from 0 to 256",
    "257": "it has to be a whole number from 0 to 256",
    "1.5": "it has to be a whole number from 0 to 256",
    "": "it has to be a whole number from 0 to 256",
}


@pytest.mark.parametrize("number", NUMBERS)
def test_a_number_of_processes_that_is_none_is_refused(number, capsys):
    assert main(["verify", "x.xml", "-r", "de", "-j", number]) == 2
    assert NUMBERS[number] in capsys.readouterr().err


def test_a_number_from_the_environment_says_so(drives, monkeypatch, capsys):
    monkeypatch.setenv("RULEC_JOBS", "x")
    command = ["verify", "drives/a.xml", "-r", "./tiny.rules"]
    monkeypatch.chdir(drives)
    assert main(command) == 2
    assert "RULEC_JOBS is `x`, and has to be a whole number from 0 to" in capsys.readouterr().err
    for number in ("0", ""):
        monkeypatch.setenv("RULEC_JOBS", number)
        assert main(command) == 1


def test_processes_for_maneuvers_are_refused_and_those_of_the_environment_are_not_meant(
    tmp_path, monkeypatch, capsys
):
    command = ["maneuvers", "--traces", "s1", "-o", str(tmp_path / "t.jsonl")]
    assert main([*command, "-j", "2"]) == 2
    assert "-j is for drives: add --recorded." in capsys.readouterr().err
    monkeypatch.setenv("RULEC_JOBS", "2")
    assert main(command) == 0


def processes_of(group):
    found = subprocess.run(["pgrep", "-g", str(group)], capture_output=True, text=True, check=False)
    return found.stdout.split()


def in_a_group_from_a_terminal():
    os.setpgrp()
    as_from_a_terminal()


def test_an_interrupt_ends_all_processes_and_leaves_no_file(drives):
    command = [*RULEC, "verify", "drives", "-r", "./tiny.rules", "-j", "2", "-o", "found.csv"]
    process = subprocess.Popen(
        command,
        cwd=drives,
        env=with_workers(drives, "time.sleep(600)"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=in_a_group_from_a_terminal,
    )
    while not list(drives.glob("drives/odd.xml.*")):
        assert process.poll() is None
        time.sleep(0.02)
    assert len(processes_of(process.pid)) >= 3
    # A terminal sends it to all of them.
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert err.decode().split("\n", 1)[1].strip() == "rulec: interrupted"
    # Python's own, which looks after shared memory, sees the end of the others a moment later.
    until = time.monotonic() + 60
    while processes_of(process.pid) and time.monotonic() < until:
        time.sleep(0.02)
    assert processes_of(process.pid) == []
    assert not list(drives.glob("*found*"))

"""Pipes, full disks, closed streams and signals: the exit status stays true, no file half-made."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from support.builders.terminal_signals import as_from_a_terminal

RULEC = [sys.executable, "-c", "from rulec.cli.entry_point import run; raise SystemExit(run())"]
MANEUVERS = ["maneuvers", "s1", "-r", "esterle2019"]
TRACES = ["maneuvers", "--traces", "s3", "--step", "0.5", "-o", "-"]


@pytest.fixture(autouse=True)
def _buffered(monkeypatch):
    """As for most users: what a stream has not yet taken waits until the program ends."""
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)


def run(arguments, **streams):
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams}
    return subprocess.run([*RULEC, *arguments], check=False, **streams)


def shell(command, *arguments):
    """``command`` in a shell, in which "$@" is rulec with the arguments."""
    return subprocess.run(
        ["sh", "-c", command, "sh", *RULEC, *arguments], capture_output=True, check=False
    )


@pytest.mark.parametrize("arguments", [MANEUVERS, TRACES, ["--help"]])
def test_a_reader_that_has_left_is_no_verdict(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    done = run(arguments, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


@pytest.mark.parametrize("arguments", [MANEUVERS, TRACES, ["--version"], ["compile", "--help"]])
def test_a_full_disk_is_said(arguments):
    done = shell('"$@" >/dev/full', *arguments)
    assert done.returncode == 2
    assert b"R0720]: standard output cannot be written to: no space left on device" in done.stderr


def test_an_editor_that_says_goodbye_leaves_no_bug_behind():
    first = {"id": 1, "method": "initialize", "params": {"capabilities": {}}}
    said = b""
    for message in (first, {"id": 2, "method": "shutdown"}, {"method": "exit"}):
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        said += b"Content-Length: %d\r\n\r\n%s" % (len(body), body)
    done = run(["lsp"], input=said)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize(
    ("file", "says"),
    [
        (
            "gone/t.csv",
            "no such file or directory\n --> gone/t.csv\n  = help: make the folder `gone`",
        ),
        (
            "/dev/full",
            "no space left on device\n --> /dev/full\n  = help: make room there, or give",
        ),
    ],
)
def test_a_file_that_cannot_be_written_has_a_way_out(file, says):
    done = run(["maneuvers", "--traces", "s1", "-o", file, "--output-format", "csv"])
    assert done.returncode == 2
    assert f"error[R0702]: the file cannot be written: {says}" in done.stderr.decode()


def test_input_that_cannot_be_read_is_said(tmp_path):
    done = shell(f'"$@" 0> {tmp_path}/written', "check", "-")
    assert done.returncode == 2
    assert b"R0721]: standard input cannot be read" in done.stderr


def test_a_working_folder_that_is_gone_is_said(tmp_path):
    (tmp_path / "gone").mkdir()
    done = shell(f'cd {tmp_path}/gone && rmdir {tmp_path}/gone && "$@"', "list")
    assert done.returncode == 2
    assert b"R0722]" in done.stderr


def test_a_message_that_cannot_be_written_keeps_its_status():
    assert shell('"$@" 2>/dev/full', "verify", "missing", "-r", "esterle2019").returncode == 2
    assert shell('"$@" 2>/dev/full', "maneuvers", "s9", "-r", "esterle2019").returncode == 2
    assert shell('"$@" 2>/dev/full', "maneuvers").returncode == 2


def test_an_answer_for_which_standard_output_is_closed_is_an_error(tmp_path):
    for arguments in (MANEUVERS, ["list"], ["--version"]):
        done = shell('"$@" >&-', *arguments)
        assert done.returncode == 2
        assert b"standard output cannot be written to" in done.stderr
    file = tmp_path / "b.rules"
    file.write_text("rulebook b\nsignal  p\nhard rule r { require always p }\n")
    assert shell('"$@" >&-', "fmt", str(file)).returncode == 0  # it has nothing to say there


def test_closed_streams():
    assert shell('"$@" 2>&-', *MANEUVERS).returncode == 0
    assert shell('"$@" 2>&-', *TRACES).stdout.count(b"\n") == 4240
    done = shell('"$@" <&-', "verify", "-", "-r", "esterle2019")
    assert done.returncode == 2
    assert b"there is no trace" in done.stderr


def test_traces_from_a_pipe_with_a_name(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = subprocess.Popen(
        [*RULEC, "verify", str(pipe), "-r", "esterle2019"], stdout=subprocess.PIPE
    )
    with pipe.open("wb") as stream:
        stream.write(b'{"states": [{}]}\n' * 300)
    head, *_, counted = reader.communicate()[0].splitlines()
    assert head.startswith(b"by esterle2019")
    assert counted == b"300 traces: 300 satisfied, 0 violated"
    assert reader.returncode == 0


def started(arguments, folder):
    """A running command that has begun to write into the folder."""
    process = subprocess.Popen(
        [*RULEC, *arguments], stderr=subprocess.PIPE, preexec_fn=as_from_a_terminal
    )
    while not any(part.stat().st_size for part in folder.iterdir()):
        assert process.poll() is None
        time.sleep(0.01)
    return process


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_leaves_nothing_half_written(number, tmp_path):
    file = str(tmp_path / "traces.jsonl")
    process = started(
        ["maneuvers", "--traces", "s2", "--step", "0.25", "--first", "5000000", "-o", file],
        tmp_path,
    )
    process.send_signal(number)
    process.communicate()
    assert process.returncode == 128 + number
    assert list(tmp_path.iterdir()) == []


def test_files_that_exist_survive_what_goes_wrong(tmp_path):
    file = tmp_path / "traces.jsonl"
    file.write_text("old")
    process = subprocess.Popen(
        [
            *RULEC,
            "maneuvers",
            "--traces",
            "s2",
            "--step",
            "0.25",
            "--first",
            "5000000",
            "-o",
            str(file),
        ],
        stderr=subprocess.PIPE,
        preexec_fn=as_from_a_terminal,
    )
    while len(list(tmp_path.iterdir())) < 2:
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    process.communicate()
    assert file.read_text() == "old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_device_is_written_to_and_stays_one():
    assert run(["maneuvers", "--traces", "s1", "-o", os.devnull]).returncode == 0
    assert not os.path.isfile(os.devnull)


def test_a_link_that_leads_nowhere_is_replaced_and_one_that_leads_somewhere_is_followed(tmp_path):
    loop, link, target = (tmp_path / f"{name}.jsonl" for name in ("loop", "link", "target"))
    loop.symlink_to(loop)
    link.symlink_to(target)
    target.write_text("old")
    for file in (loop, link):
        assert run(["maneuvers", "--traces", "s1", "-o", str(file)]).returncode == 0
        assert len(file.read_text().splitlines()) == 16
    assert link.is_symlink()
    assert target.read_text() != "old"


def test_compiled_files_appear_together_or_not_at_all(tmp_path):
    (tmp_path / "R2.hoa").mkdir()
    done = run(["compile", "esterle2019", "-o", str(tmp_path)])
    assert done.returncode == 2
    assert b"cannot be written: it is a folder" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["R2.hoa"]


def test_an_output_without_a_name_is_refused(tmp_path):
    done = subprocess.run(
        [*RULEC, "compile", "esterle2019", "-o", ""], cwd=tmp_path, capture_output=True, check=False
    )
    assert done.returncode == 2
    assert b"--output names no folder" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_no_encoding_holds(tmp_path):
    source = os.fsencode(tmp_path) + b"/r\xff.rules"
    with open(source, "w") as stream:
        stream.write("rulebook r\nsignal p\nhard rule A { require always p }\n")
    folder = str(tmp_path / "out")
    assert run(["compile", source, "-o", folder]).returncode == 0
    done = run(["verify", "-", "-r", f"{folder}/r.json"], input=b'{"states": [{"p": true}]}')
    assert done.returncode == 0


def test_counts_of_any_length():
    command = ["maneuvers", "s2", "-r", "esterle2019", "--step", "0.004"]
    # Longer than Python would write: the least that its limit can be is 640 digits.
    limited = {**os.environ, "PYTHONINTMAXSTRDIGITS": "640"}
    done = run([*command, "--json"], env=limited)
    assert done.returncode == 0
    assert re.search(rb'"traces": [0-9]{641,},', done.stdout)
    assert b"maneuvers   about " in run(command, env=limited).stdout


@pytest.mark.parametrize("option", ["--list", "--rank", "--classes"])
def test_a_list_longer_than_any(option):
    done = run([*MANEUVERS, "--json", option, "9" * 30])
    # All 16 satisfy; each is a class of its own or is not the only one in it.
    number = done.stdout.count(b'"margin_s"')
    assert (0 < number <= 16) if option == "--classes" else number == 16


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("printf 'trace,step\\nt,0\\n' | gzip", "not CSV but data compressed with gzip"),
        ("printf '{\"states\": [{}]}'", "not CSV but JSON"),
        # A pipe cannot be read again to find the byte's line.
        ("printf 'trace,step\\nt\\337,0\\n'", "here or further on the byte 0xdf is not UTF-8"),
        ("printf 'trace,'; sleep 0.1; printf 'step\\nt,1\\n'", "the step is `1`; it must be 0"),
    ],
)
def test_csv_in_a_pipe_that_cannot_be_read(command, words):
    arguments = ["verify", "-", "-r", "esterle2019", "--format", "csv"]
    done = shell(f'({command}) | "$@"', *arguments)
    assert done.returncode == 2
    assert words in done.stderr.decode()
    assert "Traceback" not in done.stderr.decode()

"""What the process that runs Spot can still do: to read, to compute, to answer."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import rulec
from rulec.automata import compiler
from support import hidden_spot

ATTEMPTS = """
import json, os, pathlib, socket, subprocess, sys
from rulec.automata.worker.confinement import confine
confined = confine()
folder = pathlib.Path(sys.argv[1])
attempts = {
    "files": {
        "write": lambda: (folder / "there").write_text("x"),
        "make": lambda: (folder / "new").write_text("x"),
        "folder": lambda: (folder / "new").mkdir(),
        "remove": lambda: (folder / "there").unlink(),
        "rename": lambda: (folder / "there").rename(folder / "new"),
        "link": lambda: (folder / "new").symlink_to("there"),
        "truncate": lambda: os.truncate(folder / "there", 0),
        "terminal": lambda: open("/dev/tty", "w"),
    },
    "connections": {
        "tcp": lambda: socket.create_connection(("127.0.0.1", 9)),
        "udp": lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM),
        "local": lambda: socket.socketpair(),
        "program": lambda: subprocess.run(["/bin/true"]),
        "exec": lambda: os.execv("/bin/true", ["true"]),
    },
}
refused = {}
for kind, tries in attempts.items():
    for name, attempt in tries.items():
        try:
            attempt()
            refused[name] = "done"
        except OSError as error:
            refused[name] = error.strerror
print(json.dumps([confined._asdict(), refused, (folder / "there").read_text()]))
"""


def test_a_confined_process_writes_nothing_and_talks_to_nobody(tmp_path):
    (tmp_path / "there").write_text("kept")
    done = subprocess.run(
        [sys.executable, "-c", ATTEMPTS, tmp_path], capture_output=True, text=True, check=True
    )
    confined, refused, kept = json.loads(done.stdout)
    if not all(confined.values()):
        pytest.skip(
            f"this kernel confines only {[kind for kind, held in confined.items() if held]}"
        )
    words = {"Permission denied", "Operation not permitted", "No such device or address"}
    assert {name: word for name, word in refused.items() if word not in words} == {}
    assert kept == "kept"
    assert [file.name for file in tmp_path.iterdir()] == ["there"]


def test_the_worker_says_that_it_is_confined():
    with compiler._worker("") as (process, spot):
        assert bool(spot) == hidden_spot.is_there()
        status = Path(f"/proc/{process.pid}/status").read_text()
    assert "NoNewPrivs:\t1" in status
    assert "Seccomp:\t2" in status


def test_where_it_cannot_be_confined_it_is_refused_if_so_asked_for(monkeypatch):
    book = rulec.parse_rulebook(
        "rulebook b\nsignal p default false\nhard rule r { require always not p }\n"
    )
    script = compiler._WORKER.replace("confine()", "type(confine())(False, True)")
    monkeypatch.setattr(compiler, "_WORKER", script)
    assert rulec.compile(book).rules
    monkeypatch.setenv("RULEC_REQUIRE_CONFINED", "1")
    with pytest.raises(rulec.RulecError, match=r"could write files \(no Landlock\)") as caught:
        compiler.answers_to([])
    assert [problem.code for problem in caught.value.diagnostics] == ["R0415"]

"""Memory and processor time of a whole call: what is spent ends it with one message."""

import resource
import subprocess
import sys

import pytest

from rulec import enforced_limits
from rulec.enforced_limits import HELD_A_BYTE, allow_for, enforced, limit_error
from rulec.resource_limits import MEMORY, VARIABLE

HUNGRY = (
    "import sys; from rulec.cli import main as door\n"
    "from rulec.cli.commands.reading import list as verb\n"
    "def eat(*_, **__): {}\n"
    "verb.command.callback = eat\n"
    "raise SystemExit(door.main())"
)


def called(eaten, *words):
    """What a call says, whose verb does something else."""
    program = [sys.executable, "-c", HUNGRY.format(eaten), *words, "list"]
    return subprocess.run(program, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("eaten", "limit", "unit"),
    [
        ("bytes(200_000_000)", "memory=100000000", "bytes of memory"),
        ("__import__('numpy').ones(50_000_000)", "memory=100000000", "bytes of memory"),
        ("[0 for _ in iter(int, 1)]", "seconds=1", "seconds of processor time"),
        (
            "__import__('subprocess').run([sys.executable, '-c', 'while True: pass'])",
            "seconds=1",
            "seconds of processor time",
        ),
    ],
)
def test_what_is_spent_ends_the_call(eaten, limit, unit):
    done = called(eaten, "--limit", limit)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("error[R0718]: more than ")
    assert unit in done.stderr
    assert f"--limit {limit.partition('=')[0]}=NUMBER" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_default_is_enforced():
    done = called(f"bytes({2 * MEMORY.usual})")
    assert done.returncode == 2
    assert f"the limit is {MEMORY.usual:,}" in done.stderr


def test_nothing_may_contain_spent_time():
    eaten = "__import__('contextlib').suppress(Exception).__enter__(); [0 for _ in iter(int, 1)]"
    assert called(eaten, "--limit", "seconds=1").returncode == 2


def soft():
    return resource.getrlimit(resource.RLIMIT_DATA)[0]


def test_memory_grows_with_the_bytes_of_each_file_once():
    before = soft()
    with enforced():
        begin = soft()
        for file, n_bytes in (("a", 10), ("b", 5), ("a", 30), ("a", 20)):
            allow_for(file, n_bytes)
        assert soft() == begin + HELD_A_BYTE * (30 + 5)
    assert soft() == before


def test_memory_that_is_set_does_not_grow(monkeypatch):
    monkeypatch.setenv(VARIABLE, f"memory={10**12}")
    with enforced():
        begin = soft()
        allow_for("a", 1000)
        assert soft() == begin


def test_programs_are_left_alone():
    before = soft()
    allow_for("a", 10**9)
    assert soft() == before


def test_other_problems_are_none_of_limits():
    with enforced():
        assert limit_error(ValueError("anything")) is None
        assert limit_error(OSError(2, "no such file")) is None
        assert limit_error(ImportError("no module")) is None
        assert limit_error(ImportError("x.so: failed to map segment")) is not None


def test_time_counts_children_that_run():
    program = "import time\nwhile time.process_time() < 0.5: pass\nprint(1, flush=True)\ninput()"
    begin = enforced_limits._used_s()
    with subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as child:
        child.stdout.readline()
        assert enforced_limits._used_s() - begin >= 0.4
        child.stdin.close()

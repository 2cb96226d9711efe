"""What is judged does not depend on how busy the machine is: from an empty cache, equal bytes."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from rulec.resource_limits import VARIABLE
from rulec.rulebook.reading.rulebook_reader import read_rulebook
from support.builders.recorded_data import DATA

SAMPLE = Path(__file__).parents[2] / "docs" / "samples" / "following.xml"
ENDINGS = (".xml", ".pb", ".osi", ".mcap", ".pkl", ".parquet", ".tfrecord", ".gz")
SHARED = [
    pytest.param(file, book, id=f"{book}-{file.name}")
    for file in sorted(DATA.rglob("*"))
    if file.name.endswith(ENDINGS)
    for book in ("de", "us-ca")
]
N_LOOPS = 4
HELD_UP_S = 0.1


@contextmanager
def busy_loops():
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(N_LOOPS)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def verdicts(file, book, cache, limits="", *, is_held_up=False):
    """Status, standard output and standard error of ``verify --json`` from an empty cache."""
    cache.mkdir(mode=0o700)
    environment = {
        **os.environ,
        "RULEC_CACHE_DIR": str(cache),
        VARIABLE: limits,
        "RULEC_QUIET": "1",
    }
    command = [sys.executable, "-m", "rulec", "verify", str(file), "-r", book, "--json"]
    out, err = cache / "out", cache / "err"
    with (
        out.open("wb") as output,
        err.open("wb") as errors,
        subprocess.Popen(command, env=environment, stdout=output, stderr=errors) as process,
    ):
        while is_held_up and process.poll() is None:
            for sent in (signal.SIGSTOP, signal.SIGCONT):
                process.send_signal(sent)
                time.sleep(HELD_UP_S)
    return process.returncode, out.read_bytes(), err.read_bytes()


def test_the_answer_is_the_same_if_others_have_the_processor_meanwhile(tmp_path):
    """Held up for half of the time, at no cost: what loops do to it that need the processor."""
    alone = verdicts(SAMPLE, "us-ca", tmp_path / "alone")
    assert verdicts(SAMPLE, "us-ca", tmp_path / "busy", is_held_up=True) == alone
    assert_each_rule_is_named(alone, "us-ca")


@pytest.mark.long
@pytest.mark.parametrize(("file", "book"), [(SAMPLE, "us-ca"), *SHARED])
def test_the_answer_is_the_same_beside_busy_loops_and_names_each_rule(file, book, tmp_path):
    alone = verdicts(file, book, tmp_path / "alone")
    with busy_loops():
        assert verdicts(file, book, tmp_path / "busy") == alone
    assert_each_rule_is_named(alone, book)


def assert_each_rule_is_named(alone, book):
    rules = {rule.name for rule in read_rulebook(book).rulebook.rules}
    for answer in map(json.loads, alone[1].splitlines()):
        if "judged" in answer:
            doubtful = {one["rule"] for one in (*answer["open"], *answer["not_judged"])}
            assert doubtful.isdisjoint(answer["judged"])
            assert doubtful.union(answer["judged"]) == rules


def test_time_that_is_spent_ends_the_call_and_leaves_no_rule_out(tmp_path):
    status, answers, said = verdicts(SAMPLE, "us-ca", tmp_path / "cache", "compiling=0")
    assert (status, answers, said.count(b"R0718")) == (2, b"", 1)

"""What is judged does not depend on how busy the machine is: from an empty cache, equal bytes."""

import json
import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

from rulec.resource_limits import VARIABLE
from rulec.rulebook.loader import read_rulebook
from support.builders.recorded_data import DATA

SAMPLE = Path(__file__).parents[2] / "docs" / "samples" / "following.xml"
ENDINGS = (".xml", ".pb", ".osi", ".mcap", ".pkl", ".parquet", ".tfrecord", ".gz")
SHARED = [
    pytest.param(file, book, marks=pytest.mark.long, id=f"{book}-{file.name}")
    for file in sorted(DATA.rglob("*"))
    if file.name.endswith(ENDINGS)
    for book in ("de", "us-ca")
]
N_LOOPS = 4


@contextmanager
def busy_loops():
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(N_LOOPS)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def verdicts(file, book, cache, limits=""):
    """Status, standard output and standard error of ``verify --json`` from an empty cache."""
    cache.mkdir(mode=0o700)
    environment = {
        **os.environ,
        "RULEC_CACHE_DIR": str(cache),
        VARIABLE: limits,
        "RULEC_QUIET": "1",
    }
    command = [sys.executable, "-m", "rulec", "verify", str(file), "-r", book, "--json"]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize(("file", "book"), [(SAMPLE, "us-ca"), *SHARED])
def test_the_answer_is_the_same_beside_busy_loops_and_names_each_rule(file, book, tmp_path):
    alone = verdicts(file, book, tmp_path / "alone")
    with busy_loops():
        assert verdicts(file, book, tmp_path / "busy") == alone
    rules = {rule.name for rule in read_rulebook(book).rulebook.rules}
    for answer in map(json.loads, alone[1].splitlines()):
        if "judged" in answer:
            doubtful = {one["rule"] for one in (*answer["open"], *answer["not_judged"])}
            assert doubtful.isdisjoint(answer["judged"])
            assert doubtful.union(answer["judged"]) == rules


def test_time_that_is_spent_ends_the_call_and_leaves_no_rule_out(tmp_path):
    status, answers, said = verdicts(SAMPLE, "us-ca", tmp_path / "cache", "compiling=0")
    assert (status, answers, said.count(b"R0718")) == (2, b"", 1)

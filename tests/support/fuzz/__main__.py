"""Hostile inputs for every kind that rulec reads, and for its verbs' words.

`.ci/task fuzz [--seconds N] [--first SEED] [TARGET …]`
"""

import argparse
import subprocess
import sys
import tempfile
from itertools import count
from pathlib import Path

from support.fuzz.targets import TARGETS
from support.fuzz.trial import summary, tried


def main():
    parser = argparse.ArgumentParser(prog=".ci/task fuzz", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument("--seconds", type=float, default=3600, help="altogether")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first of them")
    words = parser.parse_args()
    names = words.names or list(TARGETS)
    seconds = words.seconds / len(names)
    if len(names) > 1:
        return max([_in_its_own_process(name, seconds, words.first) for name in names])
    with tempfile.TemporaryDirectory() as folder:
        trial = tried(*names, Path(folder), count(words.first), seconds)
    print(summary(trial), flush=True)
    return 1 if trial.failures else 0


def _in_its_own_process(name, seconds, first):
    """So that what ends it, as libraries in C++ may, does not end the others."""
    again = [sys.executable, "-m", "support.fuzz", name, f"--seconds={seconds}", f"--first={first}"]
    status = subprocess.run(again, check=False).returncode
    if status < 0:
        print(f"{name}: ended by signal {-status}; the last input is in {tempfile.gettempdir()}")
    return abs(status)


if __name__ == "__main__":
    sys.exit(main())

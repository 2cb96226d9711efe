"""Hostile inputs for every kind that rulec reads, and for its verbs' words.

`.ci/task fuzz [--seconds N] [--first SEED] [TARGET …]`
"""

import argparse
import sys
import tempfile
import time
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
    failed = False
    for name in names:
        until = time.monotonic() + words.seconds / len(names)
        with tempfile.TemporaryDirectory() as folder:
            trial = tried(name, Path(folder), count(words.first), until)
        print(summary(trial), flush=True)
        failed |= bool(trial.failures)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

"""How long whole processes take: `rulec check` on the largest rulebook, and the least there is.

    .venv/bin/python tests/benchmarks/starting.py [RUNS]

Every process is started anew, in turns, so that a busy moment of the machine meets all of them; a
line each with the median and the fastest, in milliseconds.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rulec.rulebook.finding import available_rulebooks, find_rulebook
from rulec.rulebook.loader import diagnose

CHECK = [sys.executable, "-m", "rulec", "check"]


def main(runs: int) -> None:
    """Print the times of so many runs."""
    name, files, size = largest()
    print(f"largest rulebook: {name}, {size:,} bytes in {files} files with all it builds upon")
    commands = {
        "python -c pass": [sys.executable, "-c", "pass"],
        "rulec --version": [sys.executable, "-m", "rulec", "--version"],
        f"rulec check {name}": [*CHECK, name],
        f"rulec check {name} --no-cache": [*CHECK, name, "--no-cache"],
    }
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "RULEC_CACHE_DIR": cache}
        times: dict[str, list[float]] = {label: [] for label in commands}
        for turn in range(runs + 1):
            for label, command in commands.items():
                taken = timed(command, environment)
                if turn:  # the first run fills the cache, and those of Python and the disk
                    times[label].append(taken)
    width = max(map(len, times))
    for label, taken_all in times.items():
        middle, least = statistics.median(taken_all), min(taken_all)
        print(f"{label:{width}}  median {middle:6.1f} ms  fastest {least:6.1f} ms")


def largest() -> tuple[str, int, int]:
    """The shipped rulebook with the most bytes in all its files: name, files, bytes."""
    sizes = {}
    for name in available_rulebooks():
        path = find_rulebook(name, ())
        others = diagnose(str(path), path.read_bytes(), path).dependencies or ()
        files = {str(path), *(one.path for one in others)}
        sizes[name] = (sum(Path(one).stat().st_size for one in files), len(files))
    name = max(sizes, key=lambda one: sizes[one])
    return name, sizes[name][1], sizes[name][0]


def timed(command: list[str], environment: dict[str, str]) -> float:
    """Milliseconds of a process, from its start to its end."""
    start = time.perf_counter()
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    return (time.perf_counter() - start) * 1000


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)

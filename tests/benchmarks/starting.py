"""How long whole processes take, from their start to their end: the least there is, and commands.

Processes start in turns, by the launcher if its environment runs this. Processor time counts,
theirs and that of the processes that they start; how long one waits is said beside it.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from figure import Result, number
from program import run
from timing import children_ms, in_turns

from rulec.rulebook.files.search_path import available_rulebooks, find_rulebook
from rulec.rulebook.loader import diagnose
from support.builders.sumo_files import body, data, moment, written

ROOT = Path(__file__).resolve().parents[2]
LAUNCHED = Path(sys.prefix) == ROOT / ".venv"
RULEC = [str(ROOT / "rulec")] if LAUNCHED else [sys.executable, "-m", "rulec"]
BARE = "python -c pass"
JUDGED = "verify -r {}"
MANEUVERS = "maneuvers s2 --step 0.5 --rulebook esterle2019"


def measure(rounds: int) -> Iterator[Result]:
    """Bare Python, then commands."""
    name, files, size = largest()
    wanted = {
        "--version": 60,
        MANEUVERS: 450,
        f"check {name}": 150,
        f"check {name} --no-cache": None,
        JUDGED.format(name): 300,
    }
    commands = {BARE: [sys.executable, "-c", "pass"]}
    commands |= {command: [*RULEC, *command.split()] for command in wanted}
    with tempfile.TemporaryDirectory() as cache, tempfile.TemporaryDirectory() as drive:
        written(Path(drive), data(*(moment(k / 2, body(x=20 + 5 * k)) for k in range(4))))
        net = str(Path(drive, "road.net.xml"))
        commands[JUDGED.format(name)] += [str(Path(drive, "fcd.xml")), "--map", net]
        environment = {**os.environ, "RULEC_CACHE_DIR": cache}
        # Where somebody keeps Python from writing bytecode, every process would compile anew.
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        waited: dict[str, list[float]] = {label: [] for label in commands}
        taken = in_turns(
            {
                label: lambda label=label: process(commands[label], environment, waited[label])
                for label in commands
            },
            rounds,
        )
    figures = [
        taken[command].figure(f"rulec {command}", "ms", most) for command, most in wanted.items()
    ]
    yield Result(
        "Whole processes",
        "each started anew, after a first run that has filled the cache; the largest rulebook is "
        f"{name}, {size:,} bytes in {files} files with all it builds upon; what is verified is one "
        "drive of four states",
        [*figures, taken[BARE].figure(BARE, "ms")],
        [
            "From start to end one waits, in the same rounds, "
            + ", ".join(
                f"{number(statistics.median(times[1:]))} ms for "
                + (f"`{label}`" if label == BARE else f"`rulec {label}`")
                for label, times in waited.items()
            )
            + "."
        ],
    )


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


def process(command: list[str], environment: dict[str, str], waited: list[float]) -> float:
    """Milliseconds of processor time of a process; how long it took goes into ``waited``."""
    start, before = time.perf_counter(), children_ms()
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    waited.append((time.perf_counter() - start) * 1e3)
    return children_ms() - before


if __name__ == "__main__":
    run(measure, rounds=15)

"""How long recordings take from the command line: what vehicles did, and what they could do.

All of CommonRoad's recordings, if RULEC_RECORDINGS names the folder that they are in, and SUMO's in
the folder `sumo` beside it. Whole processes, of which the first compiles and the others find what
it has kept. RULEC_OLDER may name checkouts of older commits, separated by colons, whose `rulec` is
measured beside this one, each in its turn, in its own `.venv` if it has one.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from figure import Figure, Result
from program import run
from starting import ROOT, RULEC
from timing import children_ms

MOST_S = 120
TURNS = 2


def measure(_rounds: int) -> Iterator[Result]:
    """Once: it takes so long that a busy moment does not matter."""
    folder = os.environ.get("RULEC_RECORDINGS")
    if not folder:
        return
    files = sorted(Path(folder).glob("*.xml"))
    verify = seconds("verify", *files, "-r", "de", "--explain", "0")
    maneuvers = sum(seconds("maneuvers", file, "-r", "de") for file in files)
    yield Result(
        "All recordings: de",
        f"the {len(files)} recordings, every vehicle of each as ego (`rulec verify`, all in one "
        "call), and every way on from where each begins (`rulec maneuvers`, a call each); measured "
        "once",
        [
            figure("rulec verify", verify),
            figure("rulec maneuvers", maneuvers),
            figure("both", verify + maneuvers, MOST_S),
        ],
    )
    yield from beside_older(Path(folder))
    data = Path(folder).parent / "sumo" / "fcd.xml.gz"
    if data.exists():
        yield Result(
            "Floating-car data",
            "150 s at 0.1 s of 61 vehicles and 14 pedestrians, every vehicle as ego (`rulec "
            "verify`); measured once",
            [
                figure(f"under {book}", seconds("verify", data, "-r", book, "--explain", "0"))
                for book in ("de", "gb")
            ],
        )


def beside_older(folder: Path) -> Iterator[Result]:
    """Two recordings on one core, judged by this commit and by older ones in turns."""
    older = [Path(one) for one in os.environ.get("RULEC_OLDER", "").split(":") if one]
    files = [folder.parent / "sumo" / "fcd.xml.gz", folder / "USA_US101-24_2_T-1.xml"]
    for file in filter(Path.exists, files if older else ()):
        # The first time each compiles what it finds later
        turns = [[judged(file, one) for one in (ROOT, *older)] for _ in range(1 + TURNS)][1:]
        now, *before = zip(*turns, strict=True)
        named = [(f"commit {commit(one)}", then) for one, then in zip(older, before, strict=True)]
        peer, then = named[0]
        ratio = median(slow / quick for slow, quick in zip(then, now, strict=True))
        own = Figure("rulec", "s", median(now), min(now), peer=peer, ratio=ratio)
        yield Result(
            f"Judging on one core: {file.name.split('.')[0]}",
            "the whole process, every vehicle as ego under `de` without explanations, in turns "
            "with older commits",
            [own, *(Figure(name, "s", median(times), min(times)) for name, times in named)],
        )


def judged(file: Path, checkout: Path) -> float:
    """Processor time (s) of judging a recording on one core by a checkout."""
    own = checkout / ".venv" / "bin" / "python"
    python = own if own.exists() else sys.executable
    command = [str(python), "-m", "rulec", "verify", str(file), "-r", "de", "--explain", "0"]
    path = {"PYTHONPATH": str(checkout / "src"), "RULEC_JOBS": "1"}
    return timed(command, {**os.environ, **path}, (0, 1))


def commit(checkout: Path) -> str:
    """The short name of the commit that is checked out."""
    asked = ["git", "-C", str(checkout), "rev-parse", "--short=8", "HEAD"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()


def seconds(*arguments: str | Path) -> float:
    """Processor time of a call of rulec, with that of the processes that it starts."""
    return timed([*RULEC, *map(str, arguments)], dict(os.environ))


def timed(
    command: list[str], environment: dict[str, str], fine: tuple[int, ...] = (0, 1, 2)
) -> float:
    """Processor time (s) of a command that judges, and ends with a status that is fine."""
    before = children_ms()
    done = subprocess.run(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    if done.returncode not in fine or "Traceback" in done.stderr:
        raise RuntimeError(done.stderr)
    return (children_ms() - before) / 1000


def figure(what: str, taken_s: float, most: float | None = None) -> Figure:
    """Measured once."""
    return Figure(what, "s", taken_s, taken_s, most)


if __name__ == "__main__":
    run(measure, rounds=1)

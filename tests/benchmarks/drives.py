"""How long recordings take from the command line: what vehicles did, and what they could do.

All of CommonRoad's recordings, if RULEC_RECORDINGS names the folder that they are in, and SUMO's in
the folder `sumo` beside it. Whole processes, of which the first compiles and the others find what
it has kept.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

from figure import Figure, Result
from program import run
from starting import RULEC
from timing import children_ms

MOST_S = 120


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


def seconds(*arguments: str | Path) -> float:
    """Processor time of a call of rulec, with that of the processes that it starts."""
    before = children_ms()
    done = subprocess.run(
        [*RULEC, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    if done.returncode not in (0, 1, 2) or "Traceback" in done.stderr:
        raise RuntimeError(done.stderr)
    return (children_ms() - before) / 1000


def figure(what: str, taken_s: float, most: float | None = None) -> Figure:
    """Measured once."""
    return Figure(what, "s", taken_s, taken_s, most)


if __name__ == "__main__":
    run(measure, rounds=1)

"""What a call holds and how long it takes for the worst files, in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from support.mutations.worst_files import Files, unpacked_bytes

LIBRARIES_BYTES = 150_000_000
"""What a call holds that judges a recording of two cars, NumPy, Shapely and Arrow loaded."""

FREE_BYTES, HELD_A_BYTE = 100_000_000, 50
FREE_S, SECONDS_A_MB = 10.0, 10.0
BOOK = """rulebook small
use road
hard rule apart (v: vehicle) { require always (in_front_of(v) implies gap(v) > 1 m) }
"""

# A small process between: what a process holds when it starts another counts for that one, too
_MEASURED = """
import json, resource, subprocess, sys
done = subprocess.run(sys.argv[1:], capture_output=True, text=True, errors="replace")
used = resource.getrusage(resource.RUSAGE_CHILDREN)
said = done.stderr or done.stdout
json.dump(
    (done.returncode, used.ru_maxrss * 1024, used.ru_utime + used.ru_stime, said), sys.stdout
)
"""


@dataclass(frozen=True)
class Cost:
    """The cost of a call: its status, what it said, the most bytes held, its processor time (s)."""

    status: int
    said: str
    held: int
    seconds: float
    unpacked: int

    @property
    def may_hold(self) -> int:
        """The most bytes that it may hold."""
        return LIBRARIES_BYTES + FREE_BYTES + HELD_A_BYTE * self.unpacked

    @property
    def may_take_s(self) -> float:
        """The most processor time (s) that it may take."""
        return FREE_S + SECONDS_A_MB * self.unpacked / 1e6


def cost_of(files: Files, folder: Path) -> Cost:
    """The cost of judging the first of some files."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    (folder / "small.rules").write_text(BOOK, encoding="utf-8")
    words = ["verify", next(iter(files)), "-r", "./small.rules", "--jobs", "1"]
    roads = next((name for name in files if name.startswith("roads.")), None)
    words += ["--map", roads] if roads else []
    command = [sys.executable, "-c", _MEASURED, sys.executable, "-m", "rulec", *words]
    told = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    status, held, seconds, said = json.loads(told.stdout)
    return Cost(
        status,
        said,
        held,
        seconds,
        unpacked_bytes(files),
    )

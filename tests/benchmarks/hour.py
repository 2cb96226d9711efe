"""How long an hour of a town's traffic takes to judge, and how much memory, beside ten minutes.

SUMO makes the traffic, if RULEC_SUMO names the folder of its programs. Whole processes on all
cores, with the findings of every vehicle's whole drive; how many cores the machine has stands at
the head of the page.
"""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event, Thread

from figure import Figure, Result
from program import run
from starting import RULEC
from timing import children_ms

from support.worlds.demand import Demand
from support.worlds.simulate import WorldKind, simulate

STEP_S = 1.0
LENGTHS_S = (600, 3600)
VEHICLES_AN_HOUR = 1_790
"""So many that sixty are there at a time."""

MOST_S = 60
LOOKED_S = 0.2
"""How often the memory of all processes is looked at."""


def measure(_rounds: int) -> Iterator[Result]:
    """Once: it takes so long that a busy moment does not matter."""
    programs = os.environ.get("RULEC_SUMO")
    if not programs:
        return
    figures: list[Figure] = []
    notes: list[str] = []
    for length_s in LENGTHS_S:
        with TemporaryDirectory() as folder:
            data, net = traffic(Path(programs), Path(folder), length_s)
            judged(data, net)  # it compiles what the next one finds, and warms up
            spent = judged(data, net)
            n_states = data.read_text(encoding="utf-8").count("<vehicle ")
        name = f"{length_s:,} s, "
        figures += [
            one(f"{name}waited", "s", spent.waited_s, MOST_S if length_s == 3600 else None),
            one(f"{name}processor time", "s", spent.processor_s),
            one(f"{name}a state", "µs", spent.processor_s * 1e6 / n_states),
            one(f"{name}memory of all processes", "MB", spent.most_mb),
        ]
        notes.append(
            f"{length_s:,} s: {n_states:,} states of vehicles, {n_states / length_s * STEP_S:.1f} "
            f"at a time; {spent.n_findings:,} findings."
        )
    yield Result(
        "An hour of traffic",
        f"a town's traffic by SUMO in steps of {STEP_S:g} s, every vehicle as ego under `de`, with "
        "findings, on all cores; the memory of each process without what it shares with others, "
        "and a part of that; measured once",
        figures,
        notes,
    )


def one(what: str, unit: str, value: float, most: float | None = None) -> Figure:
    """Measured once."""
    return Figure(what, unit, value, value, most)


def traffic(programs: Path, folder: Path, length_s: int) -> tuple[Path, Path]:
    """Floating-car data of a town and its net, from its first vehicle on."""
    demand = Demand(
        vehicles=VEHICLES_AN_HOUR * length_s // 3600,
        over_s=length_s,
        planted={"red_runner": 0.02, "speeder": 0.05, "tailgater": 0.05},
    )
    kind = WorldKind(
        name="town", layout="town", demand=demand, book="de", ends_s=length_s, lane_change_s=3.0
    )
    files = simulate(programs, kind, 1, folder, STEP_S)
    return files.data, files.net


class Spent:
    """What judging took."""

    def __init__(
        self, waited_s: float, processor_s: float, most_mb: float, n_findings: int
    ) -> None:
        self.waited_s, self.processor_s = waited_s, processor_s
        self.most_mb, self.n_findings = most_mb, n_findings


def judged(data: Path, net: Path) -> Spent:
    """`rulec verify` of a recording, from start to end."""
    findings = data.with_name("findings.jsonl")
    command = [*RULEC, "verify", str(data), "--map", str(net), "-r", "de"]
    command += ["--explain", "0", "-o", str(findings)]
    start, before = time.perf_counter(), children_ms()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        memory = Memory(process.pid)
        status = process.wait()
        most_mb = memory.most_mb()
    if status not in (0, 1):
        raise RuntimeError(f"no verdicts: status {status}")
    waited_s, processor_s = time.perf_counter() - start, (children_ms() - before) / 1e3
    with findings.open(encoding="utf-8") as lines:
        return Spent(waited_s, processor_s, most_mb, sum(1 for _ in lines))


class Memory:
    """The most that a process and all that it has started held at once, looked at often."""

    def __init__(self, process: int) -> None:
        self._most_kb, self._done = 0, Event()
        self._thread = Thread(target=self._look, args=(process,))
        self._thread.start()

    def most_mb(self) -> float:
        """What it was, when the process is done."""
        self._done.set()
        self._thread.join()
        return self._most_kb / 1e3

    def _look(self, process: int) -> None:
        while not self._done.wait(LOOKED_S):
            self._most_kb = max(self._most_kb, sum(map(held_kb, family(process))))


def family(process: int) -> Iterator[int]:
    """A process and those that it, and they, have started and that still run."""
    yield process
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            children = task.read_text().split()
        except OSError:  # it has just ended
            continue
        for child in children:
            yield from family(int(child))


def held_kb(process: int) -> int:
    """What a process holds, of what several hold its part, in kB; none if it has ended."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)


if __name__ == "__main__":
    run(measure, rounds=1)

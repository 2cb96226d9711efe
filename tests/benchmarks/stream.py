"""How long `rulec monitor` takes for a line of its standard input, from the pipe to the answer.

What a process takes that gets no line is taken off. Reading the same lines by Python's `json` alone
is measured beside.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from collections.abc import Iterator
from functools import partial
from itertools import islice

from driving import PLACES, drive
from figure import Result
from starting import RULEC
from timing import Timed, children_ms, in_turns, processor_time

N_LINES = 50_000
RULEBOOK = "esterle2019"
VEHICLES = (1, 16)


def streamed(rounds: int) -> Result:
    """A stream with few and one with more vehicles."""
    with tempfile.TemporaryDirectory() as cache:
        tasks: dict[str, Timed] = {}
        for n_vehicles in VEHICLES:
            lines = [json.dumps(one).encode() + b"\n" for one in records(n_vehicles)]
            tasks[ours(n_vehicles)] = partial(monitored, lines, cache)
            work = partial(all_read, lines)
            tasks[alone(n_vehicles)] = processor_time(work, N_LINES)
        taken = in_turns(tasks, rounds)
    return Result(
        "Online: a stream",
        f"{N_LINES:,} lines through `rulec monitor {RULEBOOK}`; per line",
        [taken[ours(n)].against(taken[alone(n)], "json.loads", ours(n), "ns") for n in VEHICLES],
    )


def ours(n_vehicles: int) -> str:
    """A figure's name."""
    return f"vehicles in a line: {n_vehicles}"


def alone(n_vehicles: int) -> str:
    """What it is compared with."""
    return f"json.loads, {ours(n_vehicles)}"


def records(n_vehicles: int) -> Iterator[object]:
    """What the lines say."""
    objects = {f"v{number}": "vehicle" for number in range(n_vehicles)}
    for state in islice(drive(PLACES[RULEBOOK], list(objects)), N_LINES):
        yield {"state": state, "objects": objects}


def monitored(lines: list[bytes], cache: str) -> float:
    """Nanoseconds per line, without those that the process takes anyway."""
    return (used(b"".join(lines), cache) - used(b"", cache)) * 1e6 / len(lines)


def used(text: bytes, cache: str) -> float:
    """Milliseconds of processor time of a process with this input."""
    before = children_ms()
    subprocess.run(
        [*RULEC, "monitor", RULEBOOK],
        input=text,
        env={**os.environ, "RULEC_CACHE_DIR": cache},
        stdout=subprocess.DEVNULL,
        # One if the drive violates a hard rule, which sooner or later it does.
        check=False,
    )
    return children_ms() - before


def all_read(lines: list[bytes]) -> None:
    """What any program does."""
    for line in lines:
        json.loads(line)

"""How long it takes from a file to its verdicts, in every format; beside it, reading it alone.

The traces are of vehicles with names of their own, as recorded drives are.
"""

from __future__ import annotations

import csv
import json
import random
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import get_args

from figure import Result
from program import run
from pyarrow import parquet
from timing import Timed, children_ms, in_turns, processor_time

import rulec
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.trace import Trace
from rulec.trace.formats.trace_files import Format, format_of, read_chunks, write_traces

N_TRACES, N_STATES, N_VEHICLES = 5_000, 20, 3
WORK = float(N_TRACES * N_STATES)
KINDS = {"surface": str, "position": str}
NAMES: dict[Format, str] = {"jsonl": "JSON Lines", "csv": "CSV", "parquet": "Parquet"}
ALONE = {"jsonl": "json.loads", "csv": "csv.reader", "parquet": "pyarrow's read_table"}


def measure(rounds: int) -> Iterator[Result]:
    """Every format."""
    rules = rulec.compile_rulebook("esterle2019")
    with tempfile.TemporaryDirectory() as folder:
        files = [written(Path(folder), form) for form in get_args(Format)]
        tasks: dict[str, Timed] = {}
        for file in files:
            form = format_of(str(file))
            name, alone = NAMES[form], ALONE[form]
            tasks[f"{name} to verdicts"] = processor_time(to_verdicts(file, rules), WORK)
            tasks[alone] = processor_time(reading(file), WORK)
            tasks[f"rulec verify, {name}"] = whole_process(file)
        taken = in_turns(tasks, rounds)
        sizes = ", ".join(f"{NAMES[format_of(one.name)]} {one.stat().st_size:,}" for one in files)
    figures = []
    for form, name in NAMES.items():
        peer = taken[ALONE[form]]
        figures += [
            taken[f"{name} to verdicts"].against(peer, ALONE[form], f"{name} to verdicts", "ns"),
            taken[f"rulec verify, {name}"].figure(f"rulec verify, {name}", "ns"),
            peer.figure(f"{ALONE[form]} alone", "ns"),
        ]
    yield Result(
        "From a file to verdicts",
        f"{N_TRACES:,} traces of {N_STATES} states and {N_VEHICLES} vehicles with names of their "
        f"own, {len(rules.rules)} rules; per trace and step",
        figures,
        [
            f"Bytes: {sizes}.",
            "`rulec verify` is a whole process, with its start and the violations that it prints.",
        ],
    )


def written(folder: Path, form: Format) -> Path:
    """A file of random traces."""
    chance = random.Random(1)
    file = folder / f"traces.{form}"
    with file.open("wb") as stream:
        traces = (trace(chance, number) for number in range(N_TRACES))
        write_traces(traces, stream, str(file), form, KINDS)
    return file


def trace(chance: random.Random, number: int) -> Trace:
    """Vehicles that pass, mostly ahead."""
    names = [f"{number}.{place}" for place in range(N_VEHICLES)]
    states = tuple(
        {
            "surface": chance.choice(["R_cw", "R_pc"]),
            "position": {name: chance.choices("bfl", [1, 30, 1])[0] for name in names},
        }
        for _ in range(N_STATES)
    )
    return Trace(f"t{number}", 0.5, dict.fromkeys(names, "vehicle"), states)


def to_verdicts(file: Path, rules: rulec.CompiledRulebook) -> Callable[[], object]:
    """The file read and judged as `rulec verify` does, in this process."""

    def judged() -> int:
        with file.open("rb") as stream:
            chunks = read_chunks(stream, str(file), format_of(str(file)))
            return sum(
                len([*answers]) for items in chunks for _, answers in verify_items(items, rules)
            )

    return judged


def reading(file: Path) -> Callable[[], object]:
    """The file read by what reads such files, and nothing done with it."""
    match format_of(str(file)):
        case "parquet":
            return lambda: parquet.read_table(file)
        case "csv":
            return lambda: rows_of(file)
        case _:
            return lambda: [json.loads(line) for line in file.read_bytes().splitlines()]


def rows_of(file: Path) -> list[list[str]]:
    """All rows of a CSV file."""
    with file.open(encoding="utf-8", newline="") as text:
        return list(csv.reader(text))


def whole_process(file: Path) -> Timed:
    """`rulec verify` from start to end."""
    command = [sys.executable, "-m", "rulec", "verify", str(file)]
    command += ["--rulebook", "esterle2019", "--explain", "0"]

    def timed() -> float:
        before = children_ms()
        done = subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
        assert done.returncode in (0, 1), "no verdicts"
        return (children_ms() - before) * 1e6 / WORK

    return timed


if __name__ == "__main__":
    run(measure, rounds=5)

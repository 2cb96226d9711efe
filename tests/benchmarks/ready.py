"""How long ready traces take from a file to findings, whole processes, and how much memory.

Three vehicles with names of their own, numbers, truth values and an enumeration, so that hardly any
state is met twice. ``RULEC_BEFORE`` may name the checkout of an older rulec, which is measured in
the same rounds; it writes verdicts, for findings came later, and compiles the rules anew.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
import pyarrow
from figure import Figure, Result
from program import run
from pyarrow import csv, parquet
from timing import Timed, in_turns, processor_time

N_TRACES, N_STATES, N_VEHICLES = 4_000, 100, 3
SIZES = (250, 1_000, 4_000)
"""Traces of the files by which memory is judged."""

FORMATS = {"jsonl": "JSON Lines", "csv": "CSV", "parquet": "Parquet"}
WANTED_US = 2.0
LANES = np.array(["right_lane", "middle_lane", "left_lane"])
BOOK = """\
rulebook ready
type vehicle
signal congested default false
signal braking(v: vehicle)
lane(v: vehicle) is one of right_lane, middle_lane, left_lane
quantity speed(v: vehicle) in km/h
quantity gap(v: vehicle) in m
hard rule limit (v: vehicle) { require always (congested implies speed(v) <= 80 km/h) }
hard rule keep_right (v: vehicle) {
  require always (left_lane(v) implies eventually[<= 10 s] not left_lane(v))
}
hard rule distance (v: vehicle) {
  require always (gap(v) < 5 m implies weak next (braking(v) or gap(v) >= 5 m))
}
"""

WATCH = """
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss)
sys.exit(done.returncode not in (0, 1))
"""
"""A small program that starts another one: a process begins with the peak of who started it."""

READING = "a process that calls read_table once"
STARTING = "one trace alone, by as many states"
"""The start and the end of a process, which are a part of what every file takes."""

Drives = Mapping[str, np.ndarray]
"""What is said: ``congested`` (traces x states), the rest (traces x vehicles x states)."""


def measure(rounds: int) -> Iterator[Result]:
    """Time, then memory."""
    with tempfile.TemporaryDirectory() as folder:
        here = Path(folder)
        (here / "ready.rules").write_text(BOOK, encoding="utf-8")
        rulec(Path.cwd(), "compile", "ready.rules", "-o", ".", "--step", "0.5", folder=here)
        yield times(here, rounds)
        yield memory(here)


def times(here: Path, rounds: int) -> Result:
    """Every format, beside reading alone, one rule by hand, and an older rulec."""
    drives = made(N_TRACES)
    files = {form: written(here / f"traces.{form}", drives) for form in FORMATS}
    few = written(here / "few.jsonl", made(1))
    work = N_TRACES * N_STATES * 1e3
    tasks: dict[str, Timed] = {STARTING: whole_process(here, Path.cwd(), few.name)}
    checkouts = {"": Path.cwd()}
    if "RULEC_BEFORE" in os.environ:
        checkouts[", before"] = Path(os.environ["RULEC_BEFORE"])
    for form, name in FORMATS.items():
        for which, checkout in checkouts.items():
            tasks[f"{name} to findings{which}"] = whole_process(here, checkout, files[form].name)
    tasks["pyarrow's read_table"] = processor_time(
        lambda: parquet.read_table(files["parquet"]), work
    )
    tasks[READING] = lambda: once_read(files["parquet"]) * 1e6 / (N_TRACES * N_STATES)
    tasks["numpy by hand, one rule of Parquet"] = processor_time(by_hand(files["parquet"]), work)
    taken = in_turns(tasks, rounds)
    reading = taken[READING]
    figures = []
    for name in tasks:
        if name == "Parquet to findings":
            figures.append(taken[name].against(reading, "a process", name, "µs", WANTED_US, 1 / 3))
        elif name in (f"{form} to findings" for form in FORMATS.values()):
            figures.append(taken[name].figure(name, "µs", WANTED_US))
        else:
            figures.append(taken[name].figure(name, "µs"))
    lines = (here / "findings.jsonl").read_text(encoding="utf-8").count("\n")
    return Result(
        "Ready traces to findings",
        f"{N_TRACES:,} traces of {N_STATES} states and {N_VEHICLES} vehicles, 3 rules; "
        "whole processes, per trace and step",
        figures,
        [
            f"{lines:,} findings, each with its time and its margin.",
            "Bytes: "
            + ", ".join(f"{name} {files[form].stat().st_size:,}" for form, name in FORMATS.items())
            + ".",
        ],
    )


def memory(here: Path) -> Result:
    """The most memory of a process, by the number of traces in a file."""
    figures = []
    for form, name in FORMATS.items():
        for n_traces in SIZES:
            file = written(here / f"some.{form}", made(n_traces))
            _, peak = verified(here, Path.cwd(), file.name)
            figures.append(Figure(f"{name}, {n_traces:,} traces", "MB", peak, peak))
    return Result(
        "Memory of ready traces",
        f"files of so many traces of {N_STATES} states; the most that the process held",
        figures,
    )


def made(n_traces: int) -> Drives:
    """Random drives, of which a few violate a rule."""
    chance = np.random.default_rng(1)
    shape = (n_traces, N_VEHICLES, N_STATES)
    start = chance.normal(60, 5, (*shape[:2], 1))
    speed = np.maximum(start + np.cumsum(chance.normal(0, 0.4, shape), axis=2), 0).round(2)
    start = chance.normal(45, 8, (*shape[:2], 1))
    gap = np.maximum(start + np.cumsum(chance.normal(0, 0.5, shape), axis=2), 1).round(2)
    braking = (chance.random(shape) < 0.1) | (gap < 5) & (chance.random(shape) > 0.02)
    lane = np.zeros(shape, dtype=np.int64)
    now = chance.integers(0, 2, shape[:2])
    for state in range(N_STATES):
        moves, up = chance.random(shape[:2]), chance.random(shape[:2]) < 0.3
        now = np.where(
            (now == 2) & (moves < 0.4), 1, np.where((now < 2) & (moves < 0.06), now + 1, now)
        )
        now = np.where((now == 1) & (moves > 0.95) & ~up, 0, now)
        lane[:, :, state] = now
    # Nobody is on the left when it ends.
    lane[:, :, -1] = np.minimum(lane[:, :, -1], 1)
    congested = np.repeat(chance.random((n_traces, N_STATES // 10)) < 0.05, 10, axis=1)
    return {"congested": congested, "braking": braking, "lane": lane, "speed": speed, "gap": gap}


def written(file: Path, drives: Drives) -> Path:
    """A file of drives, as other programs write them."""
    if file.suffix == ".jsonl":
        with file.open("w", encoding="utf-8") as stream:
            stream.writelines(f"{json.dumps(trace)}\n" for trace in traces(drives))
    elif file.suffix == ".csv":
        csv.write_csv(table(drives), file)
    else:
        parquet.write_table(table(drives), file)
    return file


def traces(drives: Drives) -> Iterator[dict[str, object]]:
    """Each drive as a line has it."""
    about = {**drives, "lane": LANES[drives["lane"]]}
    del about["congested"]
    for number, congested in enumerate(drives["congested"].tolist()):
        names = [f"{number}.{vehicle}" for vehicle in range(N_VEHICLES)]
        columns = {name: values[number].T.tolist() for name, values in about.items()}
        states = [
            {"congested": is_congested}
            | {
                name: dict(zip(names, values[state], strict=True))
                for name, values in columns.items()
            }
            for state, is_congested in enumerate(congested)
        ]
        objects = dict.fromkeys(names, "vehicle")
        yield {"id": f"t{number}", "step_s": 0.5, "objects": objects, "states": states}


def table(drives: Drives) -> pyarrow.Table:
    """A row for each state, and one for each vehicle in it."""
    n_traces, n_rows = len(drives["congested"]), 1 + N_VEHICLES
    trace = np.repeat(np.arange(n_traces), N_STATES * n_rows)
    who = np.tile(np.arange(n_rows), n_traces * N_STATES)
    world = who == 0

    def about(values: np.ndarray) -> np.ndarray:
        rows = np.zeros((n_traces, N_STATES, n_rows), dtype=values.dtype)
        rows[:, :, 1:] = np.moveaxis(values, 1, 2)
        return rows.ravel()

    congested = np.repeat(drives["congested"].ravel(), n_rows)
    names = pyarrow.array([f"{n}.{v}" for n in range(n_traces) for v in range(N_VEHICLES)])
    own = {
        "trace": pyarrow.array([f"t{n}" for n in range(n_traces)]).take(pyarrow.array(trace)),
        "step": np.tile(np.repeat(np.arange(N_STATES), n_rows), n_traces),
        "step_s": np.full(len(trace), 0.5),
        "object": names.take(pyarrow.array(trace * N_VEHICLES + who - 1, mask=world)),
        "type": pyarrow.array(["vehicle"]).take(pyarrow.array(np.zeros_like(who), mask=world)),
        "congested": pyarrow.array(congested, mask=~world),
        "lane": pyarrow.array(LANES.tolist()).take(
            pyarrow.array(about(drives["lane"]), mask=world)
        ),
    }
    more = {
        name: pyarrow.array(about(drives[name]), mask=world) for name in ("braking", "speed", "gap")
    }
    return pyarrow.table(own | more)


def by_hand(file: Path) -> Callable[[], object]:
    """The rule on speed, as a formula of numpy's for tables that are just like this one."""

    def judged() -> np.ndarray:
        columns = parquet.read_table(file, columns=["congested", "speed"])
        rows = (-1, N_STATES, 1 + N_VEHICLES)
        congested = columns["congested"].fill_null(False).to_numpy().reshape(rows)[:, :, :1]
        speed = columns["speed"].fill_null(0).to_numpy().reshape(rows)[:, :, 1:]
        return ~(congested & (speed > 80)).any(axis=1)

    return judged


def whole_process(here: Path, checkout: Path, file: str) -> Timed:
    """`rulec verify` from start to end, in µs a state."""
    return lambda: verified(here, checkout, file)[0] * 1e6 / (N_TRACES * N_STATES)


def verified(here: Path, checkout: Path, file: str) -> tuple[float, float]:
    """Processor time (s) and the most memory (MB) of judging a file."""
    if checkout == Path.cwd():
        rules = ["-r", "ready.json", "--explain", "0", "-o", "findings.jsonl"]
    else:  # it may know no findings
        rules = ["-r", "ready.rules", "--json"]
    return rulec(checkout, "verify", file, *rules, folder=here)


def once_read(file: Path) -> float:
    """Processor time (s) of a process that imports pyarrow, reads a table, and does no more."""
    program = f"from pyarrow import parquet; parquet.read_table({str(file)!r})"
    return watched([sys.executable, "-c", program], {**os.environ}, file.parent)[0]


def rulec(checkout: Path, *arguments: str, folder: Path) -> tuple[float, float]:
    """Run a checkout's rulec: its processor time (s), and the most memory that it held (MB)."""
    environment = os.environ | {"PYTHONPATH": str(checkout / "src")}
    return watched([sys.executable, "-m", "rulec", *arguments], environment, folder)


def watched(command: list[str], environment: dict[str, str], folder: Path) -> tuple[float, float]:
    """Run a command: its processor time (s), and the most memory that it held (MB)."""
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run(
        [sys.executable, "-c", WATCH, *command],
        capture_output=True,
        cwd=folder,
        env=environment,
        check=False,
    )
    assert done.returncode == 0, "no verdicts"
    seconds, kilobytes = map(float, done.stdout.split())
    return seconds, kilobytes / 1e3


if __name__ == "__main__":
    run(measure, rounds=3)

"""How long recordings take from the command line: what vehicles did, and what they could do.

All of CommonRoad's recordings, if RULEC_RECORDINGS names the folder that they are in, and SUMO's in
the folder `sumo` beside it. Whole processes, of which the first compiles and the others find what
it has kept; and a state of some of them, within a process. RULEC_OLDER may name checkouts of older
commits, separated by colons, whose `rulec` is measured beside this one, each in its turn, in its
own `.venv` if it has one.
"""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from checkouts import commit, environment, german_rules, older_checkouts, python
from figure import Figure, Result
from program import run
from starting import ROOT, RULEC
from timing import Timed, children_ms, in_turns

import rulec
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.extraction.recording_verdicts import DriveVerdict

MOST_S = 120
LEAST_RATIO = 20
"""So many times as fast as the oldest commit a whole process is meant to be."""

TURNS = 3
STATE_TURNS = 9

SUMO = Path("sumo", "fcd.xml.gz")
BUSY = {SUMO.name: 25, "USA_US101-24_2_T-1.xml": 50, "USA_US101-10_1_T-1.xml": 50}
"""Recordings, CommonRoad's of more than forty cars, and the microseconds wanted for a state."""


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
    yield each_state(Path(folder))
    data = Path(folder).parent / SUMO
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
    """Recordings on one core, judged by this commit and by older ones in turns.

    By its own rules each, and this commit by the oldest one's, too: since then there are more.
    """
    older = older_checkouts()
    for file in busy(folder) if older else ():
        names = [commit(one) for one in older]
        tasks: dict[str, tuple[Path, str | Path]] = {"rulec": (ROOT, "de")}
        tasks |= {f"rulec, by the rules of {names[0]}": (ROOT, german_rules(older[0]))}
        tasks |= {name: (one, "de") for name, one in zip(names, older, strict=True)}
        taken = in_turns({what: judging(file, *task) for what, task in tasks.items()}, TURNS)
        peer = taken[names[0]]
        yield Result(
            f"Judging on one core: {file.name.split('.')[0]}",
            "the whole process, every vehicle as ego under `de` without explanations, in turns "
            "with older commits",
            [
                taken[what].figure(what, "s")
                if what in names
                else taken[what].against(peer, names[0], what, "s", least_ratio=LEAST_RATIO)
                for what in tasks
            ],
            [
                f"`{what}`: {said_of_rules(file, rules)}."
                for what, (_, rules) in tasks.items()
                if what not in names
            ],
        )


def each_state(folder: Path) -> Result:
    """What an ego-state of a recording takes within a process that has begun.

    Each time from the recording as read, so that nothing is known of it but its file's content.
    """
    book = rulec.compile("de")
    tasks = {
        f"{file.name.split('.')[0]}, {n_states(file):,} states": (file, most)
        for file, most in busy(folder).items()
    }
    taken = in_turns({what: state(file, book) for what, (file, _) in tasks.items()}, STATE_TURNS)
    return Result(
        "A recorded state",
        "every vehicle as ego under `de`, with open verdicts and what they depend on; extraction "
        "and judging, in a process that has begun",
        [taken[what].figure(what, "µs", most) for what, (_, most) in tasks.items()],
    )


def busy(folder: Path) -> dict[Path, int]:
    """Recordings that are there, and the microseconds that a state of each should take."""
    return {file: most for name, most in BUSY.items() for file in folder.parent.rglob(name)}


def n_states(file: Path) -> int:
    """In how many states there is an ego."""
    return judged_states(rulec.verify_recording(file, "de"))


def judged_states(found: Any) -> int:
    """Judge every drive of a recording, and count its states."""
    return sum(
        one.drive.arrays.n_states for one in found.answers() if isinstance(one, DriveVerdict)
    )


def state(file: Path, book: CompiledRulebook) -> Timed:
    """Microseconds of processor time for a state."""

    def taken() -> float:
        recording = rulec.read_recording(file)
        start = time.process_time_ns()
        states = judged_states(rulec.verify_recording(recording, book))
        return (time.process_time_ns() - start) / 1e3 / states

    return taken


def judging(file: Path, checkout: Path, rules: str | Path) -> Timed:
    """Processor time (s) of judging a recording on one core by a checkout."""
    command, around = verify(file, checkout, rules)
    return lambda: timed(command, around, (0, 1))


def said_of_rules(file: Path, rules: str | Path) -> str:
    """How many rules could be judged, as this commit says it."""
    command, around = verify(file, ROOT, rules)
    said = subprocess.run(command, capture_output=True, text=True, env=around, check=False).stdout
    line = next(one for one in said.splitlines() if one.startswith("rules "))
    return line.removeprefix("rules ").strip()


def verify(file: Path, checkout: Path, rules: str | Path) -> tuple[list[str], dict[str, str]]:
    """A checkout's command and its environment."""
    command = [
        python(checkout),
        "-m",
        "rulec",
        "verify",
        str(file),
        "-r",
        str(rules),
        "--explain",
        "0",
    ]
    return command, {**environment(checkout), "RULEC_JOBS": "1"}


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

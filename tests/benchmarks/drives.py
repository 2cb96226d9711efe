"""How long it takes to judge what recorded vehicles did: reading, traces, verdicts.

    .venv/bin/python tests/benchmarks/drives.py RULEBOOK FILE...

FILE... are recordings. For each, in seconds of processor time: `read`, `traces` (what all vehicles
did, in the words that the rulebook reads), `verify` (judging that), and how many drives and states
there are. Compiling the rulebook is not in it; a rulebook is compiled once for each time step.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rulec.diagnostics import RulecError
from rulec.drives.telling import Drive
from rulec.runtime.batch.verifying import judge_chunk
from rulec.scenario.recordings import read_recording
from rulec.workflow import judge_recording, machines

Result = TypeVar("Result")

COLUMNS = "drives", "states", "read", "traces", "verify"


def timed(work: Callable[[], Result]) -> tuple[Result, float]:
    """What it gives, and how long it takes (s)."""
    begin = time.process_time()
    return work(), time.process_time() - begin


def main(rulebook: str, files: list[Path]) -> None:
    """Print a line for each recording, and one for all of them."""
    rules = machines(rulebook)
    totals = [0.0] * len(COLUMNS)
    print(f"{'':34}" + "".join(f"{name:>9}" for name in COLUMNS))
    for file in files:
        try:
            recording, reading = timed(lambda file=file: read_recording(file))
            judged = judge_recording(recording, rules)
        except RulecError as error:
            print(f"{file.stem:34} {error}")
            continue
        drives, telling = timed(
            lambda judged=judged: [
                one
                for ego in judged.egos
                for one in judged.drives.of(ego)
                if isinstance(one, Drive)
            ]
        )
        traces = [one.trace for one in drives]
        _, judging = timed(lambda traces=traces, judged=judged: judge_chunk(traces, judged.rules))
        states = sum(len(one.states) for one in traces)
        line = [len(drives), states, reading, telling, judging]
        totals = [total + number for total, number in zip(totals, line, strict=True)]
        print(shown(file.stem, line))
    print(shown("all", totals))


def shown(name: str, line: list[float]) -> str:
    """A line of the table."""
    return f"{name:34}{line[0]:9.0f}{line[1]:9.0f}" + "".join(f"{s:9.2f}" for s in line[2:])


if __name__ == "__main__":
    main(sys.argv[1], [Path(name) for name in sys.argv[2:]])

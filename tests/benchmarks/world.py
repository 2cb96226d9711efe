"""How long recorded scenes take: reading, street-wise coordinates, partition, exact counts.

    .venv/bin/python tests/benchmarks/world.py FOLDER [ROUNDS]

FOLDER has CommonRoad scenarios (*.xml). For each: medians in milliseconds of processor time, with
the partition `paper`, 4 s at 0.5 s, and the counts under the paper's R1 for every vehicle; then
with `fine`, and under all rules of `de`, which are compiled before.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rulec.automata.compiled import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.maneuvers import judged
from rulec.rulebook.loader import parse_rulebook
from rulec.scenario import Choice
from rulec.scenario.recorded.convert import to_scenario
from rulec.scenario.recordings import read_recording
from rulec.workflow import compile_rulebook, machines, navigation_graph

Result = TypeVar("Result")

R1 = """
rulebook r1
use paper
hard rule R1 (v: vehicle) {
  require !CONGESTED -> G !(b_v & X(b_v U r_v U f_v))
}
"""
COLUMNS = "cars", "cells", "paths", "read", "convert", "partition", "counts", "fine", "de"


def timed(work: Callable[[], Result], rounds: int) -> tuple[Result, float]:
    """What it gives, and how long it takes (ms)."""
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        result = work()
        times.append((time.process_time() - begin) * 1000)
    return result, statistics.median(times)


def main(folder: Path, rounds: int) -> None:
    """Print a line for each scene."""
    rules = compile_rulebook(parse_rulebook(R1))
    national = machines("de")
    assert not isinstance(national, CompiledRulebook), "it has bounds in seconds"
    print(f"{'':28}" + "".join(f"{name:>11}" for name in COLUMNS))
    for file in sorted(folder.glob("*.xml")):
        recording, reading = timed(lambda file=file: read_recording(file), 1)
        choice = Choice(congested_below_kmh=0)
        try:
            scenario, converting = timed(
                lambda recording=recording, choice=choice: to_scenario(recording, choice, "file"),
                rounds,
            )
            graph, cutting = timed(
                lambda scenario=scenario: navigation_graph(scenario, horizon_s=4.0), rounds
            )
        except RulecError as error:
            print(f"{file.stem:28} {error}")
            continue
        found, counting = timed(lambda graph=graph: judged(graph, rules), rounds)
        fine, cutting_fine = timed(
            lambda scenario=scenario: navigation_graph(scenario, partition="fine", horizon_s=4.0),
            rounds,
        )
        law = national(fine.step)
        _, judging = timed(lambda fine=fine, law=law: judged(fine, law), rounds)
        times = reading, converting, cutting, counting, cutting_fine, judging
        cells = max(len(layer.cells) for layer in graph.layers)
        print(
            f"{file.stem:28}{len(scenario.obstacles):11}{cells:11}{float(found.traces):11.3g}"
            + "".join(f"{ms:11.1f}" for ms in times)
        )


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 5)

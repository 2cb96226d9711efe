"""How long it takes to cut a scene into cells, and to count its maneuvers under rules.

First the paper's scenes; then the busiest of CommonRoad's recordings, if RULEC_RECORDINGS names
the folder that it is in.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path

from figure import Result
from program import run
from timing import Timed, in_turns, processor_time

import rulec
from rulec import read_recording
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.partition import NavigationGraph
from rulec.planning import Maneuvers, evaluate
from rulec.rulebook.loader import parse_rulebook
from rulec.scenario import Choice, Scenario
from rulec.scenario.recorded.recorded_scene import seen_from_ego

BUSIEST = "USA_US101-24_2_T-1.xml"
# All vehicles count: traffic that is congested may be overtaken on either side
NEVER_CONGESTED = Choice(congested_below_kmh=0)
R1 = """
rulebook r1
use paper
hard rule R1 (v: vehicle) {
  require !CONGESTED -> G !(b_v & X(b_v U r_v U f_v))
}
"""


def measure(rounds: int) -> Iterator[Result]:
    """From small to large."""
    yield papers(rounds)
    folder = os.environ.get("RULEC_RECORDINGS")
    if folder:
        yield busiest(Path(folder) / BUSIEST, rounds)


def papers(rounds: int) -> Result:
    """Scenarios S1 to S3 from end to end, as a program has it that has read them."""
    rules = rulec.compile_rulebook("esterle2019")
    tasks = {
        f"{name.upper()} at {step:g} s": in_ms(
            partial(rulec.find_maneuvers, rulec.load_scenario(name), rules, step_s=step)
        )
        for name in ("s1", "s2", "s3")
        for step in (1.0, 0.5)
    }
    return Result(
        "Scenes into counts",
        "the paper's scenes for 4 s with esterle2019, from a scenario in memory to both counts",
        [one.figure(name, "ms", 5) for name, one in in_turns(tasks, rounds * 4).items()],
    )


def busiest(file: Path, rounds: int) -> Result:
    """The recording with most cars."""
    recording = read_recording(file)
    scene = seen_from_ego(recording, NEVER_CONGESTED, str(file))
    r1 = rulec.compile_rulebook(parse_rulebook(R1))
    law, finer_law = (rulec.compile_rulebook("de", step_s=Fraction(1, n)) for n in (2, 4))
    graph = cut(scene, 0.5)
    tasks = {
        "as a scenario along ego's road": lambda: seen_from_ego(recording, NEVER_CONGESTED, ""),
        "partition paper, 0.5 s": partial(cut, scene, 0.5),
        "counts under R1 for every car": lambda: evaluate(graph, r1),
        "the same two, 0.25 s": partial(count, scene, r1, 0.25),
        "partition fine and all of de, 0.5 s": partial(count, scene, law, 0.5),
        "partition fine and all of de, 0.25 s": partial(count, scene, finer_law, 0.25),
        "partition paper, extent body, 0.5 s": partial(cut, scene, 0.5, extent="body"),
        "maneuvers with words, fine, all of de, 0.5 s": partial(
            rulec.find_maneuvers, scene, law, partition="fine", step_s=0.5
        ),
    }
    wanted = dict(zip(list(tasks)[1:], (300, 100, 1000, 2000), strict=False))
    wanted[list(tasks)[-1]] = 1000
    taken = in_turns({name: in_ms(work) for name, work in tasks.items()}, rounds)
    cells = max(len(layer.cells) for layer in graph.layers)
    ways = count(scene, r1, 0.25).traces
    return Result(
        "The busiest recorded scene",
        f"{file.stem}, {len(scene.obstacles)} cars, six lanes, 4 s; at 0.5 s up to {cells} cells "
        f"a layer, at 0.25 s {ways:.2g} maneuvers",
        [one.figure(name, "ms", wanted.get(name)) for name, one in taken.items()],
    )


def cut(scene: Scenario, step_s: float, **options) -> NavigationGraph:
    """The scene's graph."""
    return rulec.navigation_graph(scene, step_s=step_s, horizon_s=4.0, **options)


def count(scene: Scenario, rules: CompiledRulebook, step_s: float) -> Maneuvers:
    """The scene's graph in the partition that the rules read, and both counts."""
    return rulec.find_maneuvers(scene, rules, step_s=step_s, horizon_s=4.0)


def in_ms(work) -> Timed:
    """Milliseconds of processor time."""
    return processor_time(work, 1e6)


if __name__ == "__main__":
    run(measure, rounds=5)

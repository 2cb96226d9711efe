"""How long it takes to score sampled futures of a vehicle among twenty others, by ``de``.

``RULEC_OLDER`` may name checkouts of older commits, separated by colons, which are measured in
processes of their own, each in its turn.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from figure import Figure, Result
from program import run

import rulec

STEP_S = 0.5
N_STATES, N_OTHERS, N_CANDIDATES = 40, 20, 1_000
WANTED_MS, WANTED_ONE_MS = 500.0, 5.0
FEW = 50
"""So many are scored by an older commit, and for each by itself."""


def measure(_rounds: int) -> Iterator[Result]:
    """Once each: it takes so long that a busy moment does not matter."""
    older = [Path(one) for one in os.environ.get("RULEC_OLDER", "").split(":") if one]
    own = in_process(Path.cwd(), N_CANDIDATES)
    together = own.together
    whole = "1,000 candidates together"
    figures = [Figure(whole, "ms", together, together, WANTED_MS)]
    one = "one after a past"
    figures.append(Figure(one, "ms", median(own.alone), min(own.alone), WANTED_ONE_MS))
    figures.append(Figure(f"{one}, first in a world", "ms", *[own.in_new_world] * 2))
    figures.append(Figure(f"{one}, first in a process", "ms", *[own.first] * 2))
    each = Figure("a candidate, of 1,000 together", "ms", *[together / N_CANDIDATES] * 2)
    figures.append(each)
    for checkout in older:
        then = in_process(checkout, FEW)
        name = f"commit {checkout.name}"
        figures.append(Figure(f"a candidate, {name}", "ms", *[then.together / FEW] * 2))
        figures.append(Figure(f"a candidate by verify, {name}", "ms", *[then.verified] * 2))
        figures.append(Figure(f"{one}, {name}", "ms", median(then.alone), min(then.alone)))
    yield Result(
        "Scores of futures: de",
        f"candidates of {N_STATES} states among {N_OTHERS} others on two lanes, in a world that is "
        "prepared; older commits score 50",
        figures,
    )


class Taken(NamedTuple):
    """Milliseconds for candidates together, for one by ``verify``, and for one after a past.

    For that the first time in a process, the first time in a world, and each of some later ones.
    """

    together: float
    verified: float
    first: float
    in_new_world: float
    alone: list[float]


def in_process(checkout: Path, count: int) -> Taken:
    """What a checkout takes for so many candidates."""
    own = checkout / ".venv" / "bin" / "python"
    python = str(own) if own.exists() else sys.executable
    environment = {**os.environ, "PYTHONPATH": str(checkout / "src")}
    done = subprocess.run(
        [python, __file__, str(count)],
        capture_output=True,
        text=True,
        env=environment,
        check=True,
    )
    together, verified, first, in_new_world, *alone = map(float, done.stdout.split())
    return Taken(together, verified, first, in_new_world, alone)


def world() -> rulec.TrafficWorld:
    """Two lanes of a town, twenty cars, and ego near x = 0 after four states."""
    town = {"types": ["urban"], "limit_mps": 50 / 3.6}
    lanes = [
        rulec.build_lanelet("right", [(-100, 0), (500, 0)], left_of="left", **town),
        rulec.build_lanelet("left", [(-100, 3.5), (500, 3.5)], right_of="right", **town),
    ]
    others = [
        car(f"c{k}", 8.0 + k % 5, (-80.0 + 10 * k, 3.5 * (k % 2)), N_STATES + 5)
        for k in range(N_OTHERS)
    ]
    ego = car("ego", 10.0, (-15.0, 0.0), 4)
    found = rulec.build_recording(lanes, [*others, ego], step_s=STEP_S, side="right")
    return rulec.TrafficWorld(found, "ego")


def car(name: str, speed: float, place: tuple[float, float], count: int) -> rulec.Participant:
    """Straight on along the x axis."""
    t = STEP_S * np.arange(count)
    return rulec.build_participant(
        name, "car", t, place[0] + speed * t, place[1] + 0 * t, step_s=STEP_S
    )


def sampled(count: int, start: np.ndarray) -> np.ndarray:
    """Futures that gain or lose speed and bend a little, or change lanes."""
    chance, k = np.random.default_rng(0), np.arange(1, N_STATES + 1)
    x, y, _, v = start
    found = []
    for number in range(count):
        gained = chance.uniform(-1, 1)
        speed = np.clip(v + gained * STEP_S * k, 0, 20)
        if number % 2:
            aside = 3.5 * (number % 4 == 1) * np.clip((k - chance.integers(0, 30)) / 8, 0, 1)
            across = np.diff(aside, prepend=0) / STEP_S
            heading = np.arctan2(across, np.maximum(speed, 0.1))
            rows = x + np.cumsum(speed) * STEP_S, y + aside, heading, np.hypot(speed, across)
        else:
            heading = chance.uniform(-0.001, 0.001) * k
            ways = np.cumsum(speed * np.cos(heading)), np.cumsum(speed * np.sin(heading))
            rows = x + ways[0] * STEP_S, y + ways[1] * STEP_S, heading, speed
        found.append(np.column_stack(rows))
    return np.array(found)


def main(count: int) -> None:
    """Print how long a checkout takes."""
    book, here = rulec.compile("de"), world()
    candidates = sampled(count, here.past[-1])

    def taken(run_it) -> float:  # type: ignore[no-untyped-def]
        start = time.process_time()
        run_it()
        return (time.process_time() - start) * 1e3

    first, in_new_world = (
        taken(lambda own=own: rulec.score(candidates[:1], own, book, own.past))
        for own in (world(), here)
    )
    rulec.score(candidates[:2], here, book, here.past)
    print(taken(lambda: rulec.score(candidates, here, book)))
    recordings = [here.recording_of(one) for one in candidates[:10]]
    wanted = rulec.RequestedDrives((here.ego,))
    each = [
        taken(lambda one=one: list(rulec.verify_recording(one, book, wanted).answers()))
        for one in recordings
    ]
    print(median(each), first, in_new_world)
    for number in range(20):
        one = candidates[number : number + 1]
        print(taken(lambda one=one: rulec.score(one, here, book, here.past)))


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].isdigit():
        main(int(sys.argv[1]))
    else:
        run(measure, rounds=1)

"""How long it takes to score sampled futures of a vehicle among twenty others, by ``de``.

``RULEC_OLDER`` may name checkouts of older commits, separated by colons, by whose rules, and by
whose code if it can score, the same is measured, each in its turn.
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from checkouts import commit, environment, german_rules, older_checkouts, python
from figure import Figure, Result
from program import run

import rulec

STEP_S = 0.5
N_STATES, N_OTHERS, N_CANDIDATES = 40, 20, 1_000
WANTED_MS, WANTED_ONE_MS = 500.0, 5.0
TOGETHER = "1,000 candidates together"
ALONE = "one after a past"
SECOND = (
    "One after a past is meant from the second call in a world on: the first one prepares the map "
    "and the others, and the first of a process loads what it needs and makes rules ready."
)
BY_VERIFY, ONE_BY_ONE = "a candidate by `verify`", "`verify`, one by one"


def measure(rounds: int) -> Iterator[Result]:
    """In processes of their own, in turns."""
    here = Path.cwd()
    tasks: dict[str, tuple[Path, str]] = {"": (here, "de")}
    for checkout in older_checkouts():
        then = commit(checkout)
        tasks[f", by the rules of {then}"] = (here, str(german_rules(checkout)))
        if (checkout / "src/rulec/scoring").is_dir():
            tasks[f", {then}"] = (checkout, "de")
    taken: dict[str, list[Taken]] = {name: [] for name in tasks}
    for _ in range(rounds):
        for name, task in tasks.items():
            taken[name].append(in_process(*task))
    own = taken[""]
    whole, each = [one.together for one in own], [one.verified for one in own]
    ratio = N_CANDIDATES * median(each) / median(whole)
    figures = [
        Figure(TOGETHER, "ms", median(whole), min(whole), WANTED_MS, ONE_BY_ONE, ratio),
        Figure(BY_VERIFY, "ms", median(each), min(each)),
    ]
    for name, found in taken.items():
        if name:
            whole = [one.together for one in found]
            figures.append(Figure(TOGETHER + name, "ms", median(whole), min(whole)))
        alone = [one_ms for one in found for one_ms in one.alone]
        figures.append(Figure(ALONE + name, "ms", median(alone), min(alone), WANTED_ONE_MS))
    for what, times in (
        ("first in a world", [one.in_new_world for one in own]),
        ("first in a process", [one.first for one in own]),
    ):
        figures.append(Figure(f"{ALONE}, {what}", "ms", median(times), min(times)))
    yield Result(
        "Scores of futures: de",
        f"candidates of {N_STATES} states among {N_OTHERS} others on two lanes, in a world that is "
        "prepared",
        figures,
        [SECOND],
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


def in_process(checkout: Path, rules: str) -> Taken:
    """What a checkout takes by its rules, or other ones."""
    done = subprocess.run(
        [python(checkout), __file__, "--of", rules],
        capture_output=True,
        text=True,
        env=environment(checkout),
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


def main(rules: str) -> None:
    """Print how long it takes here."""
    book, here = rulec.compile(rules), world()
    candidates = sampled(N_CANDIDATES, here.past[-1])

    def taken(run_it) -> float:  # type: ignore[no-untyped-def]
        start = time.process_time()
        run_it()
        return (time.process_time() - start) * 1e3

    first, in_new_world = (
        taken(lambda own=own: rulec.score(candidates[:1], own, book, own.past))
        for own in (world(), here)
    )
    rulec.score(candidates[:2], here, book, here.past)
    print(min(taken(lambda: rulec.score(candidates, here, book)) for _ in range(3)))
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
    if sys.argv[1:2] == ["--of"]:
        main(sys.argv[2])
    else:
        run(measure, rounds=3)

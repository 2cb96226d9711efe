"""How long a state of a running trace takes a monitor, encoding and checking it included.

    .venv/bin/python tests/benchmarks/online.py [ROUNDS] [PEER]

A line for each rulebook and number of vehicles: nanoseconds of processor time for a state, and for
a state and rule instance (a rule with objects bound), the median and the least of so many rounds.
States differ from each other, in that every other vehicle has moved on, and were made before.
Judging the growing trace anew at each state by `verify` is measured beside, on short traces.

PEER is the Python of an environment that has rtamt; both then judge one rule on two signals.
"""

from __future__ import annotations

import random
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import rulec
from rulec.rulebook.loader import parse_rulebook
from rulec.runtime.monitor import Monitor

N_STATES = 300
N_PREFIXES = 30
PLACES = {
    "esterle2019": [{"position": place} for place in "bbblllff"],
    "vienna": [
        {"station": station, "lateral": lateral, "gap": 30.5}
        for station, lateral in [
            ("behind", "same_lane"),
            ("behind", "left_of"),
            ("beside", "left_of"),
            ("in_front_of", "left_of"),
            ("in_front_of", "same_lane"),
        ]
    ],
}
RESPONSE = "always (p implies once[<= 3 steps] q)"

Run = Callable[[], object]


def main(rounds: int, peer: str | None) -> None:
    """Print the figures of so many rounds."""
    print(f"{'':34}{'ns a state':>20}{'ns an instance':>20}")
    for name, places in PLACES.items():
        rules = rulec.compile_rulebook(name)
        for n_vehicles in (1, 4, 16, 52):
            objects = {f"v{number}": "vehicle" for number in range(n_vehicles)}
            states = list(drive(places, list(objects), N_STATES))
            monitor = Monitor(rules)
            n_instances = sum(map(len, bindings(monitor, states[0], objects)))
            label = f"{name}, {n_vehicles} vehicles, {n_instances} instances"
            shown(
                label,
                times(partial(taken, monitor, states, objects), N_STATES, rounds),
                n_instances,
            )
    rules = rulec.compile_rulebook("esterle2019")
    objects = {"v0": "vehicle"}
    states = list(drive(PLACES["esterle2019"], ["v0"], N_PREFIXES))
    prefixes = [
        rulec.Trace("t", 1.0, objects, tuple(states[:number]))
        for number in range(1, N_PREFIXES + 1)
    ]
    anew = times(lambda: [rulec.verify(one, rules) for one in prefixes], N_PREFIXES, rounds)
    shown(f"verify of {N_PREFIXES} prefixes, 1 vehicle", anew, 2)
    compared(rounds, peer)


def drive(places: list[dict[str, Any]], names: list[str], n_states: int) -> Iterator[Any]:
    """States in which vehicles move on, from one place to the next, every other one at a time."""
    chance = random.Random(5)
    at = [chance.randrange(len(places)) for _ in names]
    for _ in range(n_states):
        at = [(place + chance.randint(0, 1)) % len(places) for place in at]
        yield {
            relation: {name: places[place][relation] for name, place in zip(names, at, strict=True)}
            for relation in places[0]
        }


def bindings(monitor: Monitor, state: Any, objects: Any) -> Iterator[list[Any]]:
    """The bindings of each rule, once these objects are there."""
    monitor.step(state, objects)
    for one in monitor.snapshot()["rules"]:
        yield one["bindings"]


def taken(monitor: Monitor, states: list[Any], objects: Any) -> None:
    """All states, one after the other."""
    step = monitor.step
    for state in states:
        step(state, objects)


def times(run: Run, work: int, rounds: int) -> list[float]:
    """Nanoseconds of processor time for a unit of work, in each round."""
    run()
    found = []
    for _ in range(rounds):
        start = time.process_time_ns()
        run()
        found.append((time.process_time_ns() - start) / work)
    return found


def shown(label: str, found: list[float], n_instances: int) -> None:
    """A line: median and least."""
    middle, least = statistics.median(found), min(found)
    share = f"{middle / n_instances:.0f} ({least / n_instances:.0f})"
    print(f"{label:34}{f'{middle:.0f} ({least:.0f})':>20}{share:>20}")


def compared(rounds: int, peer: str | None) -> None:
    """One rule on the world alone, by us and by another program."""
    text = f"rulebook r signal p, q default false hard rule r {{ require {RESPONSE} }}"
    monitor = Monitor(rulec.compile_rulebook(parse_rulebook(text)))
    chance = random.Random(5)
    states = [{"p": chance.random() < 0.3, "q": True} for _ in range(N_STATES)]
    shown("one rule on two signals", times(lambda: taken(monitor, states, {}), N_STATES, rounds), 1)
    if peer is not None:
        program = Path(__file__).with_name("rtamt_online.py")
        answer = subprocess.run(
            [peer, program, str(rounds), str(N_STATES)], capture_output=True, text=True, check=True
        )
        shown("the same by rtamt", [float(one) for one in answer.stdout.split()], 1)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 15, sys.argv[2] if len(sys.argv) > 2 else None)

"""How long a state of a running trace takes a monitor, encoding and checking it included.

States differ from each other, in that every other vehicle has moved on and numbers have changed,
and were made before. A drive goes on from round to round, so none comes again but by chance, which
is good where few vehicles have few places.
Judging the growing trace anew at each state by `verify` is measured beside, on short traces.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import partial
from itertools import islice
from typing import Any

from driving import PLACES, drive
from figure import Figure, Result
from peer import peers
from program import run
from stream import streamed
from timing import in_turns, processor_time

import rulec
from rulec.api.named_monitor import Monitor
from rulec.rulebook.loader import parse_rulebook

N_STATES = 300
N_PREFIXES = 30
VEHICLES = (1, 4, 16, 52)
PROGRAMS = {"rtamt": "rtamt_online", "reelay": "reelay_online"}
RESPONSE = "always (p implies once[<= 3 steps] q)"
WANTED_NS = 150


def measure(rounds: int) -> Iterator[Result]:
    """Rulebooks and vehicles, other libraries, and a stream."""
    for name, places in PLACES.items():
        yield driven(name, places, rounds)
    yield prefixes(rounds)
    yield compared(rounds)
    yield streamed(min(rounds, 5))


def driven(name: str, places: list[dict[str, Any]], rounds: int) -> Result:
    """More and more vehicles."""
    rules = rulec.compile_rulebook(name)
    tasks, n_instances = {}, {}
    for n_vehicles in VEHICLES:
        objects = {f"v{number}": "vehicle" for number in range(n_vehicles)}
        states = drive(places, list(objects))
        monitor = Monitor(rules)
        label = f"{n_vehicles} vehicle{'s' if n_vehicles > 1 else ''}"
        n_instances[label] = sum(map(len, bindings(monitor, next(states), objects)))
        tasks[label] = partial(further, monitor, states, objects, n_instances[label])
    return Result(
        f"Online: {name}",
        f"{N_STATES} states of a drive at a time, {len(rules.rules)} rules; per state and rule "
        "instance, which is a rule with objects bound",
        [
            one.figure(
                f"{label}, {n_instances[label]} instances "
                f"({one.median * n_instances[label] / 1e3:.1f} µs a state)",
                "ns",
                WANTED_NS,
            )
            for label, one in in_turns(tasks, rounds).items()
        ],
        [
            "A state takes a while however little it says; few instances share it.",
            "States of few vehicles come again by chance and are known; those of many do not.",
        ],
    )


def further(
    monitor: Monitor, states: Iterator[Any], objects: dict[str, str], n_instances: int
) -> float:
    """Nanoseconds per state and instance of a drive that goes on."""
    some = list(islice(states, N_STATES))
    return processor_time(partial(taken_in, monitor, some, objects), N_STATES * n_instances)()


def prefixes(rounds: int) -> Result:
    """A monitor, and the growing trace judged anew."""
    rules = rulec.compile_rulebook("esterle2019")
    objects = {"v0": "vehicle"}
    states = list(islice(drive(PLACES["esterle2019"], ["v0"]), N_PREFIXES))
    traces = [
        rulec.Trace("t", 1.0, objects, tuple(states[:number]))
        for number in range(1, N_PREFIXES + 1)
    ]
    monitor = Monitor(rules)
    again = "verify"
    taken = in_turns(
        {
            "a monitor": processor_time(partial(taken_in, monitor, states, objects), N_PREFIXES),
            again: processor_time(lambda: [rulec.verify(x, rules) for x in traces], N_PREFIXES),
        },
        rounds,
    )
    return Result(
        "Online, or anew",
        f"{N_PREFIXES} states, one vehicle, esterle2019; per state",
        [
            taken["a monitor"].against(taken[again], again, "a monitor", "ns"),
            taken[again].figure("verify of the trace so far", "ns"),
        ],
    )


def bindings(monitor: Monitor, state: Any, objects: Any) -> Iterator[list[Any]]:
    """The bindings of each rule, once these objects are there."""
    monitor.step(state, objects)
    for one in monitor.snapshot()["rules"]:
        yield one["bindings"]


def taken_in(monitor: Monitor, states: list[Any], objects: Any) -> None:
    """All states, one after the other."""
    step = monitor.step
    for state in states:
        step(state, objects)


def compared(rounds: int) -> Result:
    """One rule on the world alone, by rulec and by other libraries."""
    text = f"rulebook r signal p, q default false hard rule r {{ require {RESPONSE} }}"
    monitor = Monitor(rulec.compile_rulebook(parse_rulebook(text)))
    chance = random.Random(5)
    # Whenever p is true, q has been within three steps: so the rule stays undecided.
    states = [{"p": chance.random() < 0.3, "q": n % 3 == 0} for n in range(N_STATES)]
    ours = "rulec"
    with peers(states, PROGRAMS) as (there, missing):
        answers = {name: peer.round()[1] for name, peer in there.items()}
        taken_in(monitor, states, {})
        answers[ours] = not monitor.violations
        if not all(answers.values()):
            raise RuntimeError(f"not all say that the rule holds: {answers}")
        tasks = {ours: processor_time(partial(taken_in, monitor, states, {}), N_STATES)}
        tasks |= {name: peer.timed(N_STATES) for name, peer in there.items()}
        taken = in_turns(tasks, rounds)
    mine = taken.pop(ours)
    figures: list[Figure] = [
        mine.against(one, name, "a monitor", "ns") for name, one in taken.items()
    ] or [mine.figure("a monitor", "ns")]
    return Result(
        "Online: other libraries",
        f"`{RESPONSE}` on {N_STATES} states of two signals; per state",
        figures + [one.figure(name, "ns") for name, one in taken.items()],
        missing,
    )


if __name__ == "__main__":
    run(measure, rounds=15)

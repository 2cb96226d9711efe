"""What unknown values cost: the same drives with all values known, and with a tenth of them not.

A drive says everything that a rulebook's rules read. A value stays mostly as it was in the state
before; what is unknown is drawn anew for each value and state, constants once for a drive. Verdicts
of many traces are looked at as far as `satisfied`; why some are open is measured beside.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import cycle, islice
from typing import Any

from figure import Figure, Result
from program import run
from timing import Taken, in_turns, processor_time

import rulec
from rulec.api.named_monitor import Monitor
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import scale
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace
from rulec.vocabulary import Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import choices

BOOKS = ("esterle2019", "vienna", "de")
STEP_S = 0.5
N_TRACES, N_STATES, N_VEHICLES = 300, 20, 3
N_ALONE = 5
VEHICLES = (1, 4)
LONG, N_WATCHED = 2_000, 300
CHANGE = 0.1
SHARE = 0.1
MOST_TIMES = 2

NOTE = (
    f"One by one, and where it is asked on what open verdicts depend, {N_ALONE} of the drives are "
    "judged; monitors go on from round to round, and where they meet new states, those of no round "
    "before (under `esterle2019` there are few). A new monitor's are its first "
    f"{N_WATCHED} states, of a drive of its own each round."
)


def measure(rounds: int) -> Iterator[Result]:
    """Rulebook by rulebook, each engine with all values known and with a tenth unknown."""
    for name in BOOKS:
        rules = rulec.compile_rulebook(name).fitted_to(STEP_S)
        yield paired(name, rules, rounds)


def paired(name: str, rules: CompiledRulebook, rounds: int) -> Result:
    """All engines on one rulebook."""
    many = [drawn(rules, number, N_VEHICLES) for number in range(N_TRACES)]
    partial_ = [blurred(rules, trace, number) for number, trace in enumerate(many)]
    engines: dict[str, tuple[Callable[[Any], object], Any, Any]] = {
        "one by one": (partial(alone, rules), many[:N_ALONE], partial_[:N_ALONE]),
        "together": (partial(together, rules), many, partial_),
    }
    tasks, doubts = {}, "together, with what open verdicts depend on"
    for engine, (judge, known, unknown) in engines.items():
        n_states = sum(len(trace.states) for trace in known)
        tasks[engine] = processor_time(partial(judge, known), n_states * 1e3)
        tasks[in_part(engine)] = processor_time(partial(judge, unknown), n_states * 1e3)
    for n_vehicles in VEHICLES:
        engine = f"monitor, {n_vehicles} vehicle{'s' if n_vehicles > 1 else ''}"
        engines[engine] = watched, (), ()
        drive = drawn(rules, 0, n_vehicles, LONG)
        for label, trace in (engine, drive), (in_part(engine), blurred(rules, drive, 0)):
            work = partial(watched, Monitor(rules, STEP_S), cycle(trace.states), trace.objects)
            tasks[label] = processor_time(work, N_WATCHED * 1e3)
        engine = f"{engine}, new states"
        engines[engine] = watched, (), ()
        drive = drawn(rules, 1, n_vehicles, N_WATCHED * (rounds + 1))
        for label, trace in (engine, drive), (in_part(engine), blurred(rules, drive, 1)):
            work = partial(watched, Monitor(rules, STEP_S), cycle(trace.states), trace.objects)
            tasks[label] = processor_time(work, N_WATCHED * 1e3)
        engine = f"new {engine}".removesuffix(", new states")
        engines[engine] = begun, (), ()
        drives = [drawn(rules, 2 + n, n_vehicles, N_WATCHED) for n in range(rounds + 1)]
        darker = [blurred(rules, trace, n) for n, trace in enumerate(drives)]
        for label, traces in (engine, drives), (in_part(engine), darker):
            tasks[label] = processor_time(partial(begun, rules, cycle(traces)), N_WATCHED * 1e3)
    tasks[doubts] = processor_time(
        partial(explained, rules, partial_[:N_ALONE]), N_ALONE * N_STATES * 1e3
    )
    taken = in_turns(tasks, rounds)
    return Result(
        f"Unknown values: {name}",
        f"{N_TRACES} drives of {N_STATES} states, {len(rules.rules)} rules, {N_VEHICLES} vehicles "
        "unless it says another number; per state",
        [figure for engine in engines for figure in figures(engine, taken)]
        + [taken[doubts].figure(doubts, "µs")],
        [NOTE],
    )


def figures(engine: str, taken: Mapping[str, Taken]) -> Iterator[Figure]:
    """An engine's two figures, of which the second is to be at most twice the first."""
    known = taken[engine]
    yield known.figure(engine, "µs")
    yield taken[in_part(engine)].against(
        known, "all known", in_part(engine), "µs", None, 1 / MOST_TIMES
    )


def in_part(engine: str) -> str:
    """A figure's name."""
    return f"{engine}, a tenth unknown"


def alone(rules: CompiledRulebook, traces: list[Trace]) -> None:
    """Each by itself."""
    for trace in traces:
        _ = verify(trace, rules).satisfied


def together(rules: CompiledRulebook, traces: list[Trace]) -> None:
    """Many at once."""
    for answer in verify_many(traces, rules):
        _ = answer.satisfied


def explained(rules: CompiledRulebook, traces: list[Trace]) -> None:
    """Many at once, with the reasons of what is open."""
    for answer in verify_many(traces, rules):
        for open_verdict in answer.open:
            _ = open_verdict.depends_on


def watched(monitor: Monitor, states: Iterator[Any], objects: Mapping[str, str]) -> None:
    """The next states of a drive."""
    for state in islice(states, N_WATCHED):
        monitor.step(state, objects)


def begun(rules: CompiledRulebook, traces: Iterator[Trace]) -> None:
    """A new monitor on the first states of the next drive."""
    trace = next(traces)
    watched(Monitor(rules, STEP_S), iter(trace.states), trace.objects)


def drawn(rules: CompiledRulebook, seed: int, n_vehicles: int, n_states: int = N_STATES) -> Trace:
    """A drive of which all is known."""
    chance = random.Random(seed)
    objects = {f"v{number}": "vehicle" for number in range(n_vehicles)}
    telling = numbers_of(rules)
    vocabulary = rules.vocabulary
    names = [name for name in vocabulary.declarations if name in telling]
    states: list[dict[str, Any]] = []
    while len(states) < n_states:
        state: dict[str, Any] = {}
        for name in names:
            declaration = vocabulary.declarations[name]
            for items in choices(declaration.parameters, objects, vocabulary):
                before = value_at(states[-1], name, items) if states else None
                if before is None or (not declaration.constant and chance.random() < CHANGE):
                    before = chance.choice(telling[name])
                put(state, name, items, before)
        # What the book's facts exclude is drawn anew.
        if isinstance(verify_or_reason(Trace("one", STEP_S, objects, (state,)), rules), Verdict):
            states.append(state)
    return Trace(f"t{seed}", STEP_S, objects, tuple(states))


def numbers_of(rules: CompiledRulebook) -> dict[str, list[Any]]:
    """For each name that rules read its values, or numbers on both sides of what it passes."""
    declarations = rules.vocabulary.declarations
    found: dict[str, list[Any]] = {}
    for name in {name for rule in rules.rules for name in names_in(rule.formula)}:
        declaration = declarations[name]
        if isinstance(declaration, Enumeration):
            found[name] = list(declaration.values)
        else:
            found[name] = [0.0] if isinstance(declaration, Quantity) else [False, True]
    for rule in rules.rules:
        for read in rule.machine.reads:
            if isinstance(read, NumberRead):
                limits = [float(threshold.limit) for threshold in read.thresholds]
                for name in scale(read).names:
                    if isinstance(declarations[name], Quantity):
                        found[name] += [round(x + d, 2) for x in limits for d in (-1.3, 1.7)]
    return found


def value_at(state: Any, name: str, items: tuple[str, ...]) -> Any:
    """What a state says of a name, asked of objects."""
    value = state[name]
    for item in items:
        value = value[item]
    return value


def put(state: dict[str, Any], name: str, items: tuple[str, ...], value: object) -> None:
    """Let a state say this."""
    keys = (name, *items)
    for key in keys[:-1]:
        state = state.setdefault(key, {})
    state[keys[-1]] = value


def blurred(rules: CompiledRulebook, trace: Trace, seed: int) -> Trace:
    """The drive with a tenth of its values unknown."""
    chance = random.Random(seed)
    vocabulary = rules.vocabulary
    constants = {name: chance.random() < SHARE for name in vocabulary.constants}
    states = []
    for state in trace.states:
        changed: dict[str, Any] = {}
        for name in state:
            parameters = vocabulary.declarations[name].parameters
            for items in choices(parameters, trace.objects, vocabulary):
                is_dark = constants.get(name, chance.random() < SHARE)
                value = UNKNOWN if is_dark else value_at(state, name, items)
                put(changed, name, items, value)
        states.append(changed)
    return replace(trace, states=tuple(states))


if __name__ == "__main__":
    run(measure, rounds=7)

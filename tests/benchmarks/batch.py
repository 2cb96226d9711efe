"""How long many traces take: every engine on the 75,441 maneuvers of scenario S2, rules R1 to R3.

    .venv/bin/python tests/benchmarks/batch.py [ROUNDS]

Every figure is in nanoseconds of processor time per trace, step and rule: the median of so many
rounds, in which the engines take turns, so that a busy moment of the machine meets all of them; and
the least of them, which is nearest to what it takes on a machine with nothing else to do.
What judges a trace at a time judges a sample of them; Spot gets its words as text, made beforehand.
"""

from __future__ import annotations

import statistics
import sys
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import spot
from numpy.typing import NDArray

import rulec
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator, atoms_of
from rulec.runtime.batch.gathering import gathered
from rulec.runtime.batch.judging import judge_cells, judge_columns
from rulec.runtime.bits import along
from rulec.runtime.bits.across import Across
from rulec.runtime.bits.judging import judge_on_bits
from rulec.runtime.verify import verify
from rulec.trace import Trace
from rulec.trace.columns import TraceCells, layout_of
from rulec.trace.paths import paths

EVERY = 400
LONG = 10_000_000
PEDESTRIAN = "ffflfll"
"""Where the pedestrian is, seen from each node of a layer."""

P, Q = Atom("p"), Atom("q")


def always(formula):
    return Unary(UnaryOperator.ALWAYS, formula)


def eventually(formula):
    return Unary(UnaryOperator.EVENTUALLY, formula)


def implies(left, right):
    return Binary(BinaryOperator.IMPLIES, left, right)


def main(rounds: int) -> None:
    """Print the figures of so many rounds."""
    rules = rulec.compile_rulebook("esterle2019")
    graph = rulec.navigation_graph("s2", step_s=0.5).trace_graph()
    nodes = np.array(list(paths(graph)), dtype=np.uint8)
    cells = cells_of(graph, nodes)
    layout = cells.layout
    columns = gathered(cells, rules.vocabulary)
    booleans = booleans_of(rules, cells)
    sample = [trace_at(cells, number) for number in range(0, layout.n_traces, EVERY)]
    work = float(layout.n_states * len(rules.rules))
    share = float(len(sample) * layout.n_steps * len(rules.rules))
    print(f"{layout.n_traces:,} traces of {layout.n_steps} states, {len(rules.rules)} rules")
    shown(
        timed(
            {
                "Spot, a word automaton per trace": (by_spot(rules, sample), share),
                "a trace at a time": (lambda: [verify(one, rules) for one in sample], share),
                "machines, from cells": (lambda: judge_cells(cells, rules), work),
                "machines, from columns": (lambda: judge_columns(columns, rules), work),
                "bits, from columns": (lambda: list(judge_on_bits(columns, rules)), work),
                "bits, from Boolean columns": (by_bits(rules, layout, booleans), work),
            },
            rounds,
        )
    )
    print("memory beyond the input's")
    inputs = {
        "machines, from cells": (lambda: judge_cells(cells, rules), [cells.cells]),
        "machines, from columns": (lambda: judge_columns(columns, rules), columns.values.values()),
        "bits, from Boolean columns": (by_bits(rules, layout, booleans), booleans.values()),
    }
    for name, (run, arrays) in inputs.items():
        size = sum(array.nbytes for array in arrays)
        print(f"  {name:34} {peak(run) / size:10.2f} times its {size / 1e6:.2f} MB")
    long_trace(rounds)


def cells_of(graph, nodes) -> TraceCells:
    """The maneuvers as walks through the graph's nodes, of which there are as many in each layer.

    The scenario has no pedestrian; one stands at the crossing, so that R3 speaks of somebody.
    """
    states = [
        {**state, "position": {**state["position"], "p1": PEDESTRIAN[node]}}
        for node, state in enumerate(graph.states[0])
    ]
    layout = layout_of([nodes.shape[1]] * len(nodes))
    objects = {**graph.objects, "p1": "pedestrian"}
    return TraceCells(layout, nodes.T.ravel().copy(), tuple(states), objects, step_s=graph.step_s)


def trace_at(cells: TraceCells, number: int) -> Trace:
    """One of the traces by itself."""
    word = cells.cells[number :: cells.layout.n_traces]
    states = tuple(cells.states[cell] for cell in word)
    return Trace(str(number), cells.step_s, cells.objects, states)


def by_spot(rules, traces) -> Callable[[], list[bool]]:
    """Spot's word automaton of each trace, met with the automaton of each rule."""
    automata = [spot.automaton(rule.hoa) for rule in rules.rules]
    words = [word_in_spot(rules, trace) for trace in traces]

    def run() -> list[bool]:
        found = []
        for word in words:
            one = spot.parse_word(word).as_automaton()
            found += [one.intersects(automaton) for automaton in automata]
        return found

    return run


def word_in_spot(rules, trace: Trace) -> str:
    """The word that the rules read of a trace; its last letter goes on for ever."""
    letters = [
        " & ".join(
            ("" if is_true(atom, state, item) else "!") + f'"{atom}"'
            for atom, item in atoms_and_items(rules, trace.objects).items()
        )
        for state in trace.states
    ]
    return "; ".join([*letters[:-1], f"cycle{{{letters[-1]}}}"])


def atoms_and_items(rules, objects) -> dict[Atom, str]:
    """The rules' atoms, each with the object that its rule's variable stands for."""
    return {
        atom: name
        for rule in rules.rules
        for name, kind in objects.items()
        if kind == rule.variables[0].type
        for atom in atoms_of(rule.formula)
    }


def is_true(atom, state, item: str) -> bool:
    """Does an atom of a rule about one object hold?"""
    value = state.get(atom.name, False)
    value = value[item] if atom.arguments else value
    return value is True if atom.value is None else value == atom.value


def booleans_of(rules, cells: TraceCells) -> dict[Atom, NDArray[np.bool_]]:
    """A column of Booleans for each atom of the rules."""
    return {
        atom: np.array([is_true(atom, state, item) for state in cells.states]).take(cells.cells)
        for atom, item in atoms_and_items(rules, cells.objects).items()
    }


def by_bits(rules, layout, booleans) -> Callable[[], list[NDArray[np.bool_]]]:
    """Every rule, evaluated on the columns of its atoms, which are packed first."""

    def run() -> list[NDArray[np.bool_]]:
        across = Across(layout, booleans.__getitem__)
        return [across.holds(rule.formula) for rule in rules.rules]

    return run


@dataclass(frozen=True)
class Taken:
    """Nanoseconds for a unit of work: the median of all rounds, and the least."""

    median: float
    least: float


def timed(engines: dict[str, tuple[Callable[[], object], float]], rounds: int) -> dict[str, Taken]:
    """What each engine takes for a unit of its work, the engines taking turns."""
    times: dict[str, list[float]] = {name: [] for name in engines}
    for turn in range(rounds + 1):
        for name, (run, work) in engines.items():
            start = time.process_time_ns()
            run()
            if turn:  # the first time warms up
                times[name].append((time.process_time_ns() - start) / work)
    return {name: Taken(statistics.median(all_), min(all_)) for name, all_ in times.items()}


def shown(found: dict[str, Taken]) -> None:
    """A line for each engine; the first one is what the others are compared with."""
    name, slowest = next(iter(found.items()))
    print(f"  {'':34} {'median':>10}    {'fastest':>10}")
    for one, taken in found.items():
        times = f"{slowest.median / taken.median:10,.1f} times as fast"
        print(f"  {one:34} {taken.median:10.3f} ns {taken.least:10.3f} ns  {times}")
    print(f"  (as {name})")


def peak(run: Callable[[], object]) -> int:
    """The most memory that is held at once, in bytes, beyond what is held before."""
    tracemalloc.start()
    run()
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def long_trace(rounds: int) -> None:
    """One trace of ten million states, by the rules' formulas on random Booleans."""
    chance = np.random.default_rng(1)
    p, q = (chance.random(LONG) < share for share in (0.9, 0.1))
    columns = {P: p, Q: q}
    formulas = {
        "always (p implies eventually q)": always(implies(P, eventually(Q))),
        "p until q, always again": always(Binary(BinaryOperator.WEAK_UNTIL, P, Q)),
        "always (q implies once[<= 20] p)": always(
            implies(Q, Unary(UnaryOperator.ONCE, P, Bound(Fraction(0), Fraction(20), "steps")))
        ),
    }
    print(f"one trace of {LONG:,} states, from Boolean columns")
    engines = {
        name: (lambda formula=formula: along(formula, LONG, columns.__getitem__), float(LONG))
        for name, formula in formulas.items()
    }
    for name, taken in timed(engines, rounds).items():
        print(f"  {name:34} {taken.median:10.3f} ns {taken.least:10.3f} ns  a step")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 9)

"""How long many traces take, every engine, and how much memory: S2's maneuvers, rules R1 to R3.

Every figure is per trace, step and rule. What judges a trace at a time judges a sample of them;
Spot gets its words as text, made beforehand.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator

import numpy as np
import spot
from figure import Figure, Result
from maneuvers import booleans_of, maneuvers, sample_of, words_in_spot
from numpy.typing import NDArray
from program import run
from timing import in_turns, processor_time

import rulec
from rulec.automata.second_compiler import with_automata
from rulec.monitoring.batch.batch_verify import verify_columns
from rulec.monitoring.batch.cell_verdicts import verify_cells
from rulec.monitoring.batch.columns.column_states import shared_states
from rulec.monitoring.batch.verify import verify
from support.builders.trace_columns import columnize
from support.oracles.bits.bit_verdicts import verify_on_bits
from support.oracles.bits.trace_planes import Across

EVERY = 400
SPOT = "Spot, a word automaton per trace"
COPY = "copying the cells"
COPY_BOOLEANS = "copying the Boolean columns"
ALONE = (SPOT, COPY, COPY_BOOLEANS)
WANTED = {
    "machines, from cells": (0.3, 1500),
    "oracle on bits, from Boolean columns": (0.15, None),
}


def measure(rounds: int) -> Iterator[Result]:
    """Time, then memory."""
    rules = with_automata(rulec.compile_rulebook("esterle2019"))
    cells = maneuvers()
    layout = cells.layout
    columns = columnize(cells, rules.vocabulary)
    booleans = booleans_of(rules, cells)
    sample = sample_of(cells, EVERY)
    size = f"{layout.n_traces:,} traces of {layout.n_steps} states, {len(rules.rules)} rules"
    work = float(layout.n_states * len(rules.rules))
    share = float(len(sample) * layout.n_steps * len(rules.rules))
    engines = {
        "machines, from cells": lambda: verify_cells(cells, rules),
        "machines, from columns": lambda: verify_cells(
            shared_states(columns, rules.vocabulary), rules
        ),
        "columns to verdicts": lambda: verify_columns(columns, rules),
        "oracle on bits, from columns": lambda: list(verify_on_bits(columns, rules)),
        "oracle on bits, from Boolean columns": by_bits(rules, layout, booleans),
    }
    taken = in_turns(
        {
            SPOT: processor_time(by_spot(rules, sample), share),
            "a trace at a time": processor_time(lambda: [verify(x, rules) for x in sample], share),
            **{name: processor_time(engine, work) for name, engine in engines.items()},
            COPY: processor_time(cells.cells.copy, work),
            COPY_BOOLEANS: processor_time(
                lambda: [column.copy() for column in booleans.values()], work
            ),
        },
        rounds,
    )
    yield Result(
        "Many traces",
        f"{size}: the maneuvers of scenario S2 at 0.5 s, esterle2019; per trace, step and rule",
        [
            taken[name].against(taken[SPOT], "Spot", name, "ns", *WANTED.get(name, ()))
            for name in taken
            if name not in ALONE
        ]
        + [taken[name].figure(name, "ns") for name in ALONE],
        [f"Spot, and what judges a trace at a time, judge {len(sample)} of the traces."],
    )
    inputs = {
        "machines, from cells": [cells.cells],
        "machines, from columns": columns.values.values(),
        "oracle on bits, from Boolean columns": booleans.values(),
    }
    found = {name: peak(engines[name]) / bytes_of(arrays) for name, arrays in inputs.items()}
    yield Result(
        "Memory of many traces",
        f"{size}; the most held at once beyond the input, as a multiple of the input",
        [Figure(name, "times", share, share, 3) for name, share in found.items()],
        [f"{name} has {bytes_of(arrays) / 1e6:.2f} MB." for name, arrays in inputs.items()],
    )


def by_spot(rules, traces) -> Callable[[], list[bool]]:
    """Spot's word automaton of each trace, met with the automaton of each rule."""
    automata = [spot.automaton(rule.hoa) for rule in rules.rules]
    words = list(words_in_spot(rules, traces))

    def judged() -> list[bool]:
        found = []
        for word in words:
            one = spot.parse_word(word).as_automaton()
            found += [one.intersects(automaton) for automaton in automata]
        return found

    return judged


def by_bits(rules, layout, booleans) -> Callable[[], list[NDArray[np.bool_]]]:
    """Every rule, evaluated on the columns of its atoms, which are packed first."""

    def judged() -> list[NDArray[np.bool_]]:
        across = Across(layout, booleans.__getitem__)
        return [across.holds(rule.formula) for rule in rules.rules]

    return judged


def bytes_of(arrays) -> int:
    """How large an input is."""
    return sum(array.nbytes for array in arrays)


def peak(work: Callable[[], object]) -> int:
    """The most memory that is held at once, in bytes, beyond what is held before."""
    tracemalloc.start()
    work()
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


if __name__ == "__main__":
    run(measure, rounds=9)

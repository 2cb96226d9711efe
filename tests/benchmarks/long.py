"""How long one trace of ten million states takes, by formulas on random Booleans.

rulec's machines run from the columns; the tests' oracle on bits reads the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from figure import Result
from program import run
from timing import in_turns, processor_time

import rulec
from rulec.logic.bounds import in_steps
from rulec.logic.formula import Atom
from rulec.monitoring.batch.batch_verify import verify_columns
from rulec.rulebook.loader import parse_rulebook
from rulec.trace.trace_columns import TraceColumns, layout_of
from support.oracles.bits import along

LENGTH = 10_000_000
FORMULAS = (
    "always (p implies eventually q)",
    "always (p weak until q)",
    "always (q implies once[<= 20 steps] p)",
)
RULEBOOK = "rulebook r signal p, q hard rule r {{ require {} }}"
MACHINES, BITS, COPY = "machines, {}", "oracle on bits, {}", "copying a column"


def measure(rounds: int) -> Iterator[Result]:
    """Every formula, by both."""
    chance = np.random.default_rng(1)
    p, q = chance.random(LENGTH) < 0.9, chance.random(LENGTH) < 0.1
    propositions = {Atom("p"): p, Atom("q"): q}
    columns = TraceColumns(layout_of([LENGTH]), {("p", ()): p, ("q", ()): q}, {})
    tasks = {}
    for text in FORMULAS:
        rules = rulec.compile_rulebook(parse_rulebook(RULEBOOK.format(text)))
        formula = in_steps(rules.rules[0].formula, columns.step_s)
        by_machines = partial(verify_columns, columns, rules)
        by_bits = partial(along, formula, LENGTH, propositions.__getitem__)
        if (not by_machines()[0].violations) != by_bits():
            raise RuntimeError(f"they disagree on `{text}`")
        tasks[MACHINES.format(text)] = processor_time(by_machines, LENGTH)
        tasks[BITS.format(text)] = processor_time(by_bits, LENGTH)
    tasks[COPY] = processor_time(p.copy, LENGTH)
    taken = in_turns(tasks, rounds)
    copy = taken.pop(COPY)
    yield Result(
        "One long trace",
        f"{LENGTH:,} states from two Boolean columns, p mostly true and q seldom; per step",
        [
            one.figure(name, "ns", *([1] if name.startswith("oracle") else []))
            for name, one in taken.items()
        ]
        + [copy.figure(COPY, "ns")],
    )


if __name__ == "__main__":
    run(measure, rounds=5)

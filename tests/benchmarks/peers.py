"""Rule R1 on traces, by rulec and by other libraries, which judge the same and find the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from batch import by_spot
from figure import Result
from maneuvers import atoms_and_items, booleans_of, is_true, maneuvers, sample_of
from peer import peers
from program import run
from timing import in_turns, processor_time

import rulec
from rulec.monitoring.batch.cell_verdicts import verify_cells
from rulec.monitoring.batch.verify import verify
from support.oracles.bits.trace_planes import Across

EVERY = 1500
PROGRAMS = {"rtamt": "rtamt_traces", "reelay": "reelay_traces", "flloat": "flloat_traces"}
LETTERS = {"CONGESTED": "c", "b": "b", "r": "r", "f": "f"}


def measure(rounds: int) -> Iterator[Result]:
    """One table: rulec's engines, each against every library."""
    book = rulec.compile_rulebook("esterle2019")
    rules = replace(book, rules=book.rules[:1])
    cells = maneuvers()
    booleans = booleans_of(rules, cells)
    sample = sample_of(cells, EVERY)
    formula = rules.rules[0].formula
    by_automata = by_spot(rules, sample)
    few, all_ = float(len(sample) * cells.layout.n_steps), float(cells.layout.n_states)
    ours: dict[str, tuple[Callable[[], list[bool]], float]] = {
        "oracle on bits, from Boolean columns": (
            lambda: Across(cells.layout, booleans.__getitem__).holds(formula)[::EVERY].tolist(),
            all_,
        ),
        "machines, from cells": (
            lambda: verify_cells(cells, rules)[0].accepted[::EVERY].tolist(),
            all_,
        ),
        "a trace at a time": (lambda: [verify(x, rules).satisfied for x in sample], few),
        "Spot": (by_automata, few),
    }
    with peers(job_of(rules, sample), PROGRAMS) as (there, missing):
        answers = {name: work() for name, (work, _) in ours.items()}
        answers |= {name: peer.round()[1] for name, peer in there.items()}
        if len({tuple(answer) for answer in answers.values()}) > 1:
            raise RuntimeError(f"they disagree: {answers}")
        tasks = {name: processor_time(work, units) for name, (work, units) in ours.items()}
        tasks |= {name: peer.timed(few) for name, peer in there.items()}
        taken = in_turns(tasks, rounds)
    libraries = ["Spot", *there]
    yield Result(
        "Other libraries",
        f"rule R1 for one vehicle on the maneuvers of S2 at 0.5 s, {cells.layout.n_steps} states "
        "each; per trace and step",
        [
            taken[name].against(taken[library], library, name, "ns")
            for name in ours
            if name != "Spot"
            for library in libraries
        ]
        + [taken[library].figure(library, "ns") for library in libraries],
        [
            f"One trace at a time is a sample, of {len(sample)}; all find the same verdicts.",
            "Formulas, words and monitors of the libraries are made before the time counts.",
            *missing,
        ],
    )


def job_of(rules, traces) -> list[list[dict[str, bool]]]:
    """The valuations that a library gets."""
    return [
        [
            {
                LETTERS[atom.value or atom.name]: is_true(atom, state, item)
                for atom, item in atoms_and_items(rules, trace.objects).items()
            }
            for state in trace.states
        ]
        for trace in traces
    ]


if __name__ == "__main__":
    run(measure, rounds=9)

"""Traces for the ledger: examples of the books, cases of their law, and both with less known.

They are written as files, so that two versions of rulec judge the same ones.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any

import rulec
from rulec.book_tests.example_runs import example_trace
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.national_books import CASES, NATIONAL, read, trace_of
from support.generators.blurred_traces import places_of
from support.oracles.completion_oracle import put

BOOKS = (*NATIONAL, "esterle2019")
N_RANDOM = 10_000


def write_traces(folder: Path, books: tuple[str, ...], n_random: int = N_RANDOM) -> list[Path]:
    """Write the traces of each book, ``n_random`` random ones in all; the files' paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for book in books:
        known = [*examples(book), *cases(book)]
        for kind, traces in (
            ("known", known),
            ("random", list(randomized(book, known, -(-n_random // len(BOOKS))))),
        ):
            path = folder / f"{book}.{kind}.jsonl"
            rulec.write_traces(traces, path)
            paths.append(path)
    return paths


def examples(book: str) -> Iterator[Trace]:
    for rule in read(book).rulebook.rules:
        for number, example in enumerate(rule.examples):
            yield replace(example_trace(rule, example), id=f"{rule.name}.{number}", place=None)


def cases(book: str) -> Iterator[Trace]:
    traffic = read(book).rulebook.traffic
    for number, case in enumerate(CASES):
        if book in case["verdicts"]:
            yield replace(trace_of(case, traffic), id=f"case.{number}.{case['id']}")


def randomized(book: str, known: list[Trace], n_traces: int) -> Iterator[Trace]:
    """Known traces, changed: other orders and steps, values unknown, names untold, cut ends."""
    chance = Random(f"ledger of {book}")
    for number in range(n_traces):
        trace = chance.choice(known)
        states = list(trace.states)
        if chance.random() < 0.5:
            states = chance.choices(states, k=chance.randint(1, 2 * len(states) + 2))
        told = None
        if chance.random() < 0.3:
            names = sorted({name for state in states for name in state})
            told = frozenset(chance.sample(names, chance.randint(0, len(names))))
            states = [{name: state[name] for name in state if name in told} for state in states]
        changed = replace(
            trace,
            id=f"{number}.{trace.id}",
            step_s=chance.choice([trace.step_s, trace.step_s, 1.0, 0.5]),
            states=tuple(states),
            present={},
            ends=chance.choice(["complete", "cut"]),
            told=told,
        )
        yield _with_unknowns(changed, chance)


def _with_unknowns(trace: Trace, chance: Random) -> Trace:
    """The trace, half of the time with a share of its values unknown."""
    if chance.random() < 0.5:
        return trace
    share = chance.choice([0.05, 0.2, 0.6])
    states: list[Any] = list(trace.states)
    for number, name, objects in places_of(trace):
        if chance.random() < share:
            states[number] = put(states[number], name, objects, UNKNOWN)
    return replace(trace, states=tuple(states))

"""Shortest words on which several machines give the verdicts that are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.witnesses.joint_alphabet import JointLetter
from rulec.witnesses.undecided import UndecidedError

MOST_STATES = 50_000
MOST_STEPS = 3_000_000
"""What a search may look at: joint states, and steps from one to another."""

ProductState = tuple[int, ...]


def shortest_word(
    machines: Sequence[MealyMonitor], wanted: Sequence[bool], symbols: Sequence[JointLetter]
) -> tuple[JointLetter, ...] | None:
    """A shortest word, not empty, with these verdicts, in breadth-first order; None if none has.

    Raises UndecidedError where there is too much to search.
    """
    start: ProductState = (0,) * len(machines)
    came: dict[ProductState, tuple[ProductState, JointLetter] | None] = {start: None}
    waiting = [start]
    lost = [
        one.accepting_sink if verdict is False else one.rejecting_sink
        for one, verdict in _pairs(machines, wanted)
    ]
    steps = 0
    for node in waiting:
        rows = [one.outputs[state] for one, state in zip(machines, node, strict=True)]
        successors = [one.successors[state] for one, state in zip(machines, node, strict=True)]
        for symbol in symbols:
            if all(
                row[which] is verdict
                for row, which, verdict in zip(rows, symbol, wanted, strict=True)
            ):
                return (*_way(node, came), symbol)
            target = tuple([row[which] for row, which in zip(successors, symbol, strict=True)])
            if target in came or any(a == b for a, b in zip(target, lost, strict=True)):
                continue
            came[target] = node, symbol
            waiting.append(target)
        steps += len(symbols)
        if len(waiting) > MOST_STATES or steps > MOST_STEPS:
            raise UndecidedError("their automata together are too large")
    return None


def _pairs(
    machines: Sequence[MealyMonitor], wanted: Sequence[bool]
) -> Iterable[tuple[MealyMonitor, bool]]:
    return zip(machines, wanted, strict=True)


def _way(
    node: ProductState, came: dict[ProductState, tuple[ProductState, JointLetter] | None]
) -> tuple[JointLetter, ...]:
    word: list[JointLetter] = []
    step = came[node]
    while step is not None:
        node, symbol = step
        word.append(symbol)
        step = came[node]
    return tuple(reversed(word))

"""Shortest words on which several monitors give requested verdicts.

The product of the monitors is searched breadth first, and built as far as the search gets.
"""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.witnesses.joint_alphabet import JointLetter
from rulec.witnesses.undecided import UndecidedError

MOST_STATES = 50_000
MOST_STEPS = 3_000_000
"""States of a product that a search looks at, and steps from one to another."""

ProductState = tuple[int, ...]


def shortest_word(
    monitors: Sequence[MealyMonitor], verdicts: Sequence[bool], letters: Sequence[JointLetter]
) -> tuple[JointLetter, ...] | None:
    """Find a shortest non-empty word with these verdicts, or None.

    Of several the first in the order of ``letters``. A single monitor is searched to its end;
    raises UndecidedError where a product is too large for that.
    """
    start: ProductState = (0,) * len(monitors)
    reached_by: dict[ProductState, tuple[ProductState, JointLetter] | None] = {start: None}
    waiting = [start]
    hopeless = [
        monitor.rejecting_sink if verdict else monitor.accepting_sink
        for monitor, verdict in zip(monitors, verdicts, strict=True)
    ]
    steps = 0
    for state in waiting:
        pairs = list(zip(monitors, state, strict=True))
        outputs = [monitor.outputs[own] for monitor, own in pairs]
        successors = [monitor.successors[own] for monitor, own in pairs]
        for letter in letters:
            if all(
                row[own] is verdict
                for row, own, verdict in zip(outputs, letter, verdicts, strict=True)
            ):
                return (*_word_to(state, reached_by), letter)
            target = tuple([row[own] for row, own in zip(successors, letter, strict=True)])
            if target in reached_by or any(
                own == sink for own, sink in zip(target, hopeless, strict=True)
            ):
                continue
            reached_by[target] = state, letter
            waiting.append(target)
        steps += len(letters)
        if len(monitors) > 1 and (len(waiting) > MOST_STATES or steps > MOST_STEPS):
            raise UndecidedError("their automata together are too large")
    return None


def _word_to(
    state: ProductState,
    reached_by: dict[ProductState, tuple[ProductState, JointLetter] | None],
) -> tuple[JointLetter, ...]:
    word: list[JointLetter] = []
    step = reached_by[state]
    while step is not None:
        state, letter = step
        word.append(letter)
        step = reached_by[state]
    return tuple(reversed(word))

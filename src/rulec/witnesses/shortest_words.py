"""Shortest words on which monitors give verdicts.

The product of several monitors is searched breadth first, and only built as far as needed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.witnesses.joint_alphabet import JointLetter
from rulec.witnesses.undecided import UndecidedError

MOST_STATES = 50_000
MOST_STEPS = 3_000_000
"""The most states and transitions of a product that a search examines."""

ProductState = tuple[int, ...]


def shortest_word(
    monitors: Sequence[MealyMonitor],
    verdicts: Sequence[bool],
    letters: Sequence[JointLetter],
    can_be_read: Callable[[JointLetter], bool] = lambda _: True,
) -> tuple[JointLetter, ...] | None:
    """Find a shortest non-empty word with these verdicts, or None.

    Among several, the first in the order of ``letters`` that can be read is returned;
    ``can_be_read`` is only called where it matters. A single monitor is searched completely; raises
    UndecidedError if a product is too large for that.
    """
    start: ProductState = (0,) * len(monitors)
    words: dict[ProductState, tuple[JointLetter, ...]] = {start: ()}
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
            ) and can_be_read(letter):
                return (*words[state], letter)
            target = tuple([row[own] for row, own in zip(successors, letter, strict=True)])
            if target in words or any(
                own == sink for own, sink in zip(target, hopeless, strict=True)
            ):
                continue
            if not can_be_read(letter):
                continue
            words[target] = (*words[state], letter)
            waiting.append(target)
        steps += len(letters)
        if len(monitors) > 1 and (len(waiting) > MOST_STATES or steps > MOST_STEPS):
            raise UndecidedError("their automata together are too large")
    return None

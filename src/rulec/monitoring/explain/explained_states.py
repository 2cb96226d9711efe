"""The states that an explanation evaluates: all, or a window of a long trace."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.limits import LIMITS


def states_to_explain(
    machine: MealyMonitor,
    stretch: range,
    decisive: int,
    word: Callable[[int, int], Sequence[int]],
) -> Sequence[int]:
    """The numbers of the states that explain a violation with this decisive state, ascending.

    Of a long ``stretch`` these are a window around the decisive state, the first state, and the
    fewest states before the window that bring the machine into the same state as the whole stretch:
    where the machine returns to a state, what lies in between makes no difference. So these states
    alone violate the rule, with the same decisive state. ``word`` gives the letter classes from one
    state to another (inclusive).
    """
    window = range(
        max(stretch.start, decisive - LIMITS.states_explained),
        min(stretch.stop, decisive + LIMITS.states_explained + 1),
    )
    if len(stretch) <= 2 * LIMITS.states_explained or window.start == stretch.start:
        return stretch[: window.stop - stretch.start] if len(window) < len(stretch) else stretch
    first, *letters = word(stretch.start, window.start - 1)
    state = machine.successors[0][first]
    way, length_at = [stretch.start], {state: 1}
    for number, letter in enumerate(letters, stretch.start + 1):
        state = machine.successors[state][letter]
        if state in length_at:
            del way[length_at[state] :]
            length_at = {at: n for at, n in length_at.items() if n <= len(way)}
        else:
            way.append(number)
            length_at[state] = len(way)
    return [*way, *window]


def shown_states(stretch: range, decisive: int) -> tuple[int, ...]:
    """The numbers of the states of a stretch that an explanation shows."""
    if len(stretch) <= LIMITS.states_shown:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - LIMITS.states_shown + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))

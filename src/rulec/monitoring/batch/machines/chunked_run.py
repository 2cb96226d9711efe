"""Run of a machine over one long trace, in parallel pieces.

Where in the machine a piece begins is only known when the piece before it has ended, so each is
run from every state first; then from the one that it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.trace.trace_columns import Array

_FEW = 16
"""A step of so few traces side by side takes longer than one step of each."""

FEWEST_STEPS = 1 << 10
"""Shorter traces are not long."""

_MOST_RUNS = 1 << 10
"""More traces, times states of the machine, are better taken side by side."""

_MOST_STATES = 32
"""From more states than these, one step after the other is quicker."""

_STEP_IN_PIECES = 64
"""How much longer a step of all pieces takes than finding where one of them begins."""


def run_alone(n_traces: int, n_steps: int, n_states: int) -> bool:
    """Tell whether it is cheaper to run these traces one by one."""
    if n_traces <= _FEW and n_steps >= _FEW:
        return True
    return n_steps >= FEWEST_STEPS and n_traces * min(n_states, _MOST_STATES) <= _MOST_RUNS


def visited(successors: Sequence[Sequence[int]], letters: Array) -> NDArray[np.intp]:
    """State before each letter of a non-empty word; 0 comes first."""
    n_states, n_letters = len(successors), len(letters)
    if n_states > _MOST_STATES or n_letters < FEWEST_STEPS:
        return _one_by_one(successors, letters)
    length = isqrt(n_letters // _STEP_IN_PIECES) + 1
    n_pieces = -(-n_letters // length)
    word = np.zeros(n_pieces * length, dtype=np.intp)
    word[:n_letters] = letters
    # A row holds the letters that all pieces read at the same time.
    rows = np.ascontiguousarray(word.reshape(n_pieces, length).T)
    width = len(successors[0])
    onward = np.array(successors, dtype=np.intp).ravel() * width
    # One line for each state that pieces may begin in.
    state = np.repeat(np.arange(n_states) * width, n_pieces).reshape(n_states, n_pieces)
    for row in rows:
        state = onward.take(state + row)
    ends = (state // width).T.tolist()
    begins = [0]
    for piece in ends[:-1]:
        begins.append(piece[begins[-1]])
    result = np.empty((length, n_pieces), dtype=np.intp)
    now = np.array(begins) * width
    for place, row in enumerate(rows):
        result[place] = now
        now = onward.take(now + row)
    states: NDArray[np.intp] = result.T.ravel()[:n_letters] // width
    return states


def _one_by_one(successors: Sequence[Sequence[int]], letters: Array) -> NDArray[np.intp]:
    numbers, state = [], 0
    for letter in letters.tolist():
        numbers.append(state)
        state = successors[state][letter]
    return np.array(numbers, dtype=np.intp)


def first_lost_of_one(machine: MealyMonitor, letters: Array) -> int:
    """Index of the letter that loses a word; -1 if none does."""
    if machine.rejecting_sink is None:
        return -1
    # A finite word may be accepted if it ends here, though no longer one is: `weak next false`.
    outputs = np.array(machine.outputs, dtype=bool)
    lost = (np.array(machine.successors) == machine.rejecting_sink) & ~outputs
    places = np.flatnonzero(lost[visited(machine.successors, letters), letters])
    return int(places[0]) if len(places) else -1

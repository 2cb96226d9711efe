"""Runs a machine over many traces step by step, or over a long trace in parallel pieces.

The state in which a piece begins is known only when the piece before it has ended, so each piece is
first run from every state, then from the actual one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import isqrt

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.batch.machines.joint_machine import JointMachine
from rulec.monitoring.batch.machines.multi_step_tables import (
    MOST_ENTRIES,
    Rows,
    run_multi_step,
    steps_of,
)
from rulec.trace.trace_columns import Array, Layout, smallest_unsigned

_FEW = 16
"""With so few traces side by side, a joint step takes longer than one step of each."""

FEWEST_STEPS = 1 << 10
"""Traces with fewer steps are not treated as long."""

_MOST_RUNS = 1 << 10
"""With more traces times machine states, running them side by side is faster."""

_MOST_STATES = 32
"""With more machine states than these, running step by step is faster."""

_STEP_IN_PIECES = 64
"""The cost of one step of all pieces, in units of finding the start state of one piece."""


def run(
    joint: JointMachine, cells: Array, layout: Layout, first: int = 0, last: int | None = None
) -> NDArray[np.uint8]:
    """The verdicts on all traces, from step ``first`` to ``last`` (inclusive).

    ``cells`` are unsigned integers in the layout's order. All traces have step ``last``; None is
    for the end of each. The result has for each trace a joint verdict, as in ``JointMachine``.
    """
    n_states, n_cells = len(joint.successors), len(joint.letters)
    if run_alone(layout.n_traces, layout.n_steps - first, n_states):
        return _run_long(joint, cells, layout, first, last)
    steps = steps_of(layout, first, last)
    if n_states * n_cells <= MOST_ENTRIES:
        # The letters of cells are built into the tables.
        return run_multi_step(*_by_cells(joint), cells, steps)
    letters = np.array(joint.letters, dtype=smallest_unsigned(joint.n_letters)).take(cells)
    return run_multi_step(joint.successors, joint.verdicts, letters, steps)


@lru_cache(maxsize=64)
def _by_cells(joint: JointMachine) -> tuple[Rows, Rows]:
    successors = [tuple([row[letter] for letter in joint.letters]) for row in joint.successors]
    verdicts = [tuple([row[letter] for letter in joint.letters]) for row in joint.verdicts]
    return tuple(successors), tuple(verdicts)


def _run_long(
    joint: JointMachine, cells: Array, layout: Layout, first: int, last: int | None
) -> NDArray[np.uint8]:
    letter_of_cell = np.array(joint.letters)
    result = np.empty(layout.n_traces, dtype=np.uint8)
    for trace in range(layout.n_traces):
        letters = letter_of_cell.take(cells[layout.places(trace, first, last)])
        state = visited(joint.successors, letters)[-1]
        result[trace] = joint.verdicts[state][letters[-1]]
    return result


def run_alone(n_traces: int, n_steps: int, n_states: int) -> bool:
    """Whether it is cheaper to run these traces one by one."""
    if n_traces <= _FEW and n_steps >= _FEW:
        return True
    return n_steps >= FEWEST_STEPS and n_traces * min(n_states, _MOST_STATES) <= _MOST_RUNS


def visited(successors: Sequence[Sequence[int]], letters: Array) -> NDArray[np.intp]:
    """The state before each letter of a non-empty word; 0 comes first."""
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
    # One line for each possible start state of a piece.
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


def first_lost(
    machine: MealyMonitor,
    letters: Sequence[int],
    cells: Array,
    layout: Layout,
    chosen: NDArray[np.intp],
    *,
    stretch: tuple[int, int | None],
) -> NDArray[np.int64]:
    """The step at which each of the ``chosen`` traces is lost in a stretch; -1 if it is not.

    ``letters`` has for each cell the class of its letter.
    """
    first, last = stretch
    ends = layout.lengths[chosen] if last is None else np.full(len(chosen), last + 1)
    if machine.rejecting_sink is None or not len(chosen):
        return np.full(len(chosen), -1, dtype=np.int64)
    successors, classes = np.array(machine.successors, dtype=np.intp), np.array(letters)
    # A word that ends here may be accepted although no longer word is: `weak next false`.
    lost = (successors == machine.rejecting_sink) & ~np.array(machine.outputs, dtype=bool)
    if run_alone(len(ends), int(ends[0]) - first, len(successors)):
        found = []
        for trace in chosen.tolist():
            word = classes.take(cells[layout.places(trace, first, last)])
            places = lost[visited(machine.successors, word), word].nonzero()[0]
            found.append(first + int(places[0]) if len(places) else -1)
        return np.array(found, dtype=np.int64)
    width = len(machine.successors[0])
    state = np.zeros(len(chosen), dtype=np.intp)
    kept = np.full(len(chosen), first, dtype=np.int64)
    # The ends are in descending order: those after a step come first.
    for step in range(first, int(ends[0])):
        there = chosen[: np.searchsorted(-ends, -step)]
        entry = state[: len(there)] * width + classes.take(cells[layout.starts[step] + there])
        # Once lost, always lost: the number of kept steps is the index of the first lost one.
        kept[: len(there)] += ~lost.take(entry)
        state = successors.take(entry)
    return np.where(kept < ends, kept, -1)

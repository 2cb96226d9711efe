"""Runs a machine over many traces step by step, or over a long trace in parallel pieces.

The state in which a piece begins is known only when the piece before it has ended, so each piece is
first run from every state, then from the actual one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from math import isqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.batch.machines.joint_machine import JointMachine
from rulec.monitoring.batch.machines.multi_step_tables import (
    Rows,
    Step,
    is_cheaper,
    run_multi_step,
    steps_of,
)
from rulec.trace.trace_columns import Array, Layout, smallest_unsigned

_BYTE = 256

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
    if is_cheaper(n_states, n_cells, layout.n_traces):
        # The letters of cells are built into the tables.
        return run_multi_step(*_by_cells(joint), cells, steps)
    if n_states * n_cells <= _BYTE and cells.dtype == np.uint8:
        return _run_bytes(joint, joint.letters, cells, steps)
    letters = letters_of_cells(cells, joint.letters)
    if is_cheaper(n_states, joint.n_letters, layout.n_traces):
        return run_multi_step(joint.successors, joint.verdicts, letters, steps)
    if n_states * joint.n_letters <= _BYTE:
        return _run_bytes(joint, range(joint.n_letters), letters, steps)
    return _run_wide(joint, letters, steps)


@lru_cache(maxsize=64)
def _by_cells(joint: JointMachine) -> tuple[Rows, Rows]:
    successors = [tuple([row[letter] for letter in joint.letters]) for row in joint.successors]
    verdicts = [tuple([row[letter] for letter in joint.letters]) for row in joint.verdicts]
    return tuple(successors), tuple(verdicts)


def letters_of_cells(cells: Array, letters: Sequence[int]) -> Array:
    """The letter of every cell, as the smallest unsigned integers."""
    dtype = smallest_unsigned(max(letters, default=0) + 1)
    if cells.dtype == dtype == np.uint8:
        return np.frombuffer(cells.tobytes().translate(_padded(letters)), np.uint8)
    return np.take(np.array(letters, dtype=dtype), cells)


def _run_bytes(
    joint: JointMachine,
    letters: Sequence[int],
    column: NDArray[np.uint8],
    steps: Sequence[Step],
) -> NDArray[np.uint8]:
    """Run a small machine by byte translation, in a loop of the C library."""
    width = len(letters)
    successors = _padded([row[letter] * width for row in joint.successors for letter in letters])
    verdicts = _padded([row[letter] for row in joint.verdicts for letter in letters])
    ends = np.empty(steps[0].n_traces if steps else 0, dtype=np.uint8)
    state = np.zeros(len(ends), dtype=np.uint8)
    for step in steps:
        goes_on = step.n_continuing
        entry = state[: step.n_traces]
        entry = entry + column[step.part]
        ends[goes_on : step.n_traces] = entry[goes_on:]
        if goes_on:
            state = np.frombuffer(entry[:goes_on].tobytes().translate(successors), np.uint8)
    return np.frombuffer(ends.tobytes().translate(verdicts), np.uint8)


def _run_wide(joint: JointMachine, column: Array, steps: Sequence[Step]) -> NDArray[np.uint8]:
    width = joint.n_letters
    dtype = np.uint16 if len(joint.successors) * width <= 1 << 16 else np.intp
    successors = np.array(joint.successors, dtype=dtype).ravel() * dtype(width)
    verdicts = np.array(joint.verdicts, dtype=np.uint8).ravel()
    results = np.empty(steps[0].n_traces if steps else 0, dtype=np.uint8)
    state = np.zeros(len(results), dtype=dtype)
    for step in steps:
        entry = state[: step.n_traces] + column[step.part]
        results[step.n_continuing : step.n_traces] = verdicts.take(entry[step.n_continuing :])
        state = successors.take(entry[: step.n_continuing])
    return results


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


def first_lost_of_one(machine: MealyMonitor, letters: Array) -> int:
    """The index of the letter at which a word is lost; -1 if it is not."""
    if machine.rejecting_sink is None:
        return -1
    # A word that ends here may be accepted although no longer word is: `weak next false`.
    outputs = np.array(machine.outputs, dtype=bool)
    lost = (np.array(machine.successors) == machine.rejecting_sink) & ~outputs
    places = np.flatnonzero(lost[visited(machine.successors, letters), letters])
    return int(places[0]) if len(places) else -1


def first_lost(
    machine: MealyMonitor, letters: Sequence[int], by_step: Iterable[Array], lengths: NDArray[Any]
) -> NDArray[np.int64]:
    """The step at which each trace is lost, counted from its first step here; -1 if it is not.

    ``letters`` has for each cell the class of its letter, ``by_step`` for each step the cells of
    the traces that have it; these come first, since ``lengths`` descend.
    """
    if machine.rejecting_sink is None:
        return np.full(len(lengths), -1, dtype=np.int64)
    width = len(machine.successors[0])
    successors = np.array(machine.successors, dtype=np.intp).ravel() * width
    # A word that ends here may be accepted although no longer word is: `weak next false`.
    lost = (successors == machine.rejecting_sink * width) & ~np.array(
        machine.outputs, dtype=bool
    ).ravel()
    classes = np.array(letters, dtype=np.intp)
    state = np.zeros(len(lengths), dtype=np.intp)
    kept = np.zeros(len(lengths), dtype=np.int64)
    for cells in by_step:
        entry = state[: len(cells)] + classes.take(cells)
        # Once lost, always lost: the number of kept steps is the index of the first lost one.
        kept[: len(cells)] += ~lost.take(entry)
        state = successors.take(entry)
    return np.where(kept < lengths, kept, -1)


def _padded(table: Sequence[int]) -> bytes:
    return bytes(table) + bytes(_BYTE - len(table))

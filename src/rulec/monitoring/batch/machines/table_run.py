"""Run of a machine over many traces, one step at a time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.batch.machines.chunked_run import run_alone, visited
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


def run(
    joint: JointMachine, cells: Array, layout: Layout, first: int = 0, last: int | None = None
) -> NDArray[np.uint8]:
    """The verdicts on all traces, from step ``first`` to ``last`` (inclusive).

    Args:
        joint: the machine.
        cells: unsigned integers in the layout's order.
        layout: the traces; all have step ``last``.
        first: where the runs begin.
        last: where they end; None for the end of each trace.

    Returns:
        For each trace a joint verdict, as in ``JointMachine``.
    """
    n_states, n_cells = len(joint.successors), len(joint.letters)
    if run_alone(layout.n_traces, layout.n_steps - first, n_states):
        return _run_long(joint, cells, layout, first, last)
    steps = steps_of(layout, first, last)
    if is_cheaper(n_states, n_cells, layout.n_traces):
        # The letters of the cells are worked into the tables.
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
    """The successors and the verdicts by state and cell."""
    successors = [tuple([row[letter] for letter in joint.letters]) for row in joint.successors]
    verdicts = [tuple([row[letter] for letter in joint.letters]) for row in joint.verdicts]
    return tuple(successors), tuple(verdicts)


def letters_of_cells(cells: Array, letters: Sequence[int]) -> Array:
    """The letter of every cell, in the narrowest integers."""
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
    """Run a small machine by byte translation, in the C library's loop."""
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
    """Run a machine that a byte is too small for."""
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
    """Run a machine over a few long traces, one after the other."""
    letter_of_cell = np.array(joint.letters)
    result = np.empty(layout.n_traces, dtype=np.uint8)
    for trace in range(layout.n_traces):
        letters = letter_of_cell.take(cells[layout.places(trace, first, last)])
        state = visited(joint.successors, letters)[-1]
        result[trace] = joint.verdicts[state][letters[-1]]
    return result


def first_lost(
    machine: MealyMonitor, letters: Sequence[int], by_step: Iterable[Array], lengths: NDArray[Any]
) -> NDArray[np.int64]:
    """Step that loses each trace, from its first here; -1 for none.

    Args:
        machine: the machine.
        letters: for each cell the class of its letter.
        by_step: for each step the cells of the traces that have it, which are the first ones.
        lengths: how many steps the traces have, in descending order.
    """
    if machine.rejecting_sink is None:
        return np.full(len(lengths), -1, dtype=np.int64)
    width = len(machine.successors[0])
    successors = np.array(machine.successors, dtype=np.intp).ravel() * width
    # A finite word may be accepted if it ends here, though no longer one is: `weak next false`.
    lost = (successors == machine.rejecting_sink * width) & ~np.array(
        machine.outputs, dtype=bool
    ).ravel()
    classes = np.array(letters, dtype=np.intp)
    state = np.zeros(len(lengths), dtype=np.intp)
    kept = np.zeros(len(lengths), dtype=np.int64)
    for cells in by_step:
        entry = state[: len(cells)] + classes.take(cells)
        # Once lost, always lost: so many steps are kept as come before.
        kept[: len(cells)] += ~lost.take(entry)
        state = successors.take(entry)
    return np.where(kept < lengths, kept, -1)


def _padded(table: Sequence[int]) -> bytes:
    return bytes(table) + bytes(_BYTE - len(table))

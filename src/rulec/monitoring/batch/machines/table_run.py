"""Runs a machine over many traces step by step, or over a long trace in parallel pieces.

The state in which a piece begins is known only when the piece before it has ended, so each piece is
first run from every state, then from the actual one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, repeat
from math import isqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.monitoring.batch.machines.joint_machine import JointMachine
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


Rows = tuple[tuple[int, ...], ...]
"""A number for each letter, for each state."""

MOST_ENTRIES = 1 << 16
"""The most entries of a table: what two bytes can number."""

_LONGEST = 16
"""The most steps in one look-up, if there is only one letter."""

_WORTH = 4
"""How many look-ups make up for computing one entry of a table."""


@dataclass(frozen=True, slots=True)
class Step:
    """A step of ``n_traces`` traces, ``n_continuing`` of which have a next step."""

    n_traces: int
    n_continuing: int
    part: slice


def steps_of(layout: Layout, first: int, last: int | None) -> list[Step]:
    """The steps from first to last (inclusive), or to each trace's end."""
    starts = layout.starts.tolist()
    steps = range(first, layout.n_steps if last is None else last + 1)
    # No trace continues after the last of these steps.
    traces = [*(starts[step + 1] - starts[step] for step in steps), 0]
    return [
        Step(n_traces, n_continuing, slice(starts[step], starts[step] + n_traces))
        for step, (n_traces, n_continuing) in zip(steps, pairwise(traces), strict=True)
    ]


def run_multi_step(
    successors: Rows, verdicts: Rows, letters: Array, steps: Sequence[Step]
) -> NDArray[np.uint8]:
    """The verdicts on all traces: ``verdicts[state][letter]`` for the last letter of each.

    ``letters`` is the column of all letters. Runs start in state 0.
    """
    n_states, n_letters = len(successors), len(successors[0])
    dtype = np.uint16 if n_states * n_letters <= MOST_ENTRIES else np.intp
    result = np.empty(steps[0].n_traces if steps else 0, dtype=np.uint8)
    most = min(MOST_ENTRIES, len(result) // _WORTH)
    blocks = list(_step_blocks(steps, n_states, n_letters, most))
    tables: dict[tuple[int, ...], Array] = {}
    state: Array | None = None
    for place, block in enumerate(blocks):
        entry = letters[block[0].part].astype(dtype)
        for step in block[1:]:
            entry *= dtype(n_letters)
            entry += letters[step.part]
        # Only before its first step is a run certainly in one state.
        begins = n_states if place else 1
        if state is not None:
            entry += state
        end = block[-1]
        if end.n_continuing < end.n_traces:
            table = _verdicts(successors, verdicts, len(block), begins)
            result[end.n_continuing : end.n_traces] = table.take(entry[end.n_continuing :])
        if end.n_continuing:
            key = len(block), begins, len(blocks[place + 1])
            if key not in tables:
                tables[key] = _next_states(successors, *key, dtype)
            state = tables[key].take(entry[: end.n_continuing])
    return result


# Traces arrive some thousands at a time, and the same machines run over each chunk.


@lru_cache(maxsize=64)
def _next_states(
    successors: Rows, length: int, begins: int, next_length: int, dtype: type[Any]
) -> Array:
    """The table from a start state and ``length`` letters to the next state.

    A state is given as its first entry in the table of the next leap.
    """
    table = np.array(successors, dtype=dtype)
    scale = dtype(len(successors[0]) ** next_length)
    entries: Array = _after(table, successors, length, begins) * scale
    return entries


@lru_cache(maxsize=64)
def _verdicts(successors: Rows, verdicts: Rows, length: int, begins: int) -> Array:
    return _after(np.array(verdicts, dtype=np.uint8), successors, length, begins)


def _after(last: Array, successors: Rows, length: int, begins: int) -> Array:
    """The entries of ``last`` for all words of ``length`` letters."""
    if length == 1:
        return last[:begins].ravel()
    onward = np.array(successors, dtype=np.intp)
    before = onward[:begins]
    for _ in range(length - 2):
        before = onward[before].reshape(begins, -1)
    return last[before].ravel()


def _step_blocks(
    steps: Sequence[Step], n_states: int, n_letters: int, most: int
) -> Iterator[Sequence[Step]]:
    """Groups of steps that are taken together; a group ends wherever a trace ends."""
    start, begins = 0, 1
    for end, step in enumerate(steps, 1):
        if step.n_continuing < step.n_traces:
            for length in _lengths(
                end - start, _most(most // begins, n_letters), _most(most // n_states, n_letters)
            ):
                yield steps[start : start + length]
                start += length
            begins = n_states


def _most(n_entries: int, n_letters: int) -> int:
    """The largest number of letters that form at most ``n_entries`` words."""
    length = 1
    while n_letters ** (length + 1) <= n_entries and length < _LONGEST:
        length += 1
    return length


def _lengths(n_steps: int, first: int, later: int) -> Iterator[int]:
    """Split steps into the fewest parts of nearly equal lengths.

    The first part has at most ``first`` steps, the others at most ``later``.
    """
    n_parts = 1 + -(-max(n_steps - first, 0) // later)
    later = min(later, -(-n_steps // n_parts))
    yield n_steps - later * (n_parts - 1)
    yield from repeat(later, n_parts - 1)

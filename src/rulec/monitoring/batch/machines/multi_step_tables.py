"""Runs a machine over many traces, several steps per table look-up.

The letters of several steps are the digits of one number. A table gives, for every state and every
such number, the state that follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.trace.trace_columns import Array, Layout

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

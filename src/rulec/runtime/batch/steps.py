"""The steps of many traces, one after the other."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.trace.columns import Layout


@dataclass(frozen=True, slots=True)
class Step:
    """A step of ``now`` traces, ``onward`` of which have a next one; ``part`` is their column."""

    now: int
    onward: int
    part: slice


def steps_of(layout: Layout, first: int, last: int | None) -> list[Step]:
    """The steps from one to another (inclusive), or to the end of each trace."""
    found = []
    for step in range(first, layout.n_steps if last is None else last + 1):
        now = layout.active(step)
        onward = layout.active(step + 1) if last is None else 0 if step == last else now
        start = int(layout.starts[step])
        found.append(Step(now, onward, slice(start, start + now)))
    return found

"""The steps of many traces, one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from rulec.trace.trace_columns import Layout


@dataclass(frozen=True, slots=True)
class Step:
    """Step of ``n_traces`` traces, ``n_continuing`` of them with a next one."""

    n_traces: int
    n_continuing: int
    part: slice


def steps_of(layout: Layout, first: int, last: int | None) -> list[Step]:
    """Steps from first to last (inclusive), or to each trace's end."""
    starts = layout.starts.tolist()
    steps = range(first, layout.n_steps if last is None else last + 1)
    # No trace goes on after the last of these steps.
    traces = [*(starts[step + 1] - starts[step] for step in steps), 0]
    return [
        Step(n_traces, n_continuing, slice(starts[step], starts[step] + n_traces))
        for step, (n_traces, n_continuing) in zip(steps, pairwise(traces), strict=True)
    ]

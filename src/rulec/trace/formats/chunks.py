"""Traces, some at a time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rulec.diagnostics import RulecError
from rulec.trace.trace_model import Trace

_MOST_STATES = 1 << 16


def in_chunks(traces: Iterable[Trace | RulecError]) -> Iterator[list[Trace | RulecError]]:
    """Group traces into lists of some thousand states."""
    chunk: list[Trace | RulecError] = []
    n_states = 0
    for trace in traces:
        chunk.append(trace)
        n_states += len(trace.states) if isinstance(trace, Trace) else 1
        if n_states >= _MOST_STATES:
            yield chunk
            chunk, n_states = [], 0
    if chunk:
        yield chunk

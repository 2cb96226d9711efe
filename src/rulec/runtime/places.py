"""Cells followed through time: which nodes of a graph are one place."""

from __future__ import annotations

from collections import Counter
from itertools import count

from rulec.trace import TraceGraph

Places = tuple[tuple[int, ...], ...]
"""For every layer and node the number of its place."""


def places(graph: TraceGraph) -> Places:
    """The place of every node.

    A node is the same place as one of the layer before if that continues as it alone, and it
    continues that alone. Where cells fall apart or run together, new places begin.
    """
    numbers = count()
    found = [tuple([next(numbers) for _ in graph.states[0]])]
    for rows, margins, states in zip(
        graph.successors, graph.margins, graph.states[1:], strict=True
    ):
        stays = [
            [target for target, margin in zip(row, times, strict=True) if margin is None]
            for row, times in zip(rows, margins, strict=True)
        ]
        origins = Counter([target for row in stays for target in row])
        same = {
            row[0]: place
            for row, place in zip(stays, found[-1], strict=True)
            if len(row) == 1 and origins[row[0]] == 1
        }
        found.append(
            tuple([same[node] if node in same else next(numbers) for node in range(len(states))])
        )
    return tuple(found)

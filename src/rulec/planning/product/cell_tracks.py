"""Cells followed through time: which nodes of a graph are one place."""

from __future__ import annotations

from rulec.trace import TraceGraph

CellTracks = tuple[tuple[int, ...], ...]
"""For every layer and node the number of its place."""


def cell_tracks(graph: TraceGraph) -> CellTracks:
    """The place of every node.

    Nodes of consecutive layers are one place if one continues as the other, so that going there is
    staying, and their states are the same. Places are numbered as they begin.
    """
    parents: list[int] = []
    rows: list[list[int]] = []
    for states in graph.states:
        rows.append(list(range(len(parents), len(parents) + len(states))))
        parents += rows[-1]

    def root(node: int) -> int:
        while parents[node] != node:
            parents[node] = parents[parents[node]]
            node = parents[node]
        return node

    for layer, (onward, margins) in enumerate(zip(graph.successors, graph.margins, strict=True)):
        for node, (targets, times) in enumerate(zip(onward, margins, strict=True)):
            for target, margin in zip(targets, times, strict=True):
                if margin is None and graph.states[layer][node] == graph.states[layer + 1][target]:
                    first, second = root(rows[layer][node]), root(rows[layer + 1][target])
                    parents[max(first, second)] = min(first, second)
    numbers: dict[int, int] = {}
    return tuple(
        tuple([numbers.setdefault(root(node), len(numbers)) for node in row]) for row in rows
    )

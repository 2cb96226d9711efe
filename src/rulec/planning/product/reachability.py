"""The ways through a graph from its start to its goals."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.trace import TraceGraph

Step = tuple[int, int]
"""A follower in the next layer, and the cost of going there."""


def trimmed(graph: TraceGraph) -> list[tuple[bool, ...]]:
    """Trim a graph: mark nodes between start and some goal."""
    from_start = [{graph.start}]
    for successors in graph.successors:
        from_start.append({target for node in from_start[-1] for target in successors[node]})
    ahead = set(graph.goals)
    result = []
    for layer in reversed(range(len(graph.states))):
        if layer < len(graph.successors):
            rows = graph.successors[layer]
            ahead = {node for node in from_start[layer] if not ahead.isdisjoint(rows[node])}
        ahead &= from_start[layer]
        result.append(tuple([node in ahead for node in range(len(graph.states[layer]))]))
    same = {layer: layer for layer in result}
    return [same[layer] for layer in reversed(result)]


def trimmed_steps(
    graph: TraceGraph, on_the_way: Sequence[Sequence[bool]]
) -> tuple[tuple[tuple[Step, ...], ...], ...]:
    """Successors within the trimmed graph, with their costs."""
    same: dict[object, tuple[tuple[Step, ...], ...]] = {}
    result = []
    for layer, (rows, costs) in enumerate(zip(graph.successors, graph.weights, strict=True)):
        ahead = on_the_way[layer + 1]
        steps = tuple(
            [
                tuple([step for step in zip(row, cost, strict=True) if ahead[step[0]]])
                for row, cost in zip(rows, costs, strict=True)
            ]
        )
        result.append(same.setdefault(steps, steps))
    return tuple(result)

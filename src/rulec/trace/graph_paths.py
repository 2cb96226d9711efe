"""The paths of a trace graph, as traces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

from rulec.trace.trace_model import Trace, TraceGraph


def paths(graph: TraceGraph) -> Iterator[tuple[int, ...]]:
    """Paths from start to goals, as node indices, in ascending order.

    Lazily and in memory bounded by the graph: dead ends are known before they are entered.
    """
    alive = _alive(graph)
    last = len(graph.states) - 1
    if graph.start not in alive[0]:
        return
    path = [graph.start]
    choices = [_onward(graph, alive, path)]
    while choices:
        if len(path) - 1 == last:
            yield tuple(path)
        following = next(choices[-1], None)
        if following is None:
            choices.pop()
            path.pop()
        else:
            path.append(following)
            choices.append(_onward(graph, alive, path))


def _onward(graph: TraceGraph, alive: Sequence[set[int]], path: Sequence[int]) -> Iterator[int]:
    layer = len(path)
    if layer == len(graph.states):
        return iter(())
    return (node for node in graph.successors[layer - 1][path[-1]] if node in alive[layer])


def _alive(graph: TraceGraph) -> list[set[int]]:
    """For each layer the nodes from which a goal can be reached."""
    alive = [set(graph.goals)]
    for successors in reversed(graph.successors):
        following = alive[-1]
        alive.append(
            {node for node, onward in enumerate(successors) if not following.isdisjoint(onward)}
        )
    return alive[::-1]


def all_traces(graph: TraceGraph, name: str, limit: int) -> Iterator[Trace]:
    """The traces of the first ``limit`` paths, named ``name-1``, ``name-2``, …."""
    for number, path in enumerate(islice(paths(graph), limit), 1):
        yield trace_of(graph, path, f"{name}-{number}")


def trace_of(graph: TraceGraph, path: Sequence[int], name: str) -> Trace:
    """The trace along a path."""
    states = tuple(states[node] for states, node in zip(graph.states, path, strict=True))
    return Trace(name, graph.step_s, graph.objects, states, graph.present)

"""A graph of traces times the rules' machines: which paths keep every rule, without walking them.

Two partial paths that end in the same node with every machine in the same state have the same
futures. So paths are counted per node and state, layer by layer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from operator import getitem
from typing import Any

from rulec.runtime.effects import LOST, Effect, Effects
from rulec.runtime.ways import Step
from rulec.trace import TraceGraph

Joint = tuple[int, ...]
"""The state of each instance's machine; SAFE where nothing can be lost any more."""

Memory = Any
"""What of a path's past bears on its future: a joint state, maybe with more; hashable."""

ProductNode = tuple[int, Memory]
"""A node's index in its layer, and the memory behind it."""

Enter = Callable[[Sequence[Effect], Memory], Memory | None]
"""The memory behind a node that has these effects; None if the path is dropped there."""


@dataclass(frozen=True, slots=True)
class Product:
    """The part of graph times memory that can be reached.

    ``counts[p]`` gives for each product node of layer ``p`` how many partial paths lead to it, and
    ``steps[p]`` its followers in layer ``p + 1`` with the cost of going there. Accepted are the
    paths that end in one of ``ends``.
    """

    graph: TraceGraph
    counts: tuple[dict[ProductNode, int], ...]
    steps: tuple[dict[ProductNode, list[tuple[ProductNode, int]]], ...]
    ends: frozenset[ProductNode]

    @property
    def accepted(self) -> int:
        """How many paths from start to a goal are accepted: exact."""
        return sum(self.counts[-1][end] for end in self.ends)


def count_paths(graph: TraceGraph) -> int:
    """How many paths lead from start to a goal: exact."""
    counts = {graph.start: 1}
    for successors in graph.successors:
        following: dict[int, int] = {}
        for node, count in counts.items():
            for target in successors[node]:
                following[target] = following.get(target, 0) + count
        counts = following
    return sum(counts.get(goal, 0) for goal in set(graph.goals))


def kept(effects: Sequence[Effect], joint: Joint) -> Joint | None:
    """The joint state after a node with these effects; None if a rule is lost there."""
    after = tuple(map(getitem, effects, joint))
    return None if LOST in after else after


def explore(effects: Effects, enter: Enter = kept, start: Memory | None = None) -> Product:
    """Build the product forward from the graph's start.

    Left to themselves, ``enter`` drops every path that loses a rule, and ``start``, the memory
    before the first node, is that of the machines.
    """
    graph = effects.graph
    first = effects.nodes[0][graph.start] if effects.starts else None
    memory = None if first is None else enter(first, effects.waiting if start is None else start)
    counts = [{} if memory is None else {(graph.start, memory): 1}]
    steps = []
    # Where nothing changes from layer to layer, nor do the ways on from there.
    known: dict[object, _Ways] = {}
    for rows, nodes in zip(effects.steps, effects.nodes[1:], strict=True):
        key = (id(rows), id(nodes), tuple(counts[-1]))
        if key not in known:
            known[key] = _ways(counts[-1], rows, nodes, enter)
        ways = known[key]
        totals = [0] * len(ways.targets)
        for count, indices in zip(counts[-1].values(), ways.into, strict=True):
            for index in indices:
                totals[index] += count
        counts.append(dict(zip(ways.targets, totals, strict=True)))
        steps.append(ways.steps)
    return Product(graph, tuple(counts), tuple(steps), frozenset(counts[-1]))


@dataclass(frozen=True, slots=True)
class _Ways:
    """From one layer's product nodes to the next one's: ``into`` are the targets' indices."""

    targets: list[ProductNode]
    into: list[list[int]]
    steps: dict[ProductNode, list[tuple[ProductNode, int]]]


def _ways(
    origins: Iterable[ProductNode],
    rows: Sequence[Sequence[Step]],
    nodes: Sequence[Sequence[Effect]],
    enter: Enter,
) -> _Ways:
    index_of: dict[ProductNode, int] = {}
    targets: list[ProductNode] = []
    entered: dict[Memory, dict[int, int | None]] = {}
    every = []
    steps = {}
    for origin in origins:
        node, memory = origin
        known = entered.setdefault(memory, {})
        into: list[int] = []
        reached: list[tuple[ProductNode, int]] = []
        for target, cost in rows[node]:
            if target not in known:
                after = enter(nodes[target], memory)
                known[target] = None
                if after is not None:
                    step = (target, after)
                    known[target] = index_of.setdefault(step, len(targets))
                    if len(index_of) > len(targets):
                        targets.append(step)
            at = known[target]
            if at is not None:
                into.append(at)
                reached.append((targets[at], cost))
        every.append(into)
        steps[origin] = reached
    return _Ways(targets, every, steps)

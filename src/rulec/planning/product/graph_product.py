"""Product of a trace graph and monitors, built forward layer by layer.

Two partial paths that end in the same node with every machine in the same state have the same
futures. So paths are counted per node and state, layer by layer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import getitem
from typing import Any

from rulec.planning.product.limits import room_for, too_many
from rulec.planning.product.node_transformers import LOST, Effect, NodeTransformers
from rulec.planning.product.reachability import Step
from rulec.trace import TraceGraph

Joint = tuple[int, ...]
"""The state of each instance's machine; SAFE where nothing can be lost any more."""

Memory = Any
"""What of a path's past bears on its future: a joint state, maybe with more; hashable."""

ProductNode = tuple[int, Memory]
"""A node's index in its layer, and the memory behind it."""

Enter = Callable[[Sequence[Effect], Memory], Memory | None]
"""The memory behind a node that has these effects; None if the path is dropped there."""

_Steps = dict[ProductNode, list[tuple[ProductNode, int]]]

_DROPPED = -1
"""In place of a target's index: no path goes on there. As an index it means one behind all."""


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """Edges of the product from one layer to ``targets`` in the next.

    Each of the ``origins`` has in ``into`` the index of the target that each follower of its node
    in ``rows`` leads to.
    """

    origins: list[ProductNode]
    rows: Sequence[Sequence[Step]]
    targets: list[ProductNode]
    into: list[list[int]]

    def steps(self) -> _Steps:
        """Successors of the product nodes of each layer, with costs."""
        return {
            origin: [
                (self.targets[at], cost)
                for at, (_, cost) in zip(into, self.rows[origin[0]], strict=True)
                if at != _DROPPED
            ]
            for origin, into in zip(self.origins, self.into, strict=True)
        }


@dataclass(frozen=True)
class Product:
    """The part of graph times memory that can be reached.

    ``counts[p]`` gives for each product node of layer ``p`` how many partial paths lead to it, and
    ``ways[p]`` leads on from there. Accepted are the paths that end in one of ``ends``.
    """

    graph: TraceGraph
    counts: tuple[dict[ProductNode, int], ...]
    ways: tuple[Ways, ...]
    ends: frozenset[ProductNode]

    @property
    def accepted(self) -> int:
        """Exact number of accepted paths from start to a goal."""
        return sum(self.counts[-1][end] for end in self.ends)

    @cached_property
    def steps(self) -> tuple[_Steps, ...]:
        """For the product nodes of each layer their followers in the next one, with costs."""
        different = {id(ways): ways for ways in self.ways}
        known = {which: ways.steps() for which, ways in different.items()}
        return tuple([known[id(ways)] for ways in self.ways])


def count_paths(graph: TraceGraph) -> int:
    """Exact number of paths from start to a goal."""
    counts = {graph.start: 1}
    for successors in graph.successors:
        following: dict[int, int] = {}
        for node, count in counts.items():
            for target in successors[node]:
                following[target] = following.get(target, 0) + count
        counts = following
    return sum(counts.get(goal, 0) for goal in set(graph.goals))


def kept(effects: Sequence[Effect], joint: Joint) -> Joint | None:
    """Joint state after a node; None if a rule is violated there."""
    after = tuple(map(getitem, effects, joint))
    return None if LOST in after else after


def explore(effects: NodeTransformers, enter: Enter = kept, start: Memory | None = None) -> Product:
    """Build the product forward from the graph's start.

    Left to themselves, ``enter`` drops every path that loses a rule, and ``start``, the memory
    before the first node, is that of the machines.

    Raises:
        RulecError: R0616 if it would be too large.
    """
    graph = effects.graph
    room = room_for(graph)
    first = effects.nodes[0][graph.start] if effects.starts else None
    memory = None if first is None else enter(first, effects.waiting if start is None else start)
    counts = [{} if memory is None else {(graph.start, memory): 1}]
    ways = []
    # Where nothing changes from one layer to the next, nor do the ways on from there.
    known: dict[tuple[int, int], Ways] = {}
    for rows, nodes in zip(effects.steps, effects.nodes[1:], strict=True):
        key, origins = (id(rows), id(nodes)), list(counts[-1])
        if key not in known or known[key].origins != origins:
            known[key] = _ways(origins, rows, nodes, enter, room)
        onward = known[key]
        room -= len(onward.targets)
        if room < 0:
            raise too_many(graph)
        # One more, in which paths come together that are dropped.
        totals = [0] * (len(onward.targets) + 1)
        for count, indices in zip(counts[-1].values(), onward.into, strict=True):
            for index in indices:
                totals[index] += count
        counts.append(dict(zip(onward.targets, totals, strict=False)))
        ways.append(onward)
    return Product(graph, tuple(counts), tuple(ways), frozenset(counts[-1]))


def _ways(
    origins: list[ProductNode],
    rows: Sequence[Sequence[Step]],
    nodes: Sequence[Sequence[Effect]],
    enter: Enter,
    room: int,
) -> Ways:
    """Edges from these product nodes, up to the limit."""
    targets: list[ProductNode] = []
    index_of: dict[ProductNode, int] = {}
    # By memory and node.
    entered: dict[Memory, dict[int, int]] = {}
    every = []
    for node, memory in origins:
        known = entered.get(memory)
        if known is None:
            known = entered[memory] = {}
        if len(targets) > room:
            break
        into: list[int] = []
        for target, _ in rows[node]:
            at = known.get(target)
            if at is None:
                after = enter(nodes[target], memory)
                if after is None:
                    at = _DROPPED
                else:
                    step = (target, after)
                    at = index_of.setdefault(step, len(targets))
                    if at == len(targets):
                        targets.append(step)
                known[target] = at
            into.append(at)
        every.append(into)
    return Ways(origins, rows, targets, every)

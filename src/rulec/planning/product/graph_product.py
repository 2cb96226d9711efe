"""Product of a trace graph and monitors, built forward layer by layer.

Two partial paths that end in the same node with every machine in the same state have the same
futures. So paths are counted per node and state, layer by layer.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import getitem
from typing import Generic, TypeVar

from rulec.diagnostics import RulecError
from rulec.planning.planning_messages import TOO_MANY_MANEUVERS
from rulec.planning.product.node_transformers import LOST, Effect, NodeTransformers, Step
from rulec.trace import TraceGraph
from rulec.trace.interned import Interned

MOST = 1 << 17
"""The most product nodes (kinds of partial paths) allowed, however small the graph."""

MOST_PER_NODE = 32
"""The most product nodes per graph node, if that allows more. Rules of law need less than one."""

Joint = tuple[int, ...]
"""The state of each instance's machine; SAFE where it can no longer be lost."""

Memory = TypeVar("Memory", bound=Hashable)
"""What a path's future depends on besides its node: a joint state, maybe with more."""

ProductNode = tuple[int, Memory]
"""A node's index in its layer, and the memory after it."""

Enter = Callable[[Sequence[Effect], Memory], Memory | None]
"""Gives the memory after a node with these effects; None if the path is dropped there."""

Steps = dict[ProductNode[Memory], list[tuple[ProductNode[Memory], int]]]
"""The successors of product nodes, with costs."""

_DROPPED = -1
"""Instead of a target's index: the path is dropped. As an index it is the extra last entry."""


@dataclass(frozen=True, slots=True, eq=False)
class ProductEdges(Generic[Memory]):
    """Edges of the product from one layer to ``targets`` in the next; identical layers share one.

    For each of the ``origins``, ``into`` has the index of the target that each successor of its
    node in ``rows`` leads to.
    """

    origins: list[ProductNode[Memory]]
    rows: Sequence[Sequence[Step]]
    targets: list[ProductNode[Memory]]
    into: list[list[int]]

    def steps(self) -> Steps[Memory]:
        """The successors of each product node, with costs."""
        return {
            origin: [
                (self.targets[at], cost)
                for at, (_, cost) in zip(into, self.rows[origin[0]], strict=True)
                if at != _DROPPED
            ]
            for origin, into in zip(self.origins, self.into, strict=True)
        }


@dataclass(frozen=True)
class Product(Generic[Memory]):
    """The reachable part of the product of graph and memory.

    ``counts[p]`` maps each product node of layer ``p`` to the number of partial paths that lead to
    it; ``ways[p]`` are the edges from there. Paths that end in one of ``ends`` are accepted.
    """

    graph: TraceGraph
    counts: tuple[dict[ProductNode[Memory], int], ...]
    ways: tuple[ProductEdges[Memory], ...]
    ends: frozenset[ProductNode[Memory]]

    @property
    def accepted(self) -> int:
        """Exact number of accepted paths from start to a goal."""
        return sum(self.counts[-1][end] for end in self.ends)

    @cached_property
    def steps(self) -> tuple[Steps[Memory], ...]:
        """For each layer the successors of its product nodes, with costs."""
        known = {ways: ways.steps() for ways in set(self.ways)}
        return tuple([known[ways] for ways in self.ways])


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


def kept(transformers: Sequence[Effect], joint: Joint) -> Joint | None:
    """The joint state after a node; None if a rule is violated there."""
    after = tuple(map(getitem, transformers, joint))
    return None if LOST in after else after


def explore(transformers: NodeTransformers) -> Product[Joint]:
    """Product of the paths that violate no rule. Raises R0616 if it would be too large."""
    return explore_with(transformers, kept, transformers.waiting)


def explore_with(
    transformers: NodeTransformers, enter: Enter[Memory], start: Memory
) -> Product[Memory]:
    """Build the product forward from the graph's start.

    ``start`` is the memory before the first node; ``enter`` gives the memory after each node.
    Raises RulecError: R0616 if it would be too large.
    """
    graph = transformers.graph
    remaining = largest_product(graph)
    first = transformers.nodes[0][graph.start] if transformers.starts else None
    memory = None if first is None else enter(first, start)
    counts = [{} if memory is None else {(graph.start, memory): 1}]
    ways = []
    # Consecutive layers with equal nodes and edges share their product edges.
    known: dict[object, ProductEdges[Memory]] = {}
    for rows, nodes in zip(transformers.steps, transformers.nodes[1:], strict=True):
        key, origins = (Interned(rows), Interned(nodes)), list(counts[-1])
        if key not in known or known[key].origins != origins:
            known[key] = _ways(origins, rows, nodes, enter, remaining)
        onward = known[key]
        remaining -= len(onward.targets)
        if remaining < 0:
            raise too_large(graph)
        # One extra entry, which collects the dropped paths.
        totals = [0] * (len(onward.targets) + 1)
        for count, indices in zip(counts[-1].values(), onward.into, strict=True):
            for index in indices:
                totals[index] += count
        counts.append(dict(zip(onward.targets, totals, strict=False)))
        ways.append(onward)
    return Product(graph, tuple(counts), tuple(ways), frozenset(counts[-1]))


def _ways(
    origins: list[ProductNode[Memory]],
    rows: Sequence[Sequence[Step]],
    nodes: Sequence[Sequence[Effect]],
    enter: Enter[Memory],
    remaining: int,
) -> ProductEdges[Memory]:
    targets: list[ProductNode[Memory]] = []
    index_of: dict[ProductNode[Memory], int] = {}
    # By memory and node.
    entered: dict[Memory, dict[int, int]] = {}
    every = []
    for node, memory in origins:
        known = entered.get(memory)
        if known is None:
            known = entered[memory] = {}
        if len(targets) > remaining:
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
    return ProductEdges(origins, rows, targets, every)


def largest_product(graph: TraceGraph) -> int:
    """The largest number of product nodes allowed for a graph."""
    return max(MOST, MOST_PER_NODE * sum(map(len, graph.states)))


def too_large(graph: TraceGraph) -> RulecError:
    """The error R0616: the product, which can be as large as that of all automata, is too large."""
    message = (
        f"these rules distinguish more than {largest_product(graph):,} kinds of partial "
        "maneuvers, by their place, the states of the automata, and the violations"
    )
    help_text = "take fewer rules at a time, a larger step, or the same weight for several rules"
    return TOO_MANY_MANEUVERS.error(None, message, help=help_text)


Edge = tuple[int, int]
"""A node of one layer, and a node of the next."""


@dataclass(frozen=True, slots=True)
class AcceptedEdges:
    """The nodes of each layer, and the edges between layers, that lie on paths.

    ``possible`` are on a path from the start to a goal, ``accepted`` on an accepted one.
    """

    possible_nodes: tuple[frozenset[int], ...]
    accepted_nodes: tuple[frozenset[int], ...]
    possible: tuple[frozenset[Edge], ...]
    accepted: tuple[frozenset[Edge], ...]


def accepted_edges(transformers: NodeTransformers, product: Product[Memory]) -> AcceptedEdges:
    """The edges on accepted and on possible paths of the product explored from a graph."""
    nodes = [
        frozenset(i for i, there in enumerate(row) if there) for row in transformers.on_the_way
    ]
    edges = [
        frozenset((node, target) for node in here for target, _ in rows[node])
        for here, rows in zip(nodes, transformers.steps, strict=False)
    ]
    ahead: frozenset[ProductNode[Memory]] | set[ProductNode[Memory]] = product.ends
    accepted_nodes = [frozenset(node for node, _ in ahead)]
    accepted = []
    for steps in reversed(product.steps):
        result = [
            (origin, target)
            for origin, onward in steps.items()
            for target, _ in onward
            if target in ahead
        ]
        accepted.append(frozenset((origin[0], target[0]) for origin, target in result))
        ahead = {origin for origin, _ in result}
        accepted_nodes.append(frozenset(node for node, _ in ahead))
    return AcceptedEdges(
        tuple(nodes), tuple(accepted_nodes[::-1]), tuple(edges), tuple(accepted[::-1])
    )

"""The cheapest paths that keep every rule, in order, found lazily."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise
from typing import TYPE_CHECKING

from rulec.planning.product.graph_product import Memory, Product, ProductNode
from rulec.trace import TraceGraph
from rulec.value_display import short_repr

if TYPE_CHECKING:
    from rulec.partition.motion.witness_trajectory import WitnessTrajectory


@dataclass(frozen=True, slots=True)
class Maneuver:
    """Path through a graph, with its cost and time margin.

    ``nodes`` are indices, one per layer; ``cost`` is in 1/s. ``margin_s`` is the smallest margin of
    its changes of cell; None if it never changes. If ego's motion has bounds, a ``trajectory``
    proves that the path can be driven; the cost is the trajectory's plus that of its ``changes``.
    """

    __repr__ = short_repr

    nodes: tuple[int, ...]
    cost: float
    margin_s: float | None
    changes: float | None = None
    trajectory: WitnessTrajectory | None = None


def cheapest(product: Product[Memory]) -> Iterator[Maneuver]:
    """Accepted paths by ascending cost, ties by ascending nodes.

    Best-first search. The remaining cost is known exactly for every product node, so a path is only
    ever extended towards a goal, and each next maneuver takes one pass through the layers.
    """
    graph = product.graph
    to_come = costs_to_come(product)
    queue: list[tuple[int, tuple[int, ...], int, ProductNode[Memory]]] = [
        (to_come[0][start], (start[0],), 0, start)
        for start in product.counts[0]
        if start in to_come[0]
    ]
    last = len(graph.states) - 1
    while queue:
        _, path, spent, here = heappop(queue)
        layer = len(path) - 1
        if layer == last:
            yield maneuver(graph, path, spent)
            continue
        for step, cost in product.steps[layer][here]:
            rest = to_come[layer + 1].get(step)
            if rest is not None:
                total = spent + cost
                heappush(queue, (total + rest, (*path, step[0]), total, step))


def costs_to_come(product: Product[Memory]) -> list[dict[ProductNode[Memory], int]]:
    """The least cost from each product node to a goal, by layer."""
    costs = [dict.fromkeys(product.ends, 0)]
    for steps in reversed(product.steps):
        later = costs[-1]
        here: dict[ProductNode[Memory], int] = {}
        for node, onward in steps.items():
            rest = [cost + later[step] for step, cost in onward if step in later]
            if rest:
                here[node] = min(rest)
        costs.append(here)
    return costs[::-1]


def maneuver(graph: TraceGraph, path: tuple[int, ...], cost: int) -> Maneuver:
    """A path as a maneuver, with its margin; ``cost`` is in the graph's unit."""
    margins = [
        graph.margins[layer][node][graph.successors[layer][node].index(target)]
        for layer, (node, target) in enumerate(pairwise(path))
    ]
    changes = [margin for margin in margins if margin is not None]
    margin_s = min(changes) * graph.step_s if changes else None
    return Maneuver(path, float(Fraction(cost) * graph.cost_unit), margin_s)

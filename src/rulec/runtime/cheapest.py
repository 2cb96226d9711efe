"""The cheapest paths that keep every rule, in order, found lazily."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import pairwise

from rulec.runtime.product import Product, ProductNode
from rulec.trace import TraceGraph


@dataclass(frozen=True, slots=True)
class Maneuver:
    """A path through the graph: the node's index in each layer, cost (1/s), time margin (s).

    ``margin_s`` is the smallest margin of its changes of cell; None if it never changes.
    """

    nodes: tuple[int, ...]
    cost: float
    margin_s: float | None


def cheapest(product: Product) -> Iterator[Maneuver]:
    """The accepted paths in ascending order of cost; equal costs in ascending order of nodes.

    Best-first search. The cost still to come is known exactly for every product node, so a path is
    only ever extended towards a goal, and each next maneuver costs one walk through the layers.
    """
    graph = product.graph
    to_come = _costs_to_come(product)
    queue: list[tuple[int, tuple[int, ...], int, ProductNode]] = [
        (to_come[0][start], (start[0],), 0, start)
        for start in product.counts[0]
        if start in to_come[0]
    ]
    last = len(graph.states) - 1
    while queue:
        _, path, spent, here = heappop(queue)
        layer = len(path) - 1
        if layer == last:
            yield _maneuver(graph, path, spent)
            continue
        for step in product.steps[layer][here]:
            rest = to_come[layer + 1].get(step)
            if rest is not None:
                cost = spent + _weight(graph, layer, here[0], step[0])
                heappush(queue, (cost + rest, (*path, step[0]), cost, step))


def _weight(graph: TraceGraph, layer: int, node: int, target: int) -> int:
    """The cost of the edge from ``node`` of ``layer`` to ``target``, in the graph's unit."""
    return graph.weights[layer][node][graph.successors[layer][node].index(target)]


def _costs_to_come(product: Product) -> list[dict[ProductNode, int]]:
    """For each layer the product nodes that a goal can be reached from, and at what least cost."""
    graph = product.graph
    goals = set(graph.goals)
    costs = [{node: 0 for node in product.counts[-1] if node[0] in goals}]
    for layer in reversed(range(len(product.steps))):
        here: dict[ProductNode, int] = {}
        for node, steps in product.steps[layer].items():
            onward = [
                costs[-1][step] + _weight(graph, layer, node[0], step[0])
                for step in steps
                if step in costs[-1]
            ]
            if onward:
                here[node] = min(onward)
        costs.append(here)
    return costs[::-1]


def _maneuver(graph: TraceGraph, path: tuple[int, ...], cost: int) -> Maneuver:
    margins = [
        graph.margins[layer][node][graph.successors[layer][node].index(target)]
        for layer, (node, target) in enumerate(pairwise(path))
    ]
    changes = [margin for margin in margins if margin is not None]
    margin_s = min(changes) * graph.step_s if changes else None
    return Maneuver(path, float(Fraction(cost) * graph.cost_unit), margin_s)

"""The edges on accepted paths of a graph, and those on other paths only."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.planning.product.graph_product import Memory, Product, ProductNode
from rulec.planning.product.node_transformers import NodeTransformers

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

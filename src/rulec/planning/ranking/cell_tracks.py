"""Cells followed through time, and a product's edges divided into staying and leaving."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from rulec.planning.product.graph_product import Memory, Product
from rulec.trace import TraceGraph

CellTracks = tuple[tuple[int, ...], ...]
"""For every layer and node the number of its place."""


def cell_tracks(graph: TraceGraph) -> CellTracks:
    """The place of every node.

    Nodes of consecutive layers are one place if the edge between them is staying and their states
    are the same. Places are numbered in the order in which they begin.
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


@dataclass(frozen=True, slots=True)
class TrackProduct:
    """Product nodes, numbered in the order of layers.

    ``nodes[i]`` is the node's index in layer ``layers[i]``, ``place[i]`` its place. ``stays[i]``
    are its successors in the same place with their costs, ``leaves[i]`` the others.
    """

    starts: tuple[int, ...]
    ends: frozenset[int]
    layers: tuple[int, ...]
    nodes: tuple[int, ...]
    place: tuple[int, ...]
    stays: tuple[tuple[tuple[int, int], ...], ...]
    leaves: tuple[tuple[tuple[int, int], ...], ...]

    def stayed(self, entered: Collection[int]) -> frozenset[int]:
        """The product nodes reachable without leaving the cell track."""
        reached, new = set(entered), list(entered)
        while new:
            for target, _ in self.stays[new.pop()]:
                if target not in reached:
                    reached.add(target)
                    new.append(target)
        return frozenset(reached)

    def left(self, here: Collection[int]) -> dict[int, set[int]]:
        """The product nodes reachable by one edge that leaves the track, by place."""
        entered: dict[int, set[int]] = {}
        for node in here:
            for target, _ in self.leaves[node]:
                entered.setdefault(self.place[target], set()).add(target)
        return entered


def track_product(product: Product[Memory], tracks: CellTracks) -> TrackProduct:
    """A product's nodes by place."""
    every = [(layer, node) for layer, counts in enumerate(product.counts) for node in counts]
    number = {node: i for i, node in enumerate(every)}
    place = [tracks[layer][node] for layer, (node, _) in every]
    last = len(product.steps)
    stays, leaves = [], []
    for here, (layer, node) in zip(place, every, strict=True):
        onward = [
            (number[layer + 1, target], cost)
            for target, cost in (product.steps[layer][node] if layer < last else ())
        ]
        stays.append(tuple([step for step in onward if place[step[0]] == here]))
        leaves.append(tuple([step for step in onward if place[step[0]] != here]))
    return TrackProduct(
        starts=tuple([number[0, start] for start in product.counts[0]]),
        ends=frozenset([number[last, end] for end in product.ends]),
        layers=tuple([layer for layer, _ in every]),
        nodes=tuple([node for _, (node, _) in every]),
        place=tuple(place),
        stays=tuple(stays),
        leaves=tuple(leaves),
    )

"""Product of graph and monitors, edges split by staying and leaving."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from rulec.planning.product.cell_tracks import CellTracks
from rulec.planning.product.graph_product import Memory, Product


@dataclass(frozen=True, slots=True)
class TrackProduct:
    """The product nodes as numbers, in the order of layers.

    ``nodes[i]`` is the node's index in layer ``layers[i]``, ``place[i]`` its place. ``stays[i]``
    are the followers of the same place with the costs of going there, ``leaves[i]`` the others.
    """

    starts: tuple[int, ...]
    ends: frozenset[int]
    layers: tuple[int, ...]
    nodes: tuple[int, ...]
    place: tuple[int, ...]
    stays: tuple[tuple[tuple[int, int], ...], ...]
    leaves: tuple[tuple[tuple[int, int], ...], ...]

    def stayed(self, entered: Collection[int]) -> frozenset[int]:
        """Product nodes reachable without leaving the cell track."""
        reached, new = set(entered), list(entered)
        while new:
            for target, _ in self.stays[new.pop()]:
                if target not in reached:
                    reached.add(target)
                    new.append(target)
        return frozenset(reached)

    def left(self, here: Collection[int]) -> dict[int, set[int]]:
        """By place where one can be directly after leaving."""
        entered: dict[int, set[int]] = {}
        for one in here:
            for target, _ in self.leaves[one]:
                entered.setdefault(self.place[target], set()).add(target)
        return entered


def track_product(product: Product[Memory], tracks: CellTracks) -> TrackProduct:
    """A product's nodes by place."""
    every = [(layer, node) for layer, counts in enumerate(product.counts) for node in counts]
    number = {node: i for i, node in enumerate(every)}
    place = [tracks[layer][node] for layer, (node, _) in every]
    last = len(product.steps)
    steps = [
        [
            (number[layer + 1, target], cost)
            for target, cost in (product.steps[layer][node] if layer < last else ())
        ]
        for layer, node in every
    ]
    return TrackProduct(
        starts=tuple([number[0, start] for start in product.counts[0]]),
        ends=frozenset([number[last, end] for end in product.ends]),
        layers=tuple([layer for layer, _ in every]),
        nodes=tuple([node for _, (node, _) in every]),
        place=tuple(place),
        stays=tuple(
            [
                tuple([step for step in row if place[step[0]] == here])
                for row, here in zip(steps, place, strict=True)
            ]
        ),
        leaves=tuple(
            [
                tuple([step for step in row if place[step[0]] != here])
                for row, here in zip(steps, place, strict=True)
            ]
        ),
    )

"""Homotopy classes: paths through the same cell tracks in the same order.

A class is a word of places; a path adds a letter to its word when it changes place. As for any
automaton, words are counted over the sets of product nodes that a word can lead to.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from operator import attrgetter

from rulec.planning.product.graph_product import Joint, Memory, Product, explore_with, kept
from rulec.planning.product.node_transformers import LOST, Effect, NodeTransformers
from rulec.planning.ranking.cell_tracks import CellTracks, TrackProduct, track_product
from rulec.planning.ranking.cheapest import Maneuver, costs_to_come, maneuver
from rulec.value_display import short_repr

REJECTED: Joint = (LOST,)
"""Instead of a joint state: a rule has been violated."""


@dataclass(frozen=True, slots=True)
class _Way:
    """The cheapest path to a product node, and the number of paths."""

    node: int
    before: _Way | None
    cost: int
    members: int


_Ways = dict[int, _Way]
"""For each product node that a class can lead to, its cheapest path and their number."""


@dataclass(frozen=True, slots=True)
class HomotopyClasses:
    """Numbers of homotopy classes by their members' verdicts.

    ``open`` of the ``rejected`` ones have a member that does not surely violate anything.
    """

    accepted: int
    rejected: int
    divided: int
    open: int = 0

    @property
    def total(self) -> int:
        """The number of all classes."""
        return self.accepted + self.rejected + self.divided

    @property
    def satisfying(self) -> int:
        """The number of classes with an accepted member."""
        return self.accepted + self.divided


@dataclass(frozen=True, slots=True)
class Variant:
    """A homotopy class with an accepted path, and its cheapest one.

    ``places`` are its cell tracks in order, ``members`` its number of accepted paths.
    """

    __repr__ = short_repr

    places: tuple[int, ...]
    members: int
    cheapest: Maneuver


def count_classes(transformers: NodeTransformers, tracks: CellTracks) -> HomotopyClasses:
    """The exact numbers of classes of all paths from start to a goal."""

    def enter(row: Sequence[Effect], memory: Joint) -> Joint:
        after = None if memory == REJECTED else kept(row, memory)
        return REJECTED if after is None else after

    product = explore_with(transformers, enter, transformers.waiting)
    tracked = track_product(product, tracks)
    # The ends have the last numbers.
    verdicts = [memory != REJECTED for _, memory in product.counts[-1]]
    first = len(tracked.nodes) - len(verdicts)
    accepted = frozenset(first + i for i, verdict in enumerate(verdicts) if verdict)
    ways: list[Counter[frozenset[int]]] = [Counter() for _ in transformers.nodes]
    if tracked.starts:
        ways[0][tracked.stayed(tracked.starts)] = 1
    counts: Counter[tuple[bool, bool]] = Counter()
    for layer in range(len(ways)):
        # A change of place leads to a later layer, so all ways to these sets are known.
        for here, words in ways[layer].items():
            ends = here & tracked.ends
            counts[not ends.isdisjoint(accepted), not ends <= accepted] += words
            for entered in tracked.left(here).values():
                later = min(tracked.layers[entry] for entry in entered)
                ways[later][tracked.stayed(entered)] += words
        ways[layer].clear()
    return HomotopyClasses(counts[True, False], counts[False, True], counts[True, True])


def variants(product: Product[Memory], tracks: CellTracks) -> Iterator[Variant]:
    """Classes with an accepted path, cheapest first, ties by tracks.

    Best-first search over words. The least remaining cost of a word's members is known exactly, so
    a word is only extended if a class needs it.
    """
    tracked = track_product(product, tracks)
    costs = costs_to_come(product)
    every = [(layer, node) for layer, counts in enumerate(product.counts) for node in counts]
    to_come = {
        i: costs[layer][node] for i, (layer, node) in enumerate(every) if node in costs[layer]
    }
    queue: list[tuple[int, tuple[int, ...], bool, _Ways]] = []

    def offer(word: tuple[int, ...], entered: _Ways) -> None:
        ways = _stayed(tracked, to_come, entered)
        bound = min(way.cost + to_come[node] for node, way in ways.items())
        heappush(queue, (bound, word, False, ways))

    for start in tracked.starts:
        if start in to_come:
            offer((tracked.place[start],), {start: _Way(start, None, 0, 1)})
    while queue:
        _, word, complete, ways = heappop(queue)
        if complete:
            yield _variant(product, tracked, word, ways)
            continue
        ends = {node: way for node, way in ways.items() if node in tracked.ends}
        if ends:
            heappush(queue, (min(way.cost for way in ends.values()), word, True, ends))
        entered: dict[int, _Ways] = {}
        for node, way in ways.items():
            for target, cost in tracked.leaves[node]:
                if target in to_come:
                    _join(entered.setdefault(tracked.place[target], {}), target, cost, way)
        for place, those in entered.items():
            offer((*word, place), those)


def _join(ways: _Ways, target: int, cost: int, way: _Way) -> None:
    """Extend paths to a product node: keep the cheapest, count all."""
    best = _Way(target, way, way.cost + cost, way.members)
    if target in ways:
        known = ways[target]
        cheaper = known if known.cost <= best.cost else best
        best = replace(cheaper, members=best.members + known.members)
    ways[target] = best


def _stayed(tracked: TrackProduct, to_come: Mapping[int, int], entered: _Ways) -> _Ways:
    """Extend a set of product nodes by all that are reachable within their track."""
    ways = dict(entered)
    waiting = list(entered)
    heapify(waiting)
    while waiting:
        # Numbers ascend with layers, so all ways to this one are known.
        node = heappop(waiting)
        for target, cost in tracked.stays[node]:
            if target in to_come:
                if target not in ways:
                    heappush(waiting, target)
                _join(ways, target, cost, ways[node])
    return ways


def _variant(
    product: Product[Memory], tracked: TrackProduct, word: tuple[int, ...], ends: _Ways
) -> Variant:
    best = min(ends.values(), key=attrgetter("cost"))
    nodes = []
    way: _Way | None = best
    while way is not None:
        nodes.append(tracked.nodes[way.node])
        way = way.before
    members = sum(way.members for way in ends.values())
    return Variant(word, members, maneuver(product.graph, tuple(nodes[::-1]), best.cost))

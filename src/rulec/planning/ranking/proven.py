"""The cheapest maneuvers with a trajectory that proves that ego can drive them.

Linear programs bound a path's cost from its beginning on. Paths are tried in the order of their
bounds until none can be cheaper than those found, or a limit on tries is reached.

A linear program bounds the driving cost of a path's beginning; the cost of its changes of cell, and
the least cost of those to come, are added. The beginning with the lowest bound is extended first.
Where that takes too long, a beam search reaches the end, but not always by the cheapest path.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterator
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from itertools import count, islice, pairwise
from math import inf
from typing import TYPE_CHECKING, Generic, TypeAlias

from rulec.partition import NavigationGraph
from rulec.partition.navigation_graph import COMFORTABLE
from rulec.planning.product.graph_product import Memory, Product, ProductNode
from rulec.planning.ranking.cheapest import Maneuver, cheapest, maneuver

if TYPE_CHECKING:
    from rulec.partition.motion.way_bounds import WayBound, WayBounds
    from rulec.partition.motion.witness_trajectory import WitnessSearch, WitnessTrajectory


MOST_TRIED = 40
"""The most paths tried for each maneuver wanted."""

MOST_BOUNDS, MORE_BOUNDS = 1_500, 100
"""The most beginnings of paths bounded, and how many more for each maneuver wanted."""

MOST_THOROUGH = 4
"""If no trajectory was found on any path, on so many of these it is looked for more thoroughly."""

BEAM = 16
"""The width of the beam search that follows where those were not enough."""


def proven(
    product: Product[Memory], n: int, graph: NavigationGraph, search: WitnessSearch
) -> list[Maneuver]:
    """The ``n`` cheapest accepted paths that can be driven, with their trajectories.

    If the search by bounds does not find that many, a beam search continues, and then the paths of
    least cost by their cells are tried.
    """
    maneuvers: list[Maneuver] = []
    looked_at: set[tuple[int, ...]] = set()
    unproved: list[Maneuver] = []
    promised: dict[tuple[int, ...], float] = {}
    ways = GuidedSearch(product, graph, search.bounds)
    for way in islice(ways.guided(MOST_BOUNDS + MORE_BOUNDS * n), MOST_TRIED * n):
        if len(maneuvers) >= n and way.promises >= maneuvers[n - 1].cost:
            break
        looked_at.add(way.maneuver.nodes)
        promised[way.maneuver.nodes] = way.promises
        driven = with_trajectory(way.maneuver, graph, search, way.promises + ALIKE)
        if driven is not None:
            insort(maneuvers, driven, key=_by_cost)
        else:
            unproved.append(way.maneuver)
    if len(maneuvers) < n:
        beam = (way.maneuver for way in ways.beam(max(BEAM, n)))
        by_cells = islice(cheapest(product), MOST_TRIED * n)
        for candidates in (beam, by_cells):
            for candidate in candidates if len(maneuvers) < n else ():
                if candidate.nodes not in looked_at:
                    looked_at.add(candidate.nodes)
                    driven = with_trajectory(candidate, graph, search)
                    if driven is not None:
                        insort(maneuvers, driven, key=_by_cost)
    if not maneuvers:
        found = ((one, search.by_sides(one.nodes)) for one in unproved[:MOST_THOROUGH])
        driven_ones = (_driven(one, way, graph) for one, way in found if way is not None)
        return [*islice(driven_ones, 1)]
    cheaper = [_cheaper(one, graph, search, promised.get(one.nodes, 0.0)) for one in maneuvers[:n]]
    return sorted([_evened(one, graph, search) for one in cheaper], key=_by_cost)


def _by_cost(maneuver: Maneuver) -> tuple[float, tuple[int, ...]]:
    return maneuver.cost, maneuver.nodes


def _cheaper(
    driven: Maneuver, graph: NavigationGraph, search: WitnessSearch, least: float
) -> Maneuver:
    """The maneuver with a cheaper trajectory, if one is found; it costs no less than ``least``."""
    known = driven.trajectory
    assert known is not None, "it is driven"
    if driven.cost <= least + ALIKE:
        return driven
    found = search.by_sides(driven.nodes, known.cost.total - known.cost.goal - ALIKE)
    if found is None or found.cost.total >= known.cost.total:
        return driven
    return _driven(driven, found, graph)


def _evened(driven: Maneuver, graph: NavigationGraph, search: WitnessSearch) -> Maneuver:
    """The maneuver with a trajectory that brakes no harder than it has to after its end."""
    known = driven.trajectory
    if known is None or known.greatest_braking <= COMFORTABLE:
        return driven
    found = search.evened(driven.nodes, known)
    return driven if found is known else _driven(driven, found, graph)


def with_trajectory(
    maneuver: Maneuver, graph: NavigationGraph, search: WitnessSearch, enough: float = inf
) -> Maneuver | None:
    """The maneuver with a trajectory, and the cost of both; None if no trajectory was found.

    The first one that makes it cost no more than ``enough`` will do.
    """
    trajectory = search.of(maneuver.nodes, enough - _changes(maneuver, graph))
    return None if trajectory is None else _driven(maneuver, trajectory, graph)


def _driven(maneuver: Maneuver, trajectory: WitnessTrajectory, graph: NavigationGraph) -> Maneuver:
    changes = _changes(maneuver, graph)
    cost = changes + trajectory.cost.total
    return replace(maneuver, cost=cost, changes=changes, trajectory=trajectory)


def _changes(maneuver: Maneuver, graph: NavigationGraph) -> float:
    """The cost of a path's changes of cell."""
    steps = enumerate(pairwise(maneuver.nodes))
    return sum(change_cost(graph, p, node, target) for p, (node, target) in steps)


def least_promised(
    product: Product[Memory], graph: NavigationGraph, bounds: WayBounds
) -> float | None:
    """The least driving cost of all accepted paths; None if that takes too long to find."""
    first = next(GuidedSearch(product, graph, bounds, driving_only=True).guided(MOST_BOUNDS), None)
    return None if first is None else max(first.promises - ALIKE, 0.0)


ALIKE = 0.01
"""Of beginnings whose bounds differ by less than this, the longest is extended first."""

_Costs: TypeAlias = list[dict[ProductNode[Memory], float]]


@dataclass(frozen=True, slots=True, eq=False)
class GuidedWay:
    """A path without its cost, and the lower bound that it ``promises``."""

    maneuver: Maneuver
    promises: float


@dataclass(frozen=True, slots=True, eq=False)
class _Part(Generic[Memory]):
    """A path's beginning up to a ``node``: the cost of its changes of cell, and its driving cost.

    The bound is that of the beginning without its last cell, unless ``is_known``.
    """

    path: tuple[int, ...]
    node: ProductNode[Memory]
    changes: float
    bound: WayBound | None
    is_known: bool

    def promises(self, to_come: _Costs[Memory]) -> float:
        driving = 0.0 if self.bound is None else self.bound.cost
        return self.changes + to_come[len(self.path) - 1][self.node] + driving

    def bounded(self, bounds: WayBounds) -> _Part[Memory] | None:
        """The part with its own bound; None if it cannot be driven."""
        bound = bounds.of(self.path, self.bound.cuts if self.bound else {})
        return None if bound is None else replace(self, bound=bound, is_known=True)


class GuidedSearch(Generic[Memory]):
    """A search for a product's paths by the lower bounds of their costs.

    Paths whose bound shows that they cannot be driven are left out. With ``driving_only`` changes
    of cell cost nothing.
    """

    def __init__(
        self,
        product: Product[Memory],
        graph: NavigationGraph,
        bounds: WayBounds,
        *,
        driving_only: bool = False,
    ) -> None:
        self._product, self._graph, self._bounds = product, graph, bounds
        self._is_free = driving_only
        self._to_come = self._changes_to_come()
        starts = [start for start in product.counts[0] if start in self._to_come[0]]
        self._starts = [_Part((one[0],), one, 0.0, None, is_known=True) for one in starts]

    def guided(self, most: int) -> Iterator[GuidedWay]:
        """Paths by ascending bound, up to ``ALIKE``, with at most ``most`` linear programs."""
        queue: list[tuple[int, int, float, int, _Part[Memory]]] = []
        numbers = count()

        def put(part: _Part[Memory]) -> None:
            promises = part.promises(self._to_come)
            layers = -len(part.path)
            heappush(queue, (int(promises / ALIKE), layers, promises, next(numbers), part))

        for start in self._starts:
            put(start)
        while queue:
            *_, part = heappop(queue)
            if not part.is_known:
                if not most:
                    return
                most -= 1
                known = part.bounded(self._bounds)
                if known is not None:
                    put(known)
            elif len(part.path) == len(self._graph.layers):
                yield self._way(part)
            else:
                for longer in self._onward(part):
                    put(longer)

    def beam(self, width: int) -> Iterator[GuidedWay]:
        """Paths found by extending, in every layer, only the ``width`` beginnings of lowest bound.

        Source: Lowerre, "The HARPY speech recognition system" (1976).
        """
        numbers = count()
        beam = self._starts
        for _ in self._product.steps:
            longer = [longer_part for part in beam for longer_part in self._onward(part)]
            queue = [(part.promises(self._to_come), next(numbers), part) for part in longer]
            heapify(queue)
            beam = []
            while queue and len(beam) < width:
                *_, part = heappop(queue)
                if part.is_known:
                    beam.append(part)
                elif (known := part.bounded(self._bounds)) is not None:
                    heappush(queue, (known.promises(self._to_come), next(numbers), known))
        yield from map(self._way, beam)

    def _way(self, part: _Part[Memory]) -> GuidedWay:
        found = maneuver(self._product.graph, part.path, 0)
        return GuidedWay(found, part.promises(self._to_come))

    def _onward(self, part: _Part[Memory]) -> Iterator[_Part[Memory]]:
        """The parts that are one cell longer."""
        layer = len(part.path) - 1
        for step, _ in self._product.steps[layer][part.node]:
            if step in self._to_come[layer + 1]:
                cost = self._change(layer, part.node[0], step[0])
                path = (*part.path, step[0])
                yield _Part(path, step, part.changes + cost, part.bound, is_known=False)

    def _change(self, p: int, node: int, target: int) -> float:
        return 0.0 if self._is_free else change_cost(self._graph, p, node, target)

    def _changes_to_come(self) -> _Costs[Memory]:
        """The least cost of changes of cell from each product node to a goal, by layer."""
        costs: _Costs[Memory] = [dict.fromkeys(self._product.ends, 0.0)]
        for p in reversed(range(len(self._product.steps))):
            later = costs[-1]
            here: dict[ProductNode[Memory], float] = {}
            known: dict[tuple[int, int], float] = {}
            for node, onward in self._product.steps[p].items():
                for step, _ in onward:
                    if step in later:
                        edge = node[0], step[0]
                        if edge not in known:
                            known[edge] = self._change(p, *edge)
                        here[node] = min(here.get(node, inf), known[edge] + later[step])
            costs.append(here)
        return costs[::-1]


def change_cost(graph: NavigationGraph, p: int, node: int, target: int) -> float:
    """The cost, by its margin, of going from a cell of layer ``p`` to one of the next."""
    margin = graph.margins[p][node][graph.successors[p][node].index(target)]
    if margin is None or graph.costs_nothing(p, node, target):
        return 0.0
    return 1 / (margin * graph.step_s)

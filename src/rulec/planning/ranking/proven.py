"""The cheapest maneuvers with a trajectory that proves that ego can drive them.

Linear programs bound a path's cost from its beginning on. Paths are tried in the order of their
bounds until none can be cheaper than those found, or a limit on tries is reached.
"""

from __future__ import annotations

from bisect import insort
from dataclasses import replace
from itertools import islice, pairwise
from math import inf
from typing import TYPE_CHECKING

from rulec.partition import NavigationGraph
from rulec.partition.navigation_graph import COMFORTABLE
from rulec.planning.product.graph_product import Memory, Product
from rulec.planning.ranking.cheapest import Maneuver, cheapest
from rulec.planning.ranking.guided_ways import ALIKE, beam_ways, change_cost, guided_ways

if TYPE_CHECKING:
    from rulec.partition.motion.way_bounds import WayBounds
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
    ways = guided_ways(product, graph, search.bounds, MOST_BOUNDS + MORE_BOUNDS * n)
    for way in islice(ways, MOST_TRIED * n):
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
        beam = beam_ways(product, graph, search.bounds, max(BEAM, n))
        by_cells = islice(cheapest(product), MOST_TRIED * n)
        for candidates in ((way.maneuver for way in beam), by_cells):
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
    ways = guided_ways(product, graph, bounds, MOST_BOUNDS, driving_only=True)
    first = next(ways, None)
    return None if first is None else max(first.promises - ALIKE, 0.0)

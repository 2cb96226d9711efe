"""The cheapest maneuvers of which a trajectory proves that ego can drive them.

What a path costs at least is known from its beginning on, by linear programs. Paths are looked at
in this order, until none can be cheaper than those found, or so many have been looked at.
"""

from __future__ import annotations

from bisect import insort
from dataclasses import replace
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from rulec.planning.product.graph_product import Memory, Product
from rulec.planning.ranking.cheapest import Maneuver, cheapest
from rulec.planning.ranking.guided_ways import ALIKE, beam_ways, change_cost, guided_ways

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.partition.motion.way_bounds import WayBounds
    from rulec.partition.motion.witness_trajectory import WitnessSearch

MOST_TRIED = 40
"""So many paths are looked at for each maneuver that is wanted."""

MOST_BOUNDS, MORE_BOUNDS = 1_500, 100
"""So many beginnings of paths, too, and so many more for each that is wanted."""

BEAM = 16
"""So many beginnings of each length go on where those were not enough."""


def proven(
    product: Product[Memory], n: int, graph: NavigationGraph, search: WitnessSearch
) -> list[Maneuver]:
    """The ``n`` cheapest accepted paths that can be driven, with their trajectories.

    Where bounds do not lead to so many, a beam search does; where that does not either, those are
    looked at that cost least by their cells.
    """
    maneuvers: list[Maneuver] = []
    looked_at: set[tuple[int, ...]] = set()
    ways = guided_ways(product, graph, search.bounds, MOST_BOUNDS + MORE_BOUNDS * n)
    for way in islice(ways, MOST_TRIED * n):
        if len(maneuvers) >= n and way.promises >= maneuvers[n - 1].cost:
            break
        looked_at.add(way.maneuver.nodes)
        _add(maneuvers, way.maneuver, graph, search)
    if len(maneuvers) < n:
        beam = beam_ways(product, graph, search.bounds, max(BEAM, n))
        by_cells = islice(cheapest(product), MOST_TRIED * n)
        for candidates in ((way.maneuver for way in beam), by_cells):
            for candidate in candidates if len(maneuvers) < n else ():
                if candidate.nodes not in looked_at:
                    looked_at.add(candidate.nodes)
                    _add(maneuvers, candidate, graph, search)
    return maneuvers[:n]


def _add(
    found: list[Maneuver], candidate: Maneuver, graph: NavigationGraph, search: WitnessSearch
) -> None:
    driven = with_trajectory(candidate, graph, search)
    if driven is not None:
        insort(found, driven, key=lambda maneuver: (maneuver.cost, maneuver.nodes))


def with_trajectory(
    maneuver: Maneuver, graph: NavigationGraph, search: WitnessSearch
) -> Maneuver | None:
    """The maneuver with a trajectory, and what both cost; None if none was found."""
    trajectory = search.of(maneuver.nodes)
    if trajectory is None:
        return None
    changes = sum(
        change_cost(graph, p, node, target)
        for p, (node, target) in enumerate(pairwise(maneuver.nodes))
    )
    cost = changes + trajectory.cost.total
    return replace(maneuver, cost=cost, changes=changes, trajectory=trajectory)


def least_promised(
    product: Product[Memory], graph: NavigationGraph, bounds: WayBounds
) -> float | None:
    """What driving costs at least on every accepted path; None if that takes too long to find."""
    ways = guided_ways(product, graph, bounds, MOST_BOUNDS, driving_only=True)
    first = next(ways, None)
    return None if first is None else max(first.promises - ALIKE, 0.0)

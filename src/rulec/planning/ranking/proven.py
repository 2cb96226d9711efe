"""The cheapest maneuvers of which a trajectory proves that ego can drive them.

What a path costs at least is known from its graph: what its changes of cell cost, and how far its
cells are from where ego would get at its speed. Paths are looked at in this order, until none can
be cheaper than those found, or ``MOST_TRIED`` have been looked at.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from rulec.partition.navigation_graph import COMFORTABLE
from rulec.planning.product.graph_product import Memory, Product
from rulec.planning.ranking.cheapest import Maneuver, cheapest

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.partition.motion.witness_trajectory import WitnessSearch

MOST_TRIED = 40
"""So many paths are looked at, and as many more for each maneuver that is wanted but one."""

MOST_SAMPLED, MORE_TRIED = 20, 120
"""Where none of them is comfortable so many of sampled motions, and so many further ones."""


def proven(
    product: Product[Memory], n: int, graph: NavigationGraph, search: WitnessSearch
) -> list[Maneuver]:
    """The ``n`` cheapest accepted paths that can be driven, with their trajectories.

    Where among those that cost least there are not so many, or none that is comfortable, sampled
    motions are followed, too.
    """
    found: list[Maneuver] = []
    candidates = cheapest(product)
    _add_of(islice(candidates, MOST_TRIED * n), found, n, graph, search)
    if len(found) < n or not comfortable(found):
        from rulec.planning.ranking.sampled_ways import sampled_ways  # NumPy, where it is needed

        known = {maneuver.nodes for maneuver in found}
        sampled = islice(sampled_ways(product, graph, search), MOST_SAMPLED)
        for candidate in sampled:
            if candidate.nodes not in known:
                _add(found, candidate, graph, search)
        _add_of(islice(candidates, MORE_TRIED), found, n, graph, search)
    return found[:n]


def _add_of(
    candidates: Iterator[Maneuver],
    found: list[Maneuver],
    n: int,
    graph: NavigationGraph,
    search: WitnessSearch,
) -> None:
    """Add those that are proved, until no other one can be among the cheapest."""
    known = {maneuver.nodes for maneuver in found}
    for candidate in candidates:
        if len(found) >= n and candidate.cost >= found[n - 1].cost:
            break
        if candidate.nodes not in known:
            _add(found, candidate, graph, search)


def _add(
    found: list[Maneuver], candidate: Maneuver, graph: NavigationGraph, search: WitnessSearch
) -> None:
    driven = with_trajectory(candidate, graph, search)
    if driven is not None:
        insort(found, driven, key=lambda maneuver: (maneuver.cost, maneuver.nodes))


def comfortable(found: Sequence[Maneuver]) -> bool:
    """Whether the first maneuver takes no more acceleration and braking than is usual."""
    own = found[0].trajectory if found else None
    return own is not None and max(own.greatest_acceleration, own.greatest_braking) <= COMFORTABLE


def with_trajectory(
    maneuver: Maneuver, graph: NavigationGraph, search: WitnessSearch
) -> Maneuver | None:
    """The maneuver with a trajectory, and what both cost; None if none was found."""
    trajectory = search.of(maneuver.nodes)
    if trajectory is None:
        return None
    changes = sum(
        1 / (margin * graph.step_s)
        for p, (node, target) in enumerate(pairwise(maneuver.nodes))
        if (margin := graph.margins[p][node][graph.successors[p][node].index(target)]) is not None
        and not graph.goes_on(p, node, target)
    )
    cost = changes + trajectory.cost.total
    return replace(maneuver, cost=cost, changes=changes, trajectory=trajectory)

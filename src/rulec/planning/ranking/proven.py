"""The cheapest maneuvers of which a trajectory proves that ego can drive them.

What a path costs at least is known from its graph: what its changes of cell cost, and how far its
cells are from where ego would get at its speed. Paths are looked at in this order, until none can
be cheaper than those found, or ``MOST_TRIED`` have been looked at.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from rulec.planning.ranking.cheapest import Maneuver

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.partition.motion.witness_trajectory import WitnessSearch

MOST_TRIED = 40
"""So many paths are looked at, and as many more for each maneuver that is wanted but one."""


def proven(
    candidates: Iterator[Maneuver], n: int, graph: NavigationGraph, search: WitnessSearch
) -> list[Maneuver]:
    """The ``n`` cheapest of the candidates that can be driven, with their trajectories.

    Candidates are in the order of what they cost at least.
    """
    found: list[Maneuver] = []
    for candidate in islice(candidates, MOST_TRIED * n):
        if len(found) >= n and candidate.cost >= found[n - 1].cost:
            break
        driven = with_trajectory(candidate, graph, search)
        if driven is not None:
            insort(found, driven, key=lambda maneuver: (maneuver.cost, maneuver.nodes))
    return found[:n]


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
    )
    cost = changes + trajectory.cost.total
    return replace(maneuver, cost=cost, changes=changes, trajectory=trajectory)

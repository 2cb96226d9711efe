"""The least braking on all paths through a scenario, where hard braking is needed."""

from __future__ import annotations

from dataclasses import replace

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.navigation_graph import COMFORTABLE, has_way_within

_WITHIN = 0.1
"""Precision (m/s²) of the result."""


def least_braking(graph: NavigationGraph) -> float | None:
    """The braking (m/s²) that every path of a graph needs at least; None if that is usual.

    It is proved by reachable sets, in which ego is a point, so the real minimum may be higher.
    """
    bounds = graph.bounds
    if bounds is None or not graph.leads_to_a_goal or bounds.braking <= COMFORTABLE:
        return None

    def is_enough(braking: float) -> bool:
        return has_way_within(graph, replace(bounds, braking=braking))

    least, enough = COMFORTABLE, bounds.braking
    if is_enough(least):
        return None
    while enough - least > _WITHIN:
        between = (least + enough) / 2
        least, enough = (least, between) if is_enough(between) else (between, enough)
    return least

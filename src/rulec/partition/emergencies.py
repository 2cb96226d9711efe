"""The least braking on all paths through a scenario, where hard braking is needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Reach
from rulec.partition.navigation_graph import COMFORTABLE, has_way_within, within
from rulec.scenario import MotionBounds

if TYPE_CHECKING:
    from rulec.partition.motion.others_beside import OthersBeside

_WITHIN = 0.1
"""Precision (m/s²) of the result."""


def least_braking(graph: NavigationGraph) -> float | None:
    """The braking (m/s²) that every path of a graph needs at least; None if that is usual.

    It is proved by reachable sets, in which ego is a point, so the real minimum may be higher.
    """
    return _least(graph, lambda bounds: has_way_within(graph, bounds))


def least_braking_later(graph: NavigationGraph, others: OthersBeside) -> float | None:
    """The same, if ego brakes after its end as well, until it is as slow as what is ahead then.

    An obstacle is ahead if ego's body would meet it wherever it may be in its cell; it keeps its
    speed. For reachable sets the least speed and the least way count, so that nobody needs less.
    """

    def is_enough(bounds: MotionBounds) -> bool:
        kept = within(graph, bounds)
        if not kept.leads_to_a_goal:
            return False
        ends = [kept.reach[-1][goal] for goal in kept.goals]
        return any(own is None or _is_slow_enough(own, others, bounds.braking) for own in ends)

    return _least(graph, is_enough)


def _least(graph: NavigationGraph, is_enough: Callable[[MotionBounds], bool]) -> float | None:
    bounds = graph.bounds
    if bounds is None or not graph.leads_to_a_goal or bounds.braking <= COMFORTABLE:
        return None
    least, enough = COMFORTABLE, bounds.braking
    if is_enough(replace(bounds, braking=least)):
        return None
    while enough - least > _WITHIN:
        between = (least + enough) / 2
        if is_enough(replace(bounds, braking=between)):
            enough = between
        else:
            least = between
    return least


def _is_slow_enough(own: Reach, others: OthersBeside, braking: float) -> bool:
    """Whether ego may become as slow as everything ahead of it by that braking (m/s²)."""
    length, width = others.body
    for name, (there, boxes) in others.boxes.items():
        rear, front, right, left = boxes[-1].tolist()
        in_way = right - width < own.d[0] and own.d[1] < left + width
        if there[-2:].all() and in_way and own.s[1] < front:
            room = max(rear - length - own.s[0], 0.0)
            faster = max(own.speed[0] - others.speed_at_end(name), 0.0)
            if faster**2 > 2 * braking * room:
                return False
    return True

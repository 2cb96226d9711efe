"""The road as rectangles with snapped coordinates.

The coordinates of all layers and instants go through one table, which merges those within
``EPSILON_M`` of each other into one number. After that two coordinates are either equal or clearly
different: there is no sliver between a lane's bound and a car that was computed to stand on it, and
no gap wider than ``EPSILON_M`` is lost.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rulec.scenario import Box, Road

EPSILON_M = 1e-6
"""Coordinates this close (m) are the same place; rounding errors are a hundred times smaller."""

CLEARANCE_M = 0.25
"""Ego's distance (m) from an obstacle that reaches into its lane, and from the lane's far bound."""

Snap = dict[float, float]


def snap_table(fixed: Iterable[float], moving: Iterable[float]) -> Snap:
    """Maps every coordinate to its representative, one of the road's (``fixed``) where possible."""
    ranked = sorted({*((value, 0) for value in fixed), *((value, 1) for value in moving)})
    table: Snap = {}
    group: list[tuple[float, int]] = []
    for item in ranked:
        if group and item[0] - group[0][0] > EPSILON_M:
            _represent(group, table)
            group = []
        group.append(item)
    _represent(group, table)
    return table


def snapped(box: Box, s: Snap, d: Snap) -> Box:
    """The box with snapped corners."""
    return Box(s[box.s_min], s[box.s_max], d[box.d_min], d[box.d_max])


def _represent(group: list[tuple[float, int]], table: Snap) -> None:
    if group:
        value = min(group, key=lambda item: (item[1], item[0]))[0]
        table.update((member, value) for member, _ in group)


@dataclass(frozen=True, slots=True)
class Roadway:
    """Outline, holes (missing lanes), crossings and lanes, all in snapped coordinates.

    ``free`` is the part of the outline where ego's centre may be.
    """

    outline: Box
    free: Box
    lanes: tuple[float, ...]
    holes: tuple[Box, ...]
    crossings: tuple[tuple[float, float], ...]

    def lanes_touched(self, body: Box) -> tuple[float, float] | None:
        """Bounds of the lanes that a body overlaps; None off the road."""
        touched = [
            (right, left)
            for right, left in zip(self.lanes, self.lanes[1:], strict=False)
            if self._is_on_lane(body, right, left)
        ]
        return (touched[0][0], touched[-1][1]) if touched else None

    def without_clear_part(
        self, lanes: tuple[float, float], body: Box, wide: Box
    ) -> tuple[float, float]:
        """Bounds of the lanes that a body touches, without the clear part of one it reaches into.

        A lane has a clear part if the body's middle is not in it, and ego can pass beside the body
        there. ``wide`` is the body widened by the room that ego's centre needs on either side.
        """
        right, left = lanes
        middle = (body.d_min + body.d_max) / 2
        needed = 2 * (wide.d_max - body.d_max) - EPSILON_M
        after_first = self.lanes[self.lanes.index(right) + 1]
        before_last = self.lanes[self.lanes.index(left) - 1]
        if middle > after_first and body.d_min - right >= needed:
            right = wide.d_min
        if middle < before_last and left - body.d_max >= needed:
            left = wide.d_max
        return right, left

    def crossing_touched(self, body: Box) -> tuple[float, float]:
        """Extent of a body in ``s``, widened to the crossings it overlaps."""
        low, high = body.s_min, body.s_max
        for start, end in self.crossings:
            if body.s_min < end and start < body.s_max:
                low, high = min(low, start), max(high, end)
        return low, high

    def _is_on_lane(self, body: Box, right: float, left: float) -> bool:
        if not body.overlaps(Box(self.outline.s_min, self.outline.s_max, right, left)):
            return False
        start, end = max(body.s_min, self.outline.s_min), min(body.s_max, self.outline.s_max)
        for hole in sorted(self.holes, key=lambda hole: hole.s_min):
            if hole.d_min == right:
                if start < hole.s_min:
                    return True
                start = max(start, hole.s_max)
        return start < end


def roadway(road: Road, free: Box, s: Snap, d: Snap) -> Roadway:
    """Road with every coordinate snapped."""
    return Roadway(
        snapped(road.outline, s, d),
        snapped(free, s, d),
        tuple(d[bound] for bound in road.lanes),
        tuple(snapped(hole, s, d) for hole in road.holes()),
        tuple(
            (s[stretch.s[0]], s[stretch.s[1]])
            for stretch in road.surfaces
            if stretch.surface == "crossing"
        ),
    )

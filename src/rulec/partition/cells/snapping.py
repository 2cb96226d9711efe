"""Snapping of coordinates, which makes comparisons exact.

Every coordinate of every layer and instant goes through one table: those within ``EPSILON_M`` of
each other become one number. After that two coordinates are either the same or clearly apart; no
sliver appears between a lane's bound and a car that was computed to stand on it, and no gap wider
than ``EPSILON_M`` is lost.
"""

from __future__ import annotations

from collections.abc import Iterable

from rulec.scenario import Box

EPSILON_M = 1e-6
"""Coordinates this close (m) are one place; rounding errors are a hundred times smaller."""

Snap = dict[float, float]


def snap_table(fixed: Iterable[float], moving: Iterable[float]) -> Snap:
    """Representative of every coordinate, a ``fixed`` one where possible.

    Those of the road are fixed.
    """
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
    """The box with its corners replaced."""
    return Box(s[box.s_min], s[box.s_max], d[box.d_min], d[box.d_max])


def _represent(group: list[tuple[float, int]], table: Snap) -> None:
    if group:
        value = min(group, key=lambda item: (item[1], item[0]))[0]
        table.update((member, value) for member, _ in group)

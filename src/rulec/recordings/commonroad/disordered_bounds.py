"""Puts points of bounds in order, which some map converters write out of order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from rulec.recordings.recording import Lanelet, Points

_BACK_M = 2.0
"""Shorter steps back along a bound are careless drawing, and make it hardly longer."""

_SHARP = -0.5
"""The cosine of the angle beyond which a bound turns back; no lane turns as much at one point."""

_HAIR_M = 1e-6
_MOST_POINTS, _MOST_PASSES = 100, 10
"""Converters that disorder points do not write more; the time of a pass grows with their square."""


def with_ordered_bounds(
    lanelets: Mapping[str, Lanelet],
) -> tuple[dict[str, Lanelet], tuple[str, ...]]:
    """Lanelets by id with the points of their bounds in order, and the ids of those changed."""
    disordered = _going_back(
        [bound for own in lanelets.values() for bound in (own.left, own.right)]
    )
    ordered = dict(lanelets)
    names, changed = tuple(lanelets), []
    for name in dict.fromkeys(names[place // 2] for place in disordered):
        lanelet = lanelets[name]
        left, right = in_order(lanelet.left), in_order(lanelet.right)
        if left is not lanelet.left or right is not lanelet.right:
            ordered[name] = replace(lanelet, left=left, right=right, centre=0.5 * (left + right))
            changed.append(name)
    return ordered, tuple(changed)


def in_order(points: Points) -> Points:
    """The points in an order that makes the line through them short; the first and last one stay.

    Each inner point is moved to where the line becomes shortest (the *or-opt* move of Or, 1976, for
    one point), until it gets no shorter. A line that nowhere turns back is left as it is, and so is
    one of more than ``_MOST_POINTS``.
    """
    if len(points) > _MOST_POINTS or not _going_back([points]):
        return points
    order = list(range(len(points)))
    for _ in range(_MOST_PASSES):
        is_shorter = False
        for point in range(1, len(points) - 1):
            rest = [x for x in order if x != point]
            line = points[rest]
            gaps = np.hypot(*np.diff(line, axis=0).T)
            ways = np.hypot(*(line - points[point]).T)
            longer = ways[:-1] + ways[1:] - gaps
            at = order.index(point)
            best = int(longer.argmin()) + 1
            if longer[best - 1] < longer[at - 1] - _HAIR_M:
                order, is_shorter = [*rest[:best], point, *rest[best:]], True
        if not is_shorter:
            break
    return points[order]


def _going_back(bounds: Iterable[Points]) -> list[int]:
    """The indices of the bounds that turn back on themselves, once for each point where they do."""
    bounds = list(bounds)
    if not bounds:
        return []
    number = np.arange(len(bounds)).repeat([len(bound) for bound in bounds])
    ways = np.diff(np.concatenate(bounds), axis=0)
    lengths = np.hypot(*ways.T)
    lengths[number[1:] != number[:-1]] = 0.0
    before, after = lengths[:-1], lengths[1:]
    is_long = np.minimum(before, after) > _BACK_M
    turns = (ways[:-1] * ways[1:]).sum(axis=1)
    going_back: list[int] = number[1:-1][is_long & (turns < _SHARP * before * after)].tolist()
    return going_back

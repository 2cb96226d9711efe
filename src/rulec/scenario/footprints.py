"""The place of an obstacle that footprints describe at some times."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator

from rulec.scenario.geometry import Box
from rulec.scenario.scenario_model import Footprints


def bounds_within(motion: Footprints, start: float, end: float) -> Box | None:
    """The bounds of the space occupied from ``start`` to ``end`` (s).

    None if nothing is occupied.
    """
    boxes = list(_boxes(motion, start, end))
    if not boxes:
        return None
    return Box(
        min(box.s_min for box in boxes),
        max(box.s_max for box in boxes),
        min(box.d_min for box in boxes),
        max(box.d_max for box in boxes),
    )


def displacements(motion: Footprints) -> tuple[tuple[float, float, float, float], ...]:
    """The movements of the middle along and across the road.

    Each has its first and last time, then its way along and across.
    """
    steps = []
    for k in range(len(motion.times) - 1):
        before, after = motion.boxes[k : k + 2]
        if before is not None and after is not None:
            ahead, left = _shift(before, after)
            if (ahead, left) != (0.0, 0.0):
                steps.append((motion.times[k], motion.times[k + 1], ahead, left))
    return tuple(steps)


def displacement_within(motion: Footprints, start: float, end: float) -> tuple[float, float]:
    """The displacement of the middle between two times (s).

    It is along and across the road.
    """
    boxes = list(_boxes(motion, start, end))
    return _shift(boxes[0], boxes[-1]) if boxes else (0.0, 0.0)


def _shift(before: Box, after: Box) -> tuple[float, float]:
    return (
        (after.s_min + after.s_max - before.s_min - before.s_max) / 2,
        (after.d_min + after.d_max - before.d_min - before.d_max) / 2,
    )


def _boxes(motion: Footprints, start: float, end: float) -> Iterator[Box]:
    """The footprints at both times and at all known times between."""
    times = motion.times
    first, last = bisect_left(times, start), bisect_right(times, end)
    ends = (_at(motion, start), *motion.boxes[first:last], _at(motion, end))
    return (box for box in ends if box is not None)


def _at(motion: Footprints, time: float) -> Box | None:
    times, boxes = motion.times, motion.boxes
    after = bisect_left(times, time)
    if after == len(times):
        return None
    if times[after] == time:
        return boxes[after]
    earlier, later = (boxes[after - 1], boxes[after]) if after else (None, None)
    if earlier is None or later is None:
        return None
    part = (time - times[after - 1]) / (times[after] - times[after - 1])
    return Box(
        earlier.s_min + part * (later.s_min - earlier.s_min),
        earlier.s_max + part * (later.s_max - earlier.s_max),
        earlier.d_min + part * (later.d_min - earlier.d_min),
        earlier.d_max + part * (later.d_max - earlier.d_max),
    )

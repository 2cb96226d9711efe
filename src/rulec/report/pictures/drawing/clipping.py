"""Clip rings and lines to a rectangle (Sutherland and Hodgman 1974; Liang and Barsky 1984)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from rulec.report.pictures.drawing.canvas import Point, Rectangle


def clipped_ring(ring: Sequence[Point], box: Rectangle) -> tuple[Point, ...]:
    """The part of a ring within a rectangle; empty if there is none."""
    points = list(ring)
    for side, limit in enumerate(box):
        axis, sign = side % 2, 1 if side < 2 else -1
        kept: list[Point] = []
        for before, point in pairwise([*points[-1:], *points]):
            inside = sign * (point[axis] - limit) >= 0
            if inside != (sign * (before[axis] - limit) >= 0):
                part = (limit - before[axis]) / (point[axis] - before[axis])
                kept.append(_between(before, point, part))
            if inside:
                kept.append(point)
        points = kept
    return tuple(points)


def clipped_lines(line: Sequence[Point], box: Rectangle) -> Iterator[tuple[Point, ...]]:
    """The parts of a line within a rectangle."""
    run: list[Point] = []
    for before, point in pairwise(line):
        low, high = _inside(before, point, box)
        if low >= high:
            continue
        start = _between(before, point, low)
        if run and run[-1] != start:
            yield tuple(run)
            run = []
        run = [*(run or [start]), _between(before, point, high)]
    if run:
        yield tuple(run)


def _inside(start: Point, end: Point, box: Rectangle) -> tuple[float, float]:
    """The part of a segment inside the box, as fractions from and to; nothing if from >= to."""
    low, high = 0.0, 1.0
    for side, limit in enumerate(box):
        axis, sign = side % 2, 1 if side < 2 else -1
        depth, change = sign * (start[axis] - limit), sign * (end[axis] - start[axis])
        if change == 0:
            high = high if depth >= 0 else -1.0
        elif change > 0:
            low = max(low, -depth / change)
        else:
            high = min(high, -depth / change)
    return low, high


def _between(start: Point, end: Point, part: float) -> Point:
    if part in (0, 1):
        return end if part else start
    return start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])

"""A point in each of the cells into which lines divide a rectangle, computed exactly.

The rectangle's faces (its interior, its edges without their ends, its corners) are cut by one line
after the other, each into the parts below the line, on it, and above it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations, product
from typing import NamedTuple, TypeAlias

Corner: TypeAlias = tuple[Fraction, Fraction]
Range: TypeAlias = tuple[Fraction, Fraction]
_Face: TypeAlias = tuple[Corner, ...]
"""A convex face, given by its corners in order.

They do not belong to it, except to a single point.
"""


class PlanarLine(NamedTuple):
    """The points where ``x * point[0] + y * point[1]`` equals ``limit``."""

    x: Fraction
    y: Fraction
    limit: Fraction

    def beyond(self, point: Corner) -> Fraction:
        """By how much the sum exceeds the limit."""
        return self.x * point[0] + self.y * point[1] - self.limit


def points_of_cells(
    ranges: tuple[Range | None, Range | None], lines: Sequence[PlanarLine], most: int
) -> list[Corner] | None:
    """A point in every cell of a closed rectangle; parts on a line are cells, too.

    A range that is None is unbounded. None if there are more cells than ``most``.
    """
    faces: list[tuple[tuple[int, ...], _Face]]
    faces = [((), face) for face in _faces(*_closed(ranges, lines))]
    for line in lines:
        beyond = cache(line.beyond)
        faces = [
            ((*sides, side), part) for sides, face in faces for side, part in _parts(face, beyond)
        ]
        # A cell may also have faces on the rectangle's edges.
        if len(faces) > 8 * most:
            return None
    cells = dict(faces)  # the last face of each
    if len(cells) > most:
        return None
    return [(_mean([x for x, _ in face]), _mean([y for _, y in face])) for face in cells.values()]


def _mean(numbers: Sequence[Fraction]) -> Fraction:
    return sum(numbers, Fraction(0)) / len(numbers)


def _faces(first: Range, second: Range) -> Iterator[_Face]:
    for across, up in product(_faces_of_range(first), _faces_of_range(second)):
        below, *above = [tuple([(x, y) for x in across]) for y in up]
        yield below + tuple(point for row in above for point in reversed(row))


def _faces_of_range(ends: Range) -> list[tuple[Fraction, ...]]:
    low, high = ends
    return [(low,)] if low == high else [(low,), (high,), (low, high)]


def _parts(face: _Face, beyond: Callable[[Corner], Fraction]) -> list[tuple[int, _Face]]:
    """The parts of a face below a line (-1), on it (0) and above it (1)."""
    heights = [beyond(corner) for corner in face]
    is_below, is_above = min(heights) < 0, max(heights) > 0
    if not (is_below and is_above):
        return [(is_above - is_below, face)]
    below: list[Corner] = []
    on_line: list[Corner] = []
    above: list[Corner] = []
    for n, (corner, height) in enumerate(zip(face, heights, strict=True)):
        if height <= 0:
            below.append(corner)
        if height >= 0:
            above.append(corner)
        if height == 0:
            on_line.append(corner)
        after = (n + 1) % len(face)
        if height * heights[after] < 0 and (len(face) > 2 or after > n):
            share = height / (height - heights[after])
            (x, y), (to_x, to_y) = corner, face[after]
            crossing = x + share * (to_x - x), y + share * (to_y - y)
            for part in (below, on_line, above):
                part.append(crossing)
    return [(-1, tuple(below)), (0, tuple(on_line)), (1, tuple(above))]


def _closed(
    ranges: tuple[Range | None, Range | None], lines: Sequence[PlanarLine]
) -> tuple[Range, Range]:
    """The ranges; unbounded ones are made wide enough to meet every cell.

    Each cell has a point where two lines (or edges) cross or, if all are parallel, has a line
    beside it; so it suffices that such points lie inside.
    """
    across, up = ranges
    if across is not None and up is not None:
        return across, up
    unit, none = Fraction(1), Fraction(0)
    edges = [PlanarLine(unit, none, end) for end in across or ()]
    edges += [PlanarLine(none, unit, end) for end in up or ()]
    drawn = [line for line in (*lines, *edges) if line.x or line.y]
    points = [(none, none), *map(_nearest_to_origin, drawn)]
    points += [x for pair in combinations(drawn, 2) if (x := crossing(*pair)) is not None]
    return across or _around([x for x, _ in points]), up or _around([y for _, y in points])


def _around(numbers: Sequence[Fraction]) -> Range:
    return min(numbers) - 1, max(numbers) + 1


def _nearest_to_origin(line: PlanarLine) -> Corner:
    share = line.limit / (line.x**2 + line.y**2)
    return share * line.x, share * line.y


def crossing(first: PlanarLine, second: PlanarLine) -> Corner | None:
    """The point where two lines cross (Cramer's rule); None if they are parallel."""
    area = first.x * second.y - second.x * first.y
    if not area:
        return None
    x = first.limit * second.y - second.limit * first.y
    y = first.x * second.limit - second.x * first.limit
    return x / area, y / area

"""A point in each of the cells into which hyperplanes divide a box, computed exactly.

A cell's closure is held by what generates it: in homogeneous coordinates it is a cone of lines and
rays, and one plane after the other cuts it (the double description method: T. S. Motzkin et al.,
"The double description method", 1953). All coordinates are whole numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import reduce
from itertools import product
from math import gcd, lcm
from operator import and_, mul
from typing import NamedTuple, TypeAlias

Vector: TypeAlias = tuple[int, ...]
"""Coordinates, the last of which divides all others; where it is zero, a direction."""

Range: TypeAlias = tuple[Fraction, Fraction]

_FIRST_FACE = 2
"""The bit of a box's first face, after that of infinity, on which all directions lie."""


class _Ray(NamedTuple):
    """A ray of a cone, and the planes and faces of the box, as bits, on which it lies."""

    vector: Vector
    on: int


class _Cell(NamedTuple):
    """The lines and rays of a cell's closure, and the planes, as bits, on which the cell lies."""

    lines: Sequence[Vector]
    rays: Sequence[_Ray]
    on: int = 0


def points_of_cells(
    ranges: Sequence[Range | None], planes: Sequence[Sequence[Fraction]], most: int
) -> list[tuple[Fraction, ...]] | None:
    """A point in every cell of a closed box; parts on a plane are cells, too.

    A range that is None is unbounded. A plane has a factor for each number, then the limit that the
    weighted sum of the numbers equals. None if there are more cells than ``most``, or if they have
    more corners than so many cells usually do.
    """
    cells = [_whole(ranges)]
    bit = _FIRST_FACE << 2 * len(ranges)
    faces = bit - _FIRST_FACE
    for *factors, limit in planes:
        plane = _scaled([*factors, -limit])
        cells = [part for cell in cells for part in _parts(cell, plane, bit, faces)]
        bit <<= 1
        if len(cells) > most or sum(len(cell.rays) ** 2 for cell in cells) > 64 * most:
            return None
    return [_inside(cell) for cell in cells]


def _whole(ranges: Sequence[Range | None]) -> _Cell:
    """The box."""
    ends: list[dict[Fraction, int]] = []
    for place, range_ in enumerate(ranges):
        low, high = range_ or (Fraction(0), Fraction(0))
        bit = _FIRST_FACE << 2 * place
        ends.append({low: bit, high: 2 * bit} if low < high else {low: 3 * bit})
    rays = [
        _Ray(_scaled([*[end for end, _ in corner], Fraction(1)]), sum(on for _, on in corner))
        for corner in product(*[own.items() for own in ends])
    ]
    free = [place for place, range_ in enumerate(ranges) if range_ is None]
    return _Cell([tuple([int(n == place) for n in range(len(ranges) + 1)]) for place in free], rays)


def _parts(cell: _Cell, plane: Vector, bit: int, faces: int) -> Iterator[_Cell]:
    """The parts of a cell below a plane, on it, and above it, as far as there are any.

    ``bit`` is that of the plane; those of all planes before, and of ``faces``, are lower.
    """
    heights = [_height(line, plane) for line in cell.lines]
    crossing = next((place for place, height in enumerate(heights) if height), None)
    if crossing is not None:
        up = cell.lines[crossing] if heights[crossing] > 0 else _opposite(cell.lines[crossing])
        lines = [_moved(x, up, plane) for n, x in enumerate(cell.lines) if n != crossing]
        rays = [_Ray(_moved(ray.vector, up, plane), ray.on | bit) for ray in cell.rays]
        for end in (_opposite(up), up):
            # A line lies on all planes and faces before
            yield _Cell(lines, [*rays, _Ray(end, bit - 1)], cell.on)
        yield _Cell(lines, rays, cell.on | bit)
        return
    ranked = [(_height(ray.vector, plane), ray) for ray in cell.rays]
    below = [(height, ray) for height, ray in ranked if height < 0]
    above = [(height, ray) for height, ray in ranked if height > 0]
    on = [_Ray(ray.vector, ray.on | bit) for height, ray in ranked if not height]
    for (down, low), (up_, high) in product(below, above):
        shared = low.on & high.on
        # Only an edge of the cone crosses the plane in a ray of the part on it
        if sum(ray.on & shared == shared for ray in cell.rays) == 2:
            pairs = zip(low.vector, high.vector, strict=True)
            on.append(_Ray(_reduced([x * up_ - y * down for x, y in pairs]), shared | bit))
    for side in (below, above):
        if side:
            yield _Cell(cell.lines, [*[ray for _, ray in side], *on], cell.on)
    # Of a part that only touches, a plane before or infinity may leave nothing
    if on and reduce(and_, [ray.on for ray in on]) & ~faces == cell.on | bit:
        yield _Cell(cell.lines, on, cell.on | bit)


def _height(vector: Vector, plane: Vector) -> int:
    return sum(map(mul, vector, plane))


def _moved(vector: Vector, along: Vector, plane: Vector) -> Vector:
    """The vector, moved along one that rises above a plane until it is on the plane."""
    rise, height = _height(along, plane), _height(vector, plane)
    return _reduced([x * rise - y * height for x, y in zip(vector, along, strict=True)])


def _opposite(vector: Vector) -> Vector:
    return tuple([-x for x in vector])


def _scaled(numbers: Sequence[Fraction]) -> Vector:
    scale = lcm(*[x.denominator for x in numbers])
    return tuple([int(x * scale) for x in numbers])


def _reduced(vector: Sequence[int]) -> Vector:
    divisor = gcd(*vector) or 1
    return tuple([x // divisor for x in vector])


def _inside(cell: _Cell) -> tuple[Fraction, ...]:
    """A point that lies on no other planes or faces than the whole cell."""
    *point, scale = map(sum, zip(*[ray.vector for ray in cell.rays], strict=True))
    return tuple([Fraction(x, scale) for x in point])

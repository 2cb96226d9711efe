"""Adjacency of a plane's cells, and their continuation in the next layer.

Adjacency has three definitions:

- ``touch``: the closures of the cells meet, a corner is enough (paper, section V-B, after Altché
  and de La Fortelle).
- ``edge``: they share a border of positive length.
- ``forward``: they share such a border, and it can be crossed sideways or ahead. A neighbour that
  can only be entered backwards, across borders at which it has the smaller ``s``, is excluded.

A cell of layer p continues as one of layer p + 1 if both overlap one cell of the plane at the
instant between them, with the obstacles where they are at that moment.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Literal

from rulec.partition.cells.cell_model import Plane, Row

AdjacencyName = Literal["touch", "edge", "forward"]

Links = tuple[frozenset[int], ...]
"""For each cell of one plane, a set of cells of another plane."""


def neighbours(plane: Plane, adjacency: AdjacencyName) -> tuple[tuple[int, ...], ...]:
    """The adjacent cells of every cell, ascending, without the cell itself."""
    beside: list[set[int]] = [set() for _ in plane.cells]
    for row in plane.rows:
        for behind, ahead in pairwise(row.runs):
            if behind.s_max == ahead.s_min:
                beside[behind.cell].add(ahead.cell)
                if adjacency != "forward":
                    beside[ahead.cell].add(behind.cell)
    for right, left in pairwise(plane.rows):
        for i, j in _side_by_side(right, left, corners=adjacency == "touch"):
            beside[i].add(j)
            beside[j].add(i)
    return tuple(tuple(sorted(cells - {i})) for i, cells in enumerate(beside))


def _side_by_side(row: Row, other: Row, *, corners: bool = False) -> Iterator[tuple[int, int]]:
    """Pairs of cells whose runs share an interval of ``s``; with ``corners`` a point is enough."""
    start = 0
    for run in row.runs:
        while start < len(other.runs) and other.runs[start].s_max < run.s_min:
            start += 1
        for index in range(start, len(other.runs)):
            opposite = other.runs[index]
            if opposite.s_min > run.s_max:
                break
            if corners or (opposite.s_min < run.s_max and run.s_min < opposite.s_max):
                yield run.cell, opposite.cell


def continuations(before: Plane, instant: Plane, after: Plane) -> Links:
    """Cells of ``after`` that continue each cell of ``before``."""
    onward = overlaps(instant, after)
    return tuple(
        frozenset().union(*(onward[i] for i in cells)) for cells in overlaps(before, instant)
    )


def overlaps(plane: Plane, later: Plane) -> Links:
    """Cells of ``later`` that share area with each cell of ``plane``."""
    links: list[set[int]] = [set() for _ in plane.cells]
    for row in plane.rows:
        for across in later.rows:
            if row.d_min < across.d_max and across.d_min < row.d_max:
                for i, j in _side_by_side(row, across):
                    links[i].add(j)
    return tuple(map(frozenset, links))


def inverse(links: Links, size: int) -> Links:
    """The reverse links, for ``size`` cells."""
    origins: list[set[int]] = [set() for _ in range(size)]
    for i, cells in enumerate(links):
        for j in cells:
            origins[j].add(i)
    return tuple(map(frozenset, origins))

"""Adjacency of the cells of a plane.

- ``touch``: their closures meet, a corner is enough (paper, section V-B, after Altché and de La
  Fortelle).
- ``edge``: they share a border of positive length.
- ``forward``: they share such a border, and it can be crossed sideways or ahead. A neighbour that
  can only be entered backwards, across borders at which it has the smaller ``s``, lies only behind.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

from rulec.partition.cells.cell_model import Plane, Row

AdjacencyName = Literal["touch", "edge", "forward"]


def neighbours(plane: Plane, adjacency: AdjacencyName) -> tuple[tuple[int, ...], ...]:
    """Adjacent cells of every cell, ascending, without the cell itself."""
    beside: list[set[int]] = [set() for _ in plane.cells]
    for row in plane.rows:
        for behind, ahead in pairwise(row.runs):
            if behind.s_max == ahead.s_min:
                beside[behind.cell].add(ahead.cell)
                if adjacency != "forward":
                    beside[ahead.cell].add(behind.cell)
    for right, left in pairwise(plane.rows):
        _sideways(right, left, adjacency == "touch", beside)
    return tuple(tuple(sorted(cells - {i})) for i, cells in enumerate(beside))


def _sideways(right: Row, left: Row, corners: bool, beside: list[set[int]]) -> None:
    start = 0
    for run in right.runs:
        while start < len(left.runs) and left.runs[start].s_max < run.s_min:
            start += 1
        for opposite in left.runs[start:]:
            if opposite.s_min > run.s_max:
                break
            if corners or (opposite.s_min < run.s_max and run.s_min < opposite.s_max):
                beside[run.cell].add(opposite.cell)
                beside[opposite.cell].add(run.cell)

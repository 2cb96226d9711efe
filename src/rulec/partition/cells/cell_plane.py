"""Cells: connected parts of the road, cut by obstacles' regions.

All borders run along or across the road, so the cuts of all regions form a grid. Each row of the
grid is read as runs of equal labels (surface and one letter per obstacle), and runs of neighbouring
rows that share a label and a border of positive length are merged. That gives the same cells as
intersecting polygons one obstacle after the other, without rounding errors and empty cells.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Sequence
from itertools import accumulate, groupby, pairwise

from rulec.partition.cells.cell_model import Cell, Plane, Row, Run
from rulec.partition.cells.regions import OCCUPIED, PartitionName, Region
from rulec.partition.cells.roadway import Roadway
from rulec.scenario import Box

_CARRIAGEWAY, _CROSSING = b"w", b"c"

# A run not yet assigned to a cell: first and last cut, label
_Piece = tuple[int, int, bytes]


def plane(
    roadway: Roadway, regions: Sequence[Region], partition: PartitionName, names: Sequence[str]
) -> Plane:
    """Cut the road by the regions of the obstacles with these ``names``."""
    s_cuts, d_cuts = _cuts(roadway, regions)
    rows = [list(_pieces(roadway, regions, s_cuts, bounds)) for bounds in pairwise(d_cuts)]
    numbers = _connected(rows)
    parts: dict[int, tuple[bytes, list[Box]]] = {}
    finished: list[Row] = []
    for pieces, of_piece, (d_min, d_max) in zip(rows, numbers, pairwise(d_cuts), strict=True):
        runs = []
        for (first, last, label), cell in zip(pieces, of_piece, strict=True):
            run = Run(s_cuts[first], s_cuts[last], cell)
            runs.append(run)
            parts.setdefault(cell, (label, []))[1].append(Box(run.s_min, run.s_max, d_min, d_max))
        finished.append(Row(d_min, d_max, tuple(runs)))
    objects = tuple(names)
    cells = (
        Cell(
            tuple(boxes),
            "crossing" if label[:1] == _CROSSING else "carriageway",
            partition,
            objects,
            label[1:],
        )
        for label, boxes in parts.values()  # numbered in reading order
    )
    return Plane(tuple(finished), tuple(cells))


def _cuts(roadway: Roadway, regions: Sequence[Region]) -> tuple[list[float], list[float]]:
    free = roadway.free
    s_cuts = {free.s_min, free.s_max}
    d_cuts = {free.d_min, free.d_max, *roadway.lanes}
    for interval in roadway.crossings:
        s_cuts.update(interval)
    for box in (*roadway.holes, *(region.extent for region in regions)):
        s_cuts.update((box.s_min, box.s_max))
        d_cuts.update((box.d_min, box.d_max))
    return (
        sorted(s for s in s_cuts if free.s_min <= s <= free.s_max),
        sorted(d for d in d_cuts if free.d_min <= d <= free.d_max),
    )


def _pieces(
    roadway: Roadway, regions: Sequence[Region], s_cuts: list[float], bounds: tuple[float, float]
) -> Iterator[_Piece]:
    width = len(s_cuts) - 1
    surface = bytearray(_CARRIAGEWAY * width)
    for start, end in roadway.crossings:
        first, last = _columns(s_cuts, start, end)
        surface[first:last] = _CROSSING * (last - first)
    for hole in roadway.holes:
        if hole.d_min < bounds[1] and bounds[0] < hole.d_max:
            first, last = _columns(s_cuts, hole.s_min, hole.s_max)
            surface[first:last] = bytes([OCCUPIED]) * (last - first)
    columns = [bytes(surface)]
    """One string for the surface and one per obstacle; the column at a place is its label."""
    for region in regions:
        extent = region.extent
        first, last = _columns(s_cuts, extent.s_min, extent.s_max)
        side = 0 if bounds[1] <= extent.d_min else 2 if bounds[0] >= extent.d_max else 1
        before, beside, after = (region.table[3 * side + i : 3 * side + i + 1] for i in range(3))
        columns.append(before * first + beside * (last - first) + after * (width - last))
    at = 0
    for label, run in groupby(zip(*columns, strict=True)):
        start, at = at, at + sum(1 for _ in run)
        if OCCUPIED not in label:
            yield start, at, bytes(label)


def _columns(s_cuts: list[float], start: float, end: float) -> tuple[int, int]:
    last = len(s_cuts) - 1
    first = min(bisect_left(s_cuts, start), last)
    return first, max(first, min(bisect_left(s_cuts, end), last))


def _connected(rows: list[list[_Piece]]) -> list[list[int]]:
    """The cell number of every piece; cells are numbered from 0 in reading order."""
    offsets = list(accumulate(map(len, rows), initial=0))
    parent = list(range(offsets[-1]))

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for lower, upper, base, top in zip(rows, rows[1:], offsets, offsets[1:], strict=False):
        j = 0
        for i, (first, last, label) in enumerate(lower):
            while j < len(upper) and upper[j][1] <= first:
                j += 1
            for k in range(j, len(upper)):
                if upper[k][0] >= last:
                    break
                if upper[k][2] == label:
                    a, b = root(base + i), root(top + k)
                    parent[max(a, b)] = min(a, b)
    numbers: dict[int, int] = {}
    return [
        [numbers.setdefault(root(base + i), len(numbers)) for i in range(len(row))]
        for row, base in zip(rows, offsets, strict=False)
    ]

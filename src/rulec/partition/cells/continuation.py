"""Continuation of cells from one layer to the next.

A cell of layer p continues as one of layer p + 1 if both overlap one cell of the plane at the
instant between them, with the obstacles where they are at that moment.
"""

from __future__ import annotations

from rulec.partition.cells.cell_model import Plane

Links = tuple[frozenset[int], ...]
"""For each cell of one plane, cells of another one."""


def continuations(before: Plane, instant: Plane, after: Plane) -> Links:
    """Cells of ``after`` that continue each cell of ``before``."""
    seen = overlaps(before, instant)
    onward = overlaps(instant, after)
    return tuple(frozenset().union(*(onward[i] for i in cells)) for cells in seen)


def overlaps(plane: Plane, later: Plane) -> Links:
    """Cells of ``later`` that share area with each cell of ``plane``."""
    links: list[set[int]] = [set() for _ in plane.cells]
    for row in plane.rows:
        for across in later.rows:
            if row.d_min >= across.d_max or across.d_min >= row.d_max:
                continue
            start = 0
            for run in row.runs:
                while start < len(across.runs) and across.runs[start].s_max <= run.s_min:
                    start += 1
                for index in range(start, len(across.runs)):
                    candidate = across.runs[index]
                    if candidate.s_min >= run.s_max:
                        break
                    links[run.cell].add(candidate.cell)
    return tuple(frozenset(cells) for cells in links)


def inverse(links: Links, size: int) -> Links:
    """The links the other way, for ``size`` cells."""
    origins: list[set[int]] = [set() for _ in range(size)]
    for i, cells in enumerate(links):
        for j in cells:
            origins[j].add(i)
    return tuple(frozenset(cells) for cells in origins)

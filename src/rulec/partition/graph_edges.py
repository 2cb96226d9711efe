"""The edges of a navigation graph, and how long each of its changes of cell stays open.

There is an edge from A at layer p to B at p + 1 if A continues as some A', B continues some B°, A
and B° are adjacent or the same at p, and so are A' and B at p + 1. If B continues A it is staying.
Otherwise it is a change, which stays open as long as the two cells remain adjacent: the longest run
of layers back from (A, B°) and on from (A', B), following continuations. The 2019 paper names the
quantity; this reading of it is ours.

Within bounds of motion there may be more edges. Among many obstacles the cells are small, and ego
crosses several borders in a step: to wherever it comes through so many cells of layer p. Which of
them it can drive depends on its bounds. Such a change stays open as long as each of the borders on
the way that stays open longest, without those by which ego only passes others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from operator import itemgetter

from rulec.partition.cell_graph import Edges, Margins
from rulec.partition.cells import cell_links
from rulec.partition.cells.cell_model import Layer, passes_only

_Runs = Sequence[Mapping[int, int]]
"""For each cell, its neighbours, each with the number of layers for which it has been one."""


def edges(
    layers: Sequence[Layer], onward: Sequence[cell_links.Links], borders: int = 1
) -> tuple[tuple[Edges, ...], tuple[Margins, ...]]:
    """Successors of every cell and their margins, in layers.

    ``onward[p]`` are the continuations from layer p to p + 1, ``borders`` how many borders ego may
    cross in a step. The margin of staying is None.
    """
    back = [
        cell_links.inverse(links, len(after.cells))
        for links, after in zip(onward, layers[1:], strict=True)
    ]
    so_far = _runs(layers, back)
    to_come = _runs(layers[::-1], onward[::-1])[::-1]
    open_for = [
        _open_for(*three, len(layers)) if borders > 1 else []
        for three in zip(layers, so_far, to_come, strict=True)
    ]
    successors: list[Edges] = []
    margins: list[Margins] = []
    for p, links in enumerate(onward):
        rows: list[tuple[int, ...]] = []
        values: list[tuple[int | None, ...]] = []
        for a, continued in enumerate(links):
            before = _longest((run, links[origin]) for origin, run in so_far[p][a].items())
            after = _longest_of(to_come[p + 1][image] for image in continued)
            changes = {b: before[b] + after[b] for b in before.keys() & after.keys() - continued}
            if borders > 1:
                several = _longest(
                    (run, links[near])
                    for near, run in _widest(a, open_for[p], borders, len(layers)).items()
                )
                changes = {b: several[b] for b in several.keys() - continued} | changes
            reached = sorted({*continued, *changes})
            rows.append(tuple(reached))
            values.append(tuple([changes.get(b) for b in reached]))
        successors.append(tuple(rows))
        margins.append(tuple(values))
    return tuple(successors), tuple(margins)


def _runs(layers: Sequence[Layer], back: Sequence[cell_links.Links]) -> list[_Runs]:
    """The number of layers for which each adjacent pair has been adjacent so far.

    ``back[p]`` leads from layer p + 1 to layer p, in whichever order of time the layers are given.
    """
    runs: list[_Runs] = [
        [dict.fromkeys(row, 1) for row in layer.neighbours] for layer in layers[:1]
    ]
    for layer, links in zip(layers[1:], back, strict=True):
        earlier, current = runs[-1], []
        for a, row in enumerate(layer.neighbours):
            # Per earlier neighbour, the longest run among all cells that continue as this one
            longest = _longest_of(earlier[origin] for origin in links[a])
            current.append(
                {
                    b: 1 + max([longest.get(origin, 0) for origin in links[b]], default=0)
                    for b in row
                }
            )
        runs.append(current)
    return runs


def _open_for(layer: Layer, so_far: _Runs, to_come: _Runs, most: int) -> _Runs:
    """For each cell its neighbours, each with the number of layers for which it is one in all.

    It is ``most`` where ego only passes others.
    """
    return [
        {
            other: most
            if passes_only(layer.cells[cell], layer.cells[other])
            else run + to_come[cell][other] - 1
            for other, run in row.items()
        }
        for cell, row in enumerate(so_far)
    ]


def _widest(cell: int, open_for: _Runs, borders: int, most: int) -> dict[int, int]:
    """The cells across so many borders or fewer, each with the layers for which its way is open.

    This is the shortest time for which one of the borders on a way is open, on the best way.
    """
    widest = {cell: most}
    edge = [cell]
    for _ in range(borders):
        wider: dict[int, int] = {}
        for one in edge:
            so_wide = widest[one]
            for other, run in open_for[one].items():
                width = min(run, so_wide)
                if width > widest.get(other, 0):
                    widest[other] = wider[other] = width
        edge = list(wider)
    return widest


def _longest_of(rows: Iterable[Mapping[int, int]]) -> dict[int, int]:
    """For each cell the longest of its runs."""
    longest: dict[int, int] = {}
    for row in rows:
        for cell, run in row.items():
            if run > longest.get(cell, 0):
                longest[cell] = run
    return longest


def _longest(runs: Iterable[tuple[int, Iterable[int]]]) -> dict[int, int]:
    """For each cell the longest of the runs to it; each run may lead to several cells."""
    longest: dict[int, int] = {}
    # The longest come last, so they overwrite shorter ones
    for run, cells in sorted(runs, key=itemgetter(0)):
        longest.update(dict.fromkeys(cells, run))
    return longest


def _across_several(cell: int, now: Layer, links: cell_links.Links, borders: int) -> frozenset[int]:
    """The successors of one cell, staying included, if ego may cross several borders in a step."""
    near = edge = {cell}
    for _ in range(borders):
        edge = {other for one in edge for other in now.neighbours[one]} - near
        near = near | edge
    return frozenset[int]().union(*(links[one] for one in near))


def cells_after(
    cell: int, now: Layer, links: cell_links.Links, then: Layer, borders: int = 1
) -> frozenset[int]:
    """The successors of one cell, staying included; ``links`` are the continuations."""
    if borders > 1:
        return _across_several(cell, now, links, borders)
    before = frozenset[int]().union(*(links[origin] for origin in now.neighbours[cell]))
    after = frozenset[int]().union(*(then.neighbours[image] for image in links[cell]))
    return links[cell] | (before & after)

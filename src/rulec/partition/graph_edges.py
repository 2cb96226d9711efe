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

from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from operator import itemgetter

from rulec.partition.cell_graph import Edges, Margins
from rulec.partition.cells import cell_links
from rulec.partition.cells.cell_model import Layer, passes_only

_Runs = Sequence[Mapping[int, int]]
"""For each cell, its neighbours, each with the number of layers for which it has been one."""


def edges(
    layers: Sequence[Layer],
    onward: Sequence[cell_links.Links],
    borders: int = 1,
    origins: Sequence[Collection[int]] | None = None,
) -> tuple[tuple[Edges, ...], tuple[Margins, ...]]:
    """Successors of every cell and their margins, in layers.

    ``onward[p]`` are the continuations from layer p to p + 1, ``borders`` how many borders ego may
    cross in a step. The margin of staying is None. If there are ``origins``, cells of each layer,
    only edges from these are listed.
    """
    back = [
        cell_links.inverse(links, len(after.cells))
        for links, after in zip(onward, layers[1:], strict=True)
    ]
    near = None if origins is None else _surroundings(layers, onward, origins, borders)
    so_far = _runs(layers, back, near)
    to_come = _runs(layers[::-1], onward[::-1], near and near[::-1])[::-1]
    successors: list[Edges] = []
    margins: list[Margins] = []
    for p, links in enumerate(onward):
        rows: list[tuple[int, ...]] = [()] * len(links)
        values: list[tuple[int | None, ...]] = [()] * len(links)
        open_for = _OpenFor(layers[p], so_far[p], to_come[p], len(layers))
        for a in range(len(links)) if origins is None else origins[p]:
            continued = links[a]
            before = _longest((run, links[origin]) for origin, run in so_far[p][a].items())
            after = _longest_of(to_come[p + 1][image] for image in continued)
            changes = {b: before[b] + after[b] for b in before.keys() & after.keys() - continued}
            if borders > 1:
                several = _longest(
                    (run, links[near]) for near, run in open_for.widest(a, borders).items()
                )
                changes = {b: several[b] for b in several.keys() - continued} | changes
            reached = sorted({*continued, *changes})
            rows[a] = tuple(reached)
            values[a] = tuple([changes.get(b) for b in reached])
        successors.append(tuple(rows))
        margins.append(tuple(values))
    return tuple(successors), tuple(margins)


def _surroundings(
    layers: Sequence[Layer],
    onward: Sequence[cell_links.Links],
    origins: Sequence[Collection[int]],
    borders: int,
) -> list[Set[int]]:
    """The cells of each layer whose runs are needed for the edges from ``origins``."""
    near = [
        _across(set(own), layer, borders - 1) for own, layer in zip(origins, layers, strict=True)
    ]
    images = [
        set[int]().union(*[links[cell] for cell in own])
        for own, links in zip(origins, onward, strict=False)
    ]
    return [near[0], *(own | after for own, after in zip(near[1:], images, strict=True))]


def _across(cells: set[int], layer: Layer, borders: int) -> set[int]:
    """These cells and all across so many borders from them."""
    near = edge = cells
    for _ in range(borders):
        edge = {other for one in edge for other in layer.neighbours[one]} - near
        near = near | edge
    return near


def _runs(
    layers: Sequence[Layer],
    back: Sequence[cell_links.Links],
    wanted: Sequence[Set[int]] | None,
) -> list[_Runs]:
    """The number of layers for which each adjacent pair has been adjacent so far.

    ``back[p]`` leads from layer p + 1 to layer p, in whichever order of time the layers are given.
    If some cells of each layer are ``wanted``, there are no runs of other cells.
    """
    needed = _needed(layers, back, wanted)
    runs: list[_Runs] = []
    for p, layer in enumerate(layers):
        rows: list[Mapping[int, int]] = [{}] * len(layer.cells)
        for a in needed[p]:
            if not p:
                rows[a] = dict.fromkeys(layer.neighbours[a], 1)
                continue
            links = back[p - 1]
            # Per earlier neighbour, the longest run among all cells that continue as this one
            longest = _longest_of(runs[-1][origin] for origin in links[a])
            rows[a] = {
                b: 1 + max([longest.get(origin, 0) for origin in links[b]], default=0)
                for b in layer.neighbours[a]
            }
        runs.append(rows)
    return runs


def _needed(
    layers: Sequence[Layer],
    back: Sequence[cell_links.Links],
    wanted: Sequence[Set[int]] | None,
) -> Sequence[Collection[int]]:
    """The wanted cells of each layer, and those that they continue."""
    if wanted is None:
        return [range(len(layer.cells)) for layer in layers]
    needed: list[Set[int]] = [wanted[-1]]
    for cells, links in zip(wanted[-2::-1], back[::-1], strict=True):
        needed.append(cells | set[int]().union(*[links[cell] for cell in needed[-1]]))
    return needed[::-1]


@dataclass(frozen=True, slots=True, eq=False)
class _OpenFor:
    """For how many layers the borders between the cells of one layer are open, ``most`` at most."""

    layer: Layer
    so_far: _Runs
    to_come: _Runs
    most: int
    known: dict[int, dict[int, int]] = field(default_factory=dict)

    def beside(self, cell: int) -> Mapping[int, int]:
        """A cell's neighbours, each with the number of layers for which it is one.

        It is ``most`` where ego only passes others.
        """
        if cell not in self.known:
            cells, after = self.layer.cells, self.to_come[cell]
            self.known[cell] = {
                other: self.most
                if passes_only(cells[cell], cells[other])
                else run + after[other] - 1
                for other, run in self.so_far[cell].items()
            }
        return self.known[cell]

    def widest(self, cell: int, borders: int) -> dict[int, int]:
        """The cells across so many borders or fewer, and for how many layers their way is open.

        This is the shortest time for which one of the borders on a way is open, on the best way.
        """
        widest = {cell: self.most}
        edge = [cell]
        for _ in range(borders):
            wider: dict[int, int] = {}
            for one in edge:
                so_wide = widest[one]
                for other, run in self.beside(one).items():
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

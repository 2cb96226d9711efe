"""Edges of the navigation graph and their time margins.

An edge from A at layer p to B at p + 1: A continues as some A', B continues some B°, A and B° are
adjacent or the same at p, A' and B at p + 1. If B continues A it is staying. Else it is a change,
and it stays open as long as the two remain adjacent: the longest run of layers back from (A, B°)
and on from (A', B), following continuations. The 2019 paper names the quantity; this reading of it
is ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from rulec.partition.cells.cell_links import Links, inverse
from rulec.partition.cells.cell_model import Layer

Edges = tuple[tuple[int, ...], ...]
Margins = tuple[tuple[int | None, ...], ...]
_Runs = dict[tuple[int, int], int]


def edges(
    layers: Sequence[Layer], onward: Sequence[Links]
) -> tuple[tuple[Edges, ...], tuple[Margins, ...]]:
    """Successors of every cell and their margins, in layers.

    ``onward[p]`` are the continuations from layer p to p + 1. The margin of staying is None.
    """
    back = [
        inverse(links, len(after.cells)) for links, after in zip(onward, layers[1:], strict=True)
    ]
    so_far = _runs(layers, back)
    to_come = _runs(layers[::-1], onward[::-1])[::-1]
    successors: list[Edges] = []
    margins: list[Margins] = []
    for p, links in enumerate(onward):
        now, then = layers[p].neighbours, layers[p + 1].neighbours
        rows: list[tuple[int, ...]] = []
        values: list[tuple[int | None, ...]] = []
        for a, continued in enumerate(links):
            before: dict[int, int] = {}
            for origin in now[a]:
                run = so_far[p][a, origin]
                for b in links[origin]:
                    before[b] = max(before.get(b, 0), run)
            after: dict[int, int] = {}
            for image in continued:
                for b in then[image]:
                    after[b] = max(after.get(b, 0), to_come[p + 1][image, b])
            changes = {b: before[b] + after[b] for b in before.keys() & after.keys() - continued}
            reached = sorted({*continued, *changes})
            rows.append(tuple(reached))
            values.append(tuple(changes.get(b) for b in reached))
        successors.append(tuple(rows))
        margins.append(tuple(values))
    return tuple(successors), tuple(margins)


def _runs(layers: Sequence[Layer], back: Sequence[Links]) -> list[_Runs]:
    """Layers for which each adjacent pair has been adjacent so far.

    ``back[p]`` leads from layer p + 1 to layer p, in whichever order of time layers are given.
    """
    runs: list[_Runs] = []
    for p, layer in enumerate(layers):
        earlier = runs[-1] if runs else {}
        links = back[p - 1] if p else ()
        current: _Runs = {}
        for a, row in enumerate(layer.neighbours):
            for b in row:
                before = product(links[a], links[b]) if p else ()
                current[a, b] = 1 + max((earlier.get(pair, 0) for pair in before), default=0)
        runs.append(current)
    return runs

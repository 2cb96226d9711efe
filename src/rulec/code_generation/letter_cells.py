"""Letter classes as a decision diagram over reads, in cells of an array.

A reduced ordered decision diagram with a node for each read that still matters (R. E. Bryant,
"Graph-based algorithms for Boolean function manipulation", 1986; for several values: A. Srinivasan
et al., "Algorithms for discrete function manipulation", 1990). A table of 61,440 letters becomes
about a hundred cells, and only the reads on one path are evaluated.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import IMPOSSIBLE

LEAF = 0x8000
"""Cells from this value on are a class, or ``EXCLUDED``."""

EXCLUDED = 0xFFFF
"""The cell of letters that facts exclude."""

Cells = list[int]
"""The first cell is the start of the diagram: a node, or a leaf.

A node is a cell with the place of its read, followed by a cell for each digit: the next node,
always further on in the array, or a leaf.
"""


MOST_CELLS = 2000
"""Of 16 bits each: less than 4 kB per rule."""


def letter_cells(
    letters: Sequence[int], sizes: Sequence[int], of_nobody: Collection[int] = ()
) -> Cells:
    """The diagram of letters in mixed radix, whose first read counts ones.

    ``sizes`` are the numbers of digits of each read. Reads that are ``of_nobody`` (of no object)
    come first, so that they are evaluated once for all objects, unless that takes more than
    ``MOST_CELLS``. Of two orders of the reads the one with fewer cells is chosen.
    """
    table = np.array(letters, dtype=np.int64).reshape(tuple(reversed(sizes))).transpose()
    order = list(range(len(sizes)))
    orders = order, order[::-1]
    first = [sorted(read_order, key=lambda read: read not in of_nobody) for read_order in orders]
    shared = min((_cells(table, read_order) for read_order in first), key=len)
    if len(shared) <= MOST_CELLS:
        return shared
    return min((_cells(table, read_order) for read_order in orders), key=len)


def _cells(table: NDArray[np.int64], order: Sequence[int]) -> Cells:
    """The diagram that tests reads in this order."""
    sizes = [table.shape[read] for read in order]
    flat = table.transpose(order).ravel()
    # Leaves are negative; nodes are numbered, lower levels first.
    below: NDArray[Any] = -(flat + 2)
    nodes: list[tuple[int, list[int]]] = []
    for read, size in reversed(list(zip(order, sizes, strict=True))):
        rows, places = np.unique(below.reshape(-1, size), axis=0, return_inverse=True)
        own = rows[:, 0].copy()
        for number, row in enumerate(rows.tolist()):
            if len(set(row)) > 1:
                own[number] = len(nodes)
                nodes.append((read, row))
        below = own[places.ravel()]
    starts: dict[int, int] = {}
    end = 1
    for number in range(len(nodes) - 1, -1, -1):
        starts[number] = end
        end += 1 + len(nodes[number][1])

    def cell(child: int) -> int:
        if child >= 0:
            return starts[child]
        return EXCLUDED if -child - 2 == IMPOSSIBLE else LEAF - child - 2

    cells = [cell(int(below[0]))]
    for read, row in reversed(nodes):
        cells += [read, *map(cell, row)]
    return cells

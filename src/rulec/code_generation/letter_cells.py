"""Letter classes as decisions: a diagram of reads, in cells of an array.

A reduced ordered decision diagram with a node for each read that still matters (R. E. Bryant,
"Graph-based algorithms for Boolean function manipulation", 1986; of several values: A. Srinivasan
et al., "Algorithms for discrete function manipulation", 1990). What a table of 61,440 letters says
takes a hundred cells, and only the reads on the way to an answer are looked at.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import IMPOSSIBLE

LEAF = 0x8000
"""A cell from here on is a class, or ``EXCLUDED``."""

EXCLUDED = 0xFFFF
"""The cell of letters that facts exclude."""

Cells = list[int]
"""The first says where the diagram begins: at a node, or at a leaf.

A node is a cell with the place of its read, and a cell for each digit: the node where to go on,
always further on in the array, or a leaf.
"""


MOST_CELLS = 2000
"""Of 16 bits: less than 4 kB a rule."""


def letter_cells(
    letters: Sequence[int], sizes: Sequence[int], of_nobody: Collection[int] = ()
) -> Cells:
    """The diagram of letters in mixed radix, the first read counting ones.

    ``sizes`` are the numbers of digits of each read. Reads that are ``of_nobody`` are asked first,
    once for all objects, unless that takes more than ``MOST_CELLS``. Of two orders of the reads the
    one that takes fewer cells is chosen.
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
    """The diagram that asks reads in this order."""
    sizes = [table.shape[read] for read in order]
    flat = table.transpose(order).ravel()
    # Leaves are below 0, nodes their numbers, of which lower levels have the lower ones.
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

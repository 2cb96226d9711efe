"""Maneuver envelopes: the input of a trajectory planner (paper, equation 1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter

from rulec.diagnostics import RulecError
from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Cell
from rulec.partition.partition_messages import NOT_A_PATH
from rulec.value_display import short_repr

Profile = tuple[tuple[float, float], ...]
"""Breakpoints (s, d): from each s on the bound is d, until the next one."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """The bounds of a maneuver in one layer, in metres.

    ``d_left`` and ``d_right`` are constant between breakpoints; the first is at ``s_min``, the last
    holds up to ``s_max``. Where a missing lane splits a cell in two at one s, they are the outer
    bounds.
    """

    __repr__ = short_repr

    s_max: float
    s_min: float
    d_left: Profile
    d_right: Profile


def envelope(graph: NavigationGraph, path: Sequence[int]) -> tuple[Envelope, ...]:
    """Envelope of a path, layer by layer; ``path[p]`` is a cell's index.

    Raises RulecError R0609 if ``path`` does not follow the graph from its first layer.
    """
    if len(path) > len(graph.layers):
        expected = f"at most {len(graph.layers)}, one a layer"
        raise _stray(f"the path has {len(path)} cells", expected)
    for p, i in enumerate(path):
        count = len(graph.layers[p].cells)
        if not 0 <= i < count:
            raise _stray(f"layer {p} has no cell {i}", f"a cell's index from 0 to {count - 1}")
        if p and i not in (followers := graph.successors[p - 1][path[p - 1]]):
            raise _stray(
                f"no edge leads from cell {path[p - 1]} of layer {p - 1} to cell {i}",
                "one of " + ", ".join(map(str, followers)) if followers else "no successor",
            )
    return tuple(_bounds(graph.layers[p].cells[i]) for p, i in enumerate(path))


def _stray(message: str, expected: str) -> RulecError:
    return NOT_A_PATH.error(
        None,
        message,
        expected=f"expected {expected}",
        help="give the index of one cell a layer, each a successor of the one before",
    )


def _bounds(cell: Cell) -> Envelope:
    cuts = sorted({s for box in cell.boxes for s in (box.s_min, box.s_max)})
    left: list[tuple[float, float]] = []
    right: list[tuple[float, float]] = []
    for start in cuts[:-1]:
        here = [box for box in cell.boxes if box.s_min <= start < box.s_max]
        left.append((start, max(box.d_max for box in here)))
        right.append((start, min(box.d_min for box in here)))
    return Envelope(cuts[-1], cuts[0], _breakpoints(left), _breakpoints(right))


def _breakpoints(bounds: Sequence[tuple[float, float]]) -> Profile:
    return tuple(next(same) for _, same in groupby(bounds, key=itemgetter(1)))

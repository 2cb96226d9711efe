"""Lower bounds on the cost of driving through a path's first cells.

One linear program is reused: its rows for cells, and for the sides of obstacles, are switched on
and off, because each solution is close to the last one and is then found in a few steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from rulec.partition.motion.linear_program import Solution
from rulec.partition.motion.motion_program import MotionProgram
from rulec.partition.motion.others_beside import CutRows, Cuts, OthersBeside

_MOST_ROUNDS = 12
"""The most rounds of adding rows; stopping early leaves a weaker bound."""


@dataclass(frozen=True, slots=True, eq=False)
class WayBound:
    """The cheapest motion through some cells, and the rows about obstacles that are used."""

    solution: Solution
    cuts: Cuts

    @property
    def cost(self) -> float:
        """The least cost of all motions through these cells."""
        return self.solution.cost


class WayBounds:
    """Cost bounds for beginnings of a graph's paths; ``braking_only`` as in ``MotionProgram``."""

    def __init__(
        self, motion: MotionProgram, others: OthersBeside, *, braking_only: bool = False
    ) -> None:
        self._motion, self._others, self._graph = motion, others, motion.graph
        self._program = motion.program(braking_only=braking_only)
        free = motion.in_cells(())
        first = self._program.add(free.rows, free.low, free.high)
        self._cells = np.arange(first, first + len(free.rows))
        self._rows = CutRows(self._program)

    def of(self, path: Sequence[int], before: Cuts = MappingProxyType({})) -> WayBound | None:
        """The bound for a path's beginning, with rows ``before``; None if it cannot be driven."""
        cells = [layer.cells[i] for layer, i in zip(self._graph.layers, path, strict=False)]
        low, high = self._motion.cell_bounds(cells)
        until = float(self._motion.layers_s[len(path) - 1])
        cuts, found = before, None
        self._program.change(self._cells, low, high)
        for _ in range(_MOST_ROUNDS):
            self._rows.switch(cuts)
            solution = self._program.solved()
            if solution is None:
                return None
            found = WayBound(solution, cuts)
            overlaps = self._others.overlaps(solution, path, until, sure=True)
            more = {cut.name: cut for cut in overlaps if cut.name not in cuts}
            if not more:
                break
            cuts = {**cuts, **more}
        return found

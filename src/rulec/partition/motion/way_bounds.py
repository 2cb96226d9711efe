"""Lower bounds on the cost of driving through a path's first cells.

One linear program is reused: its rows for cells, and for the sides of obstacles, are switched on
and off, because each solution is close to the last one and is then found in a few steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rulec.partition.motion.linear_program import Row, Solution
from rulec.partition.motion.motion_program import MotionProgram
from rulec.partition.motion.others_beside import Cut, OthersBeside

_MOST_ROUNDS = 12
"""The most rounds of adding rows; stopping early leaves a weaker bound."""

_Names = frozenset[tuple[object, ...]]


@dataclass(frozen=True, slots=True, eq=False)
class WayBound:
    """The cheapest motion through some cells, and the names of the rows about obstacles used."""

    solution: Solution
    cuts: _Names

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
        self._first = self._program.add(free.rows, free.low, free.high)
        self._rows: dict[tuple[object, ...], tuple[int, Cut]] = {}

    def of(self, path: Sequence[int], before: _Names = frozenset()) -> WayBound | None:
        """The bound for a path's beginning, with rows ``before``; None if it cannot be driven."""
        cells = [layer.cells[i] for layer, i in zip(self._graph.layers, path, strict=False)]
        low, high = self._motion.cell_bounds(cells)
        until = float(self._motion.layers_s[len(path) - 1])
        names, found = before, None
        for _ in range(_MOST_ROUNDS):
            self._switch(names, low, high)
            solution = self._program.solved()
            if solution is None:
                return None
            found = WayBound(solution, names)
            cuts = self._others.overlaps(solution, path, until, sure=True)
            more = {cut.name: cut for cut in cuts if cut.name not in names}
            if not more:
                break
            self._add([cut for name, cut in more.items() if name not in self._rows])
            names = names | more.keys()
        return found

    def _add(self, cuts: Sequence[Cut]) -> None:
        if cuts:
            rows = np.array([cut.row for cut in cuts])
            low, high = (np.array([getattr(cut, end) for cut in cuts]) for end in ("low", "high"))
            first = self._program.add(rows, low, high)
            self._rows |= {cut.name: (first + k, cut) for k, cut in enumerate(cuts)}

    def _switch(self, names: _Names, low: Row, high: Row) -> None:
        """Set the bounds of the rows of cells, and switch the rows about obstacles on or off."""
        numbers = [np.arange(self._first, self._first + len(low))]
        lows, highs = [low], [high]
        if self._rows:
            own = list(self._rows.items())
            numbers.append(np.array([number for _, (number, _) in own]))
            lows.append(np.array([cut.low if x in names else -np.inf for x, (_, cut) in own]))
            highs.append(np.array([cut.high if x in names else np.inf for x, (_, cut) in own]))
        every = np.concatenate(numbers)
        self._program.change(every, np.concatenate(lows), np.concatenate(highs))

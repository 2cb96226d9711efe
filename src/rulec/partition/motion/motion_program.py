"""The linear program of ego's motion along and across the road, piecewise constant acceleration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Cell, Reach
from rulec.partition.motion.least_costs import PER_ACCELERATION, PER_SPEED
from rulec.partition.motion.linear_program import LinearProgram, Row, Solution
from rulec.partition.motion.reachable_graph import ego_motion
from rulec.partition.motion.reachable_sets import Interval
from rulec.scenario import Box, MotionBounds

PIECE_S = 0.1
"""The greatest length (s) of a piece of constant acceleration."""

PER_JERK, PER_LANE, PER_END = 0.25, 0.2, 0.1
"""Costs per m/s³ of mean jerk, per m from a lane's middle, per m/s at the end.

The last counts the difference from ego's initial speed, and the speed across the road.
"""

_ASIDE_M = 0.5
"""Ego keeps to its own lane's middle if it can come as near (m) as this."""

COMFORTABLE, PER_HARD = 4.0, 4.0
"""The greatest usual acceleration (m/s²), and the extra cost of each m/s² above it."""


@dataclass(frozen=True, slots=True, eq=False)
class PlaceRows:
    """Ego's coordinate at some times: rows of coefficients over the variables, and constants."""

    rows: NDArray[np.float64]
    fixed: Row

    def of(self, solution: Solution) -> Row:
        """The coordinate's values in a solution."""
        return np.asarray(self.rows @ solution.values + self.fixed)


@dataclass(frozen=True, slots=True, eq=False)
class Bounded:
    """Rows over the variables, each with its bounds."""

    rows: NDArray[np.float64]
    low: Row
    high: Row


class MotionProgram:
    """Ego's motion through the layers of a graph: variables, their costs and their bounds."""

    def __init__(self, graph: NavigationGraph, bounds: MotionBounds) -> None:
        self.graph, self.bounds = graph, bounds
        self._parts = max(1, ceil(graph.step_s / PIECE_S - 1e-9))
        self.piece = graph.step_s / self._parts
        self.count = self._parts * (len(graph.layers) - 1)
        self._motion = ego_motion(graph.scenario.ego, bounds, graph.step_s, len(graph.layers))
        # Variables: accelerations of pieces along and across, the greatest up to the usual limit
        # and beyond it, jerks along and across, differences of speed, distances from lanes, the
        # speed across at the end, the speed along at the start.
        n, layers = self.count, len(graph.layers) - 1
        self.at = np.cumsum([0, n, n, 2, n - 1, n - 1, n, layers, 1])
        self.size = int(self.at[-1]) + 1
        self.layers_s = np.array([layer.start_s for layer in graph.layers])

    def along(self, times: Row) -> PlaceRows:
        """Ego's place along the road at some times."""
        ego = self.graph.scenario.ego
        places = self._places(times, 0, ego.s, 0.0)
        places.rows[:, -1] = times
        return places

    def across(self, times: Row) -> PlaceRows:
        """Ego's place across the road at some times."""
        ego = self.graph.scenario.ego
        return self._places(times, 1, ego.d, ego.lateral_speed)

    def _places(self, times: Row, axis: int, place: float, speed: float) -> PlaceRows:
        starts = np.arange(self.count) * self.piece
        for_s = np.clip(times[:, None] - starts, 0.0, self.piece)
        left = np.maximum(times[:, None] - starts - for_s, 0.0)
        rows = np.zeros((len(times), self.size))
        first = int(self.at[axis])
        rows[:, first : first + self.count] = for_s**2 / 2 + for_s * left
        return PlaceRows(rows, place + speed * times)

    def place_at(self, time: float, path: Sequence[int]) -> tuple[Interval, Interval]:
        """Bounds of ego's places along and across the road at a time, on a path or its beginning.

        By what the path's cells allow before and after it.
        """
        p = min(int(time / self.graph.step_s + 1e-9), len(path) - 1)
        reach, gone = self._reach(p, path), time - float(self.layers_s[p])
        along = self._motion.along.forward(reach.s, reach.speed, gone)
        across = self._motion.across.forward(reach.d, reach.lateral_speed, gone)
        if p + 1 < len(path):
            reach, left = self._reach(p + 1, path), float(self.layers_s[p + 1]) - time
            before = self._motion.along.backward(reach.s, reach.speed, left)
            beside = self._motion.across.backward(reach.d, reach.lateral_speed, left)
            along, across = _common(along, before), _common(across, beside)
        return along, across

    def _reach(self, p: int, path: Sequence[int]) -> Reach:
        reach = self.graph.reach[p][path[p]]
        assert reach is not None, "ego reaches the cells of its paths"
        return reach

    def speeds(self, axis: int) -> PlaceRows:
        """The speeds along one axis at the ends of pieces."""
        rows = np.zeros((self.count, self.size))
        first = int(self.at[axis])
        rows[:, first : first + self.count] = np.tri(self.count) * self.piece
        sideways = self.graph.scenario.ego.lateral_speed
        rows[:, -1] = 1.0 - axis
        return PlaceRows(rows, np.full(self.count, sideways * axis))

    def program(self, *, braking_only: bool = False) -> LinearProgram:
        """A program of the motions that ego can drive, without constraints on its place.

        With ``braking_only`` the cost is the hardest braking (m/s²) alone.
        """
        at, n, motion = self.at, self.count, self._motion
        ego = self.graph.scenario.ego
        low, high = np.zeros(self.size), np.full(self.size, np.inf)
        for axis, kind in enumerate((motion.along, motion.across)):
            low[at[axis] : at[axis + 1]], high[at[axis] : at[axis + 1]] = kind.accelerations
        low[-1], high[-1] = motion.along.speeds if ego.speed is None else (ego.speed, ego.speed)
        cost = np.zeros(self.size)
        high[at[2]] = COMFORTABLE
        cost[at[2] : at[3]] = PER_ACCELERATION, PER_ACCELERATION + PER_HARD
        cost[at[3] : at[5]] = PER_JERK / (n * self.piece)
        cost[at[5] : at[6]] = PER_SPEED / n
        cost[at[6] - 1] += PER_END
        cost[at[6] : at[7]] = PER_LANE / max(len(self.graph.layers) - 1, 1)
        cost[at[7]] = PER_END
        every = np.eye(self.size)[: at[2]]
        if braking_only:
            cost[:] = 0.0
            cost[at[2] : at[3]] = 1.0
            # Only braking counts, not acceleration ahead or sideways
            every = -every[:n]
        program = LinearProgram(cost, low, high)
        speeds, sideways = self.speeds(0), self.speeds(1)
        _add(program, speeds, *motion.along.speeds)
        _add(program, sideways, *motion.across.speeds)
        for sign in (1.0, -1.0):
            turned = PlaceRows(
                sign * sideways.rows - motion.slope * speeds.rows, sign * sideways.fixed
            )
            _add(program, turned, -np.inf, 1e-6)
        greatest = np.tile(np.arange(at[2], at[3]), (len(every), 1))
        if braking_only:
            self._at_most(program, every, greatest)
            return program
        self._absolute(program, every, greatest)
        for axis in (0, 1):
            pieces = np.eye(self.size)[at[axis] : at[axis + 1]]
            slacks = np.arange(at[3 + axis], at[4 + axis])
            self._absolute(program, pieces[1:] - pieces[:-1], slacks)
        wanted = speeds.rows.copy()
        wanted[:, -1] = 0.0
        self._absolute(program, wanted, np.arange(at[5], at[6]))
        self._absolute(program, sideways.rows[-1:], at[7:8], sideways.fixed[-1:])
        return program

    def in_cells(self, cells: Sequence[Cell]) -> Bounded:
        """Rows that keep ego in cells at the beginning of their layers, except the first.

        Each layer has four rows: along, across, and two for the distance from a lane's middle.
        """
        along, across = self.along(self.layers_s[1:]), self.across(self.layers_s[1:])
        count = len(along.rows)
        own = np.zeros((count, self.size))
        own[np.arange(count), np.arange(self.at[6], self.at[7])] = 1.0
        rows = np.stack((along.rows, across.rows, across.rows - own, across.rows + own), axis=1)
        low, high = self.cell_bounds(cells)
        return Bounded(rows.reshape(-1, self.size), low, high)

    def cell_bounds(self, cells: Sequence[Cell]) -> tuple[Row, Row]:
        """The bounds of these rows; layers without a cell are unbounded, except for the goal."""
        ego = self.graph.scenario.ego
        low = np.full((len(self.graph.layers) - 1, 4), -np.inf)
        high = -low
        boxes = [cell.bounds for cell in cells[1:]]
        for k, (box, middle) in enumerate(zip(boxes, self._middles(boxes), strict=True)):
            s = ego.s, ego.d + ego.lateral_speed * self.layers_s[k + 1]
            low[k, :2] = box.s_min - s[0], box.d_min - s[1]
            high[k, :2] = box.s_max - s[0], box.d_max - s[1]
            high[k, 2] = low[k, 3] = middle - s[1]
        goal = self.graph.scenario.goal
        if goal is not None:
            end = np.array([ego.s, ego.d + ego.lateral_speed * self.layers_s[-1]])
            low[-1, :2] = np.maximum(low[-1, :2], (goal.s_min, goal.d_min) - end)
            high[-1, :2] = np.minimum(high[-1, :2], (goal.s_max, goal.d_max) - end)
        return low.ravel(), high.ravel()

    def _at_most(
        self,
        program: LinearProgram,
        rows: NDArray[np.float64],
        slacks: NDArray[np.intp],
        fixed: Row | float = 0.0,
    ) -> None:
        """Constrain slack variables to be at least the rows plus the constants ``fixed``."""
        own = rows.copy()
        own[np.arange(len(rows))[:, None], slacks.reshape(len(rows), -1)] -= 1.0
        program.add(own, np.full(len(rows), -np.inf), np.zeros(len(rows)) - fixed)

    def _absolute(
        self,
        program: LinearProgram,
        rows: NDArray[np.float64],
        slacks: NDArray[np.intp],
        fixed: Row | float = 0.0,
    ) -> None:
        """Constrain slack variables to be at least the absolute values of rows plus constants."""
        self._at_most(program, rows, slacks, fixed)
        self._at_most(program, -rows, slacks, -fixed)

    def _middles(self, boxes: Sequence[Box]) -> Iterator[float]:
        """A lane's middle for each layer: of those in the cell, the one nearest to the previous.

        That of ego's lane stays the one if ego can come near it.
        """
        scenario = self.graph.scenario
        lanes = [(low + high) / 2 for low, high in pairwise(scenario.road.lanes)]
        last = min(lanes, key=lambda d: abs(d - scenario.ego.d))
        for box in boxes:
            inside = [d for d in lanes if box.d_min <= d <= box.d_max]
            own = last
            if inside and not box.d_min - _ASIDE_M <= own <= box.d_max + _ASIDE_M:
                last = min(inside, key=lambda d: abs(d - own))
            yield min(max(last, box.d_min), box.d_max)


def _common(first: Interval, second: Interval) -> Interval:
    return max(first[0], second[0]), min(first[1], second[1])


def _add(program: LinearProgram, places: PlaceRows, low: float, high: float) -> None:
    program.add(places.rows, low - places.fixed, high - places.fixed)

"""Trajectories that prove paths drivable.

A trajectory has constant accelerations along and across the road in short pieces. A linear program
finds the one of least cost that is in the path's cells when their layers begin, within bounds of
ego's motion. What is not convex is added where a solution needs it: a cell's rectangle that is
nearest, and on which side of an obstacle ego is, as its cells say. So what is found is proved, and
something may not be found although it can be driven.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Cell
from rulec.partition.motion.least_costs import PER_ACCELERATION, PER_SPEED
from rulec.partition.motion.linear_program import LinearProgram, Row, Solution
from rulec.partition.motion.reachable_graph import ego_motion
from rulec.scenario import Box, MotionBounds
from rulec.scenario.geometry import centred
from rulec.scenario.motion import swept

PIECE_S = 0.1
"""Accelerations last so long at most."""

CHECK_S = 0.05
"""At every multiple of this, and twice in a piece, ego overlaps nobody."""

MOST_ROUNDS = 25
"""So often rows are added before a path is given up."""

GAP_M = 0.01
"""So far ego stays from others, for the solver's rounding."""

PER_JERK, PER_LANE, PER_GOAL = 0.25, 0.2, 0.5
"""What a mean jerk of 1 m/s³ costs, a metre beside a lane's middle, the horizon up to the goal."""

EASED, _EASED_ENOUGH = 4.0, 0.5
"""So hard (m/s²) ego may have to brake after the end; in terms of squares of speeds."""

_Side = str
"""Where ego is of an obstacle: behind, in_front, right, left."""

_SIDES = {
    "b": "behind",
    "f": "in_front",
    "r": "right",
    "l": "left",
    "behind": "behind",
    "in_front_of": "in_front",
    "right_of": "right",
    "left_of": "left",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivingCost:
    """What a trajectory costs.

    ``acceleration``: 0.25 for each m/s² of the greatest one, along or across. ``jerk``: 0.25 for
    each m/s³ of its mean. ``speed``: 0.1 for each m/s by which it is away from ego's, in the mean.
    ``lane``: 0.2 for each metre beside the middle of a lane, in the mean of the layers. ``goal``:
    0.5 for the whole horizon until ego is in the goal.
    """

    acceleration: float
    jerk: float
    speed: float
    lane: float
    goal: float

    @property
    def total(self) -> float:
        """The sum."""
        return self.acceleration + self.jerk + self.speed + self.lane + self.goal


@dataclass(frozen=True, slots=True)
class WitnessTrajectory:
    """States (time, s, speed along, d, speed across) at ends of pieces, in s, m and m/s.

    In between accelerations are constant.
    """

    states: tuple[tuple[float, float, float, float, float], ...]
    greatest_acceleration: float
    greatest_braking: float
    cost: DrivingCost


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """Ego's coordinate at some times, as rows over the variables and what is added to them."""

    rows: NDArray[np.float64]
    fixed: Row

    def of(self, solution: Solution) -> Row:
        return np.asarray(self.rows @ solution.values + self.fixed)


class WitnessSearch:
    """Trajectories of ego through the cells of a graph with bounds."""

    def __init__(self, graph: NavigationGraph, bounds: MotionBounds) -> None:
        self._graph, self._bounds = graph, bounds
        self._parts = max(1, ceil(graph.step_s / PIECE_S - 1e-9))
        self._piece = graph.step_s / self._parts
        self._count = self._parts * (len(graph.layers) - 1)
        ego = graph.scenario.ego
        self._motion = ego_motion(ego, bounds, graph.step_s, len(graph.layers))
        # Pieces' accelerations along and across, the greatest, changes of both, speeds' distances,
        # distances from lanes, the speed at the start.
        n, layers = self._count, len(graph.layers) - 1
        self._at = np.cumsum([0, n, n, 1, n - 1, n - 1, n, layers])
        self._size = int(self._at[-1]) + 1

    @cached_property
    def _times(self) -> Row:
        """Where others are looked at: ends and middles of pieces, multiples of 0.05 s."""
        until = self._count * self._piece
        own = np.arange(2 * self._count + 1) * self._piece / 2
        every = np.arange(int(until / CHECK_S + 1e-9) + 1) * CHECK_S
        return np.unique(np.concatenate((own, every)).round(9))

    @cached_property
    def _others(self) -> dict[str, tuple[NDArray[np.bool_], NDArray[np.float64]]]:
        """By obstacle where it is at these times, and s_min, s_max, d_min, d_max there."""
        result = {}
        for obstacle in self._graph.scenario.obstacles:
            boxes = [swept(obstacle, time, time) for time in self._times.tolist()]
            there = np.array([box is not None for box in boxes])
            if there.any():
                rows = [(b.s_min, b.s_max, b.d_min, b.d_max) if b else (0.0,) * 4 for b in boxes]
                result[obstacle.id] = there, np.array(rows)
        return result

    @cached_property
    def _body(self) -> tuple[float, float]:
        """Half of ego's length and width; 0 where such a body would stand in somebody."""
        ego = self._graph.scenario.ego
        length, width = ego.length or self._bounds.length, ego.width or self._bounds.width
        body = centred(ego.s, ego.d, length, width)
        for there, boxes in self._others.values():
            if there[0] and Box(*boxes[0].tolist()).overlaps(body):
                return ego.length / 2, ego.width / 2
        return length / 2, width / 2

    def _along(self, times: Row) -> _Places:
        ego = self._graph.scenario.ego
        places = self._places(times, 0, ego.s, 0.0)
        places.rows[:, -1] = times
        return places

    def _across(self, times: Row) -> _Places:
        ego = self._graph.scenario.ego
        return self._places(times, 1, ego.d, ego.lateral_speed)

    def _places(self, times: Row, axis: int, place: float, speed: float) -> _Places:
        starts = np.arange(self._count) * self._piece
        for_s = np.clip(times[:, None] - starts, 0.0, self._piece)
        left = np.maximum(times[:, None] - starts - for_s, 0.0)
        rows = np.zeros((len(times), self._size))
        first = int(self._at[axis])
        rows[:, first : first + self._count] = for_s**2 / 2 + for_s * left
        return _Places(rows, place + speed * times)

    def _speeds(self, axis: int) -> _Places:
        """Speeds at the ends of pieces."""
        rows = np.zeros((self._count, self._size))
        first = int(self._at[axis])
        rows[:, first : first + self._count] = np.tri(self._count) * self._piece
        sideways = self._graph.scenario.ego.lateral_speed
        rows[:, -1] = 1.0 - axis
        return _Places(rows, np.full(self._count, sideways * axis))

    def is_free(self, time: float, s: Row, d: Row) -> NDArray[np.bool_]:
        """Whether ego's body overlaps nobody at a time, at each of some places."""
        k = int(np.abs(self._times - time).argmin())
        length, width = self._body
        free = np.ones(len(s), dtype=bool)
        for there, boxes in self._others.values():
            if there[k]:
                low, high, right, left = boxes[k].tolist()
                beside = (s + length <= low) | (s - length >= high)
                free &= beside | (d + width <= right) | (d - width >= left)
        return free

    def of(self, path: Sequence[int]) -> WitnessTrajectory | None:
        """The trajectory of least cost that was found for a path; None if none was.

        If one is found so, it ends no faster than it can become as slow as who is ahead.
        """
        found, tried = self._found(path, eased=True)
        return self._found(path, eased=False)[0] if found is None and tried else found

    def _found(self, path: Sequence[int], *, eased: bool) -> tuple[WitnessTrajectory | None, bool]:
        """A trajectory, and whether it had to be eased at the end."""
        cells = [layer.cells[i] for layer, i in zip(self._graph.layers, path, strict=True)]
        program = self._program(cells)
        known: set[tuple[object, ...]] = set()
        tried = False
        for _ in range(MOST_ROUNDS):
            solution = program.solved()
            if solution is None:
                return None, tried
            cuts = [cut for cut in self._broken(solution, cells, path) if cut[0] not in known]
            if eased and not cuts:
                cuts = list(self._too_fast(solution, path))
                tried |= bool(cuts)
            if not cuts:
                return self._trajectory(solution, cells, path), tried
            known.update(name for name, *_ in cuts)
            program.add(
                np.array([row for _, row, _, _ in cuts]),
                np.array([low for _, _, low, _ in cuts]),
                np.array([high for _, _, _, high in cuts]),
            )
        return None, tried

    def _too_fast(
        self, solution: Solution, path: Sequence[int]
    ) -> Iterator[tuple[tuple[object, ...], Row, float, float]]:
        """Rows that keep ego from ending too fast for who is ahead of it then.

        With ``EASED`` it is not too fast at v, so far behind one at u, if v² <= u² + 2 EASED way,
        of which a row is a tangent.
        """
        ends = self._times[-1:]
        along, speeds = self._along(ends), self._speeds(0)
        (s,), (d,) = along.of(solution), self._across(ends).of(solution)
        v = float(speeds.of(solution)[-1])
        length, width = self._body
        for name, (there, boxes) in self._others.items():
            if not there[-2:].all() or "behind" not in self._sides(name, float(ends[0]), path):
                continue
            rear, _, right, left = boxes[-1].tolist()
            speed = float(boxes[-1, 0] - boxes[-2, 0]) / float(self._times[-1] - self._times[-2])
            in_way = right - width < d < left + width and speed >= 0
            most = speed**2 + 2 * EASED * (rear - length)
            if in_way and v > speed and v**2 + 2 * EASED * s > most + _EASED_ENOUGH:
                row = 2 * v * speeds.rows[-1] + 2 * EASED * along.rows[0]
                fixed = 2 * v * speeds.fixed[-1] + 2 * EASED * along.fixed[0]
                yield (name, "end", round(v, 2)), row, -np.inf, most + v**2 - float(fixed)

    def _program(self, cells: Sequence[Cell]) -> LinearProgram:
        at, n, motion = self._at, self._count, self._motion
        ego = self._graph.scenario.ego
        low, high = np.zeros(self._size), np.full(self._size, np.inf)
        for axis, kind in enumerate((motion.along, motion.across)):
            low[at[axis] : at[axis + 1]], high[at[axis] : at[axis + 1]] = kind.accelerations
        low[-1], high[-1] = motion.along.speeds if ego.speed is None else (ego.speed, ego.speed)
        cost = np.zeros(self._size)
        cost[at[2]] = PER_ACCELERATION
        cost[at[3] : at[5]] = PER_JERK / (n * self._piece)
        cost[at[5] : at[6]] = PER_SPEED / n
        cost[at[6] : at[7]] = PER_LANE / max(len(cells) - 1, 1)
        program = LinearProgram(cost, low, high)
        speeds = self._speeds(0)
        self._add(program, speeds, *motion.along.speeds)
        sideways = self._speeds(1)
        self._add(program, sideways, *motion.across.speeds)
        for sign in (1.0, -1.0):
            turned = _Places(
                sign * sideways.rows - motion.slope * speeds.rows, sign * sideways.fixed
            )
            self._add(program, turned, -np.inf, 1e-6)
        self._absolute(program, np.eye(self._size)[: at[2]], np.full(at[2], at[2]), 0.0)
        for axis in (0, 1):
            pieces = np.eye(self._size)[at[axis] : at[axis + 1]]
            slacks = np.arange(at[3 + axis], at[4 + axis])
            self._absolute(program, pieces[1:] - pieces[:-1], slacks, 0.0)
        wanted = speeds.rows.copy()
        wanted[:, -1] = 0.0
        self._absolute(program, wanted, np.arange(at[5], at[6]), 0.0)
        times = np.array([layer.start_s for layer in self._graph.layers[1:]])
        boxes = [cell.bounds for cell in cells[1:]]
        along, across = self._along(times), self._across(times)
        program.add(
            along.rows,
            np.array([box.s_min for box in boxes]) - along.fixed,
            np.array([box.s_max for box in boxes]) - along.fixed,
        )
        program.add(
            across.rows,
            np.array([box.d_min for box in boxes]) - across.fixed,
            np.array([box.d_max for box in boxes]) - across.fixed,
        )
        middles = np.array(list(self._middles(boxes))) - across.fixed
        self._absolute(program, across.rows, np.arange(at[6], at[7]), middles)
        return program

    def _add(self, program: LinearProgram, places: _Places, low: float, high: float) -> None:
        program.add(places.rows, low - places.fixed, high - places.fixed)

    def _absolute(
        self,
        program: LinearProgram,
        rows: NDArray[np.float64],
        slacks: NDArray[np.intp],
        wanted: float | Row,
    ) -> None:
        """Make slack variables at least the distances of rows from what is wanted."""
        own = np.zeros((len(rows), self._size))
        own[np.arange(len(rows)), slacks] = 1.0
        goal = np.zeros(len(rows)) + wanted
        unbounded = np.full(len(rows), np.inf)
        program.add(rows - own, -unbounded, goal)
        program.add(rows + own, goal, unbounded)

    def _middles(self, boxes: Sequence[Box]) -> Iterator[float]:
        """The middle of a lane for each layer: in the cell, nearest to the one before."""
        lanes = [(low + high) / 2 for low, high in pairwise(self._graph.scenario.road.lanes)]
        last = min(lanes, key=lambda d: abs(d - self._graph.scenario.ego.d))
        for box in boxes:
            inside = [d for d in lanes if box.d_min <= d <= box.d_max]
            nearest = last
            if inside:
                last = nearest = min(inside, key=lambda d: abs(d - nearest))
            yield min(max(last, box.d_min), box.d_max)

    def _broken(
        self, solution: Solution, cells: Sequence[Cell], path: Sequence[int]
    ) -> Iterator[tuple[tuple[object, ...], Row, float, float]]:
        """Rows that a solution breaks: what for, coefficients, and bounds."""
        times = np.array([layer.start_s for layer in self._graph.layers])
        along, across = self._along(times), self._across(times)
        for p, (s, d) in enumerate(zip(along.of(solution), across.of(solution), strict=True)):
            boxes = cells[p].boxes
            if len(boxes) > 1 and not any(_away(box, s, d) <= 1e-6 for box in boxes):
                box = min(boxes, key=lambda box: _away(box, s, d))
                for axis, places, low, high in (
                    ("s", along, box.s_min, box.s_max),
                    ("d", across, box.d_min, box.d_max),
                ):
                    yield (axis, p), places.rows[p], low - places.fixed[p], high - places.fixed[p]
        yield from self._overlaps(solution, path)

    def _overlaps(
        self, solution: Solution, path: Sequence[int]
    ) -> Iterator[tuple[tuple[object, ...], Row, float, float]]:
        along, across = self._along(self._times), self._across(self._times)
        s, d = along.of(solution), across.of(solution)
        length, width = self._body
        for name, (there, boxes) in self._others.items():
            # How far ego is beside, on each side; it overlaps where on all sides that is not enough
            beyond = {
                "behind": boxes[:, 0] - length - s,
                "in_front": s - boxes[:, 1] - length,
                "right": boxes[:, 2] - width - d,
                "left": d - boxes[:, 3] - width,
            }
            hit = there & (np.maximum.reduce(list(beyond.values())) < -1e-6)
            for k in np.flatnonzero(hit).tolist():
                sides = self._sides(name, float(self._times[k]), path) or set(beyond)
                side = max(sides, key=lambda side: beyond[side][k])
                # Together with those just before and after: it will be near there, too.
                for j in range(max(k - 1, 1), min(k + 2, len(s))):
                    if not there[j]:
                        continue
                    fixed = along.fixed[j] if side in ("behind", "in_front") else across.fixed[j]
                    row = along.rows[j] if side in ("behind", "in_front") else across.rows[j]
                    low, high = {
                        "behind": (-np.inf, boxes[j, 0] - length - GAP_M),
                        "in_front": (boxes[j, 1] + length + GAP_M, np.inf),
                        "right": (-np.inf, boxes[j, 2] - width - GAP_M),
                        "left": (boxes[j, 3] + width + GAP_M, np.inf),
                    }[side]
                    yield (name, side, j), row, low - fixed, high - fixed

    def _sides(self, name: str, time: float, path: Sequence[int]) -> set[_Side]:
        """On which sides of an obstacle the path's cells are around a time."""
        layer = min(int(time / self._graph.step_s + 1e-9), len(path) - 1)
        sides: set[_Side] = set()
        for p in {layer, min(layer + 1, len(path) - 1)}:
            for own, relation in self._graph.layers[p].cells[path[p]].signature.items():
                if self._graph.objects[own].id == name:
                    words = (relation,) if isinstance(relation, str) else relation
                    sides.update(_SIDES[word] for word in words if word in _SIDES)
        return sides

    def _trajectory(
        self, solution: Solution, cells: Sequence[Cell], path: Sequence[int]
    ) -> WitnessTrajectory | None:
        """The solution as a trajectory, looked through once more."""
        if next(self._broken(solution, cells, path), None) is not None:
            return None
        at = self._at
        times: Row = np.asarray(np.arange(self._count + 1) * self._piece, dtype=np.float64)
        ego = self._graph.scenario.ego
        speeds = np.concatenate(([solution.values[-1]], self._speeds(0).of(solution)))
        sideways = np.concatenate(([ego.lateral_speed], self._speeds(1).of(solution)))
        columns = (
            times,
            self._along(times).of(solution),
            speeds,
            self._across(times).of(solution),
            sideways,
        )
        states = tuple(tuple(row) for row in np.stack(columns, axis=1).round(6).tolist())
        along = solution.values[at[0] : at[1]]
        goal = self._graph.scenario.goal
        in_goal = next(
            (time for time, s, _, d, _ in states if goal is None or goal.covers(s, d)),
            times[-1],
        )

        def cost_of(per: float, first: int, last: int) -> float:
            return per * float(solution.values[at[first] : at[last]].sum())

        return WitnessTrajectory(
            states,
            max(0.0, float(along.max())),
            max(0.0, float(-along.min())),
            DrivingCost(
                acceleration=cost_of(PER_ACCELERATION, 2, 3),
                jerk=cost_of(PER_JERK / (self._count * self._piece), 3, 5),
                speed=cost_of(PER_SPEED / self._count, 5, 6),
                lane=cost_of(PER_LANE / max(len(cells) - 1, 1), 6, 7),
                goal=PER_GOAL * float(in_goal / times[-1]),
            ),
        )


def _away(box: Box, s: float, d: float) -> float:
    """How far a place is outside a rectangle."""
    return max(box.s_min - s, s - box.s_max, box.d_min - d, d - box.d_max, 0.0)

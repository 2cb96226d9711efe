"""Trajectories that prove paths drivable.

A trajectory has constant accelerations along and across the road in short pieces. A linear program
finds the one of least cost that is in the path's cells at the beginning of their layers, within the
bounds of ego's motion. Constraints that are not convex are added where a solution violates them:
the nearest rectangle of a cell, and the side of an obstacle on which ego stays, as its cells allow.
So a trajectory that is found is a proof, but one that exists may be missed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Cell
from rulec.partition.motion.least_costs import PER_ACCELERATION, PER_SPEED
from rulec.partition.motion.linear_program import Row, Solution
from rulec.partition.motion.motion_program import (
    PER_END,
    PER_HARD,
    PER_JERK,
    PER_LANE,
    MotionProgram,
)
from rulec.partition.motion.others_beside import Cut, OthersBeside, Side
from rulec.partition.motion.side_search import least_by_sides
from rulec.partition.motion.way_bounds import WayBounds
from rulec.scenario import Box, MotionBounds

MOST_ROUNDS = 25
"""The most rounds of adding rows before a path is given up."""

PER_GOAL = 0.5
"""Cost of reaching the goal only at the end of the horizon."""

_PREFERRED: Sequence[Collection[Side]] = ((), ("right", "left"), ("behind", "in_front"))
"""Preferred sides where ego may be on several sides of an obstacle, tried in this order."""

EASED, _EASED_ENOUGH = 4.0, 0.5
"""Braking (m/s²) that ego may need after the end, and the tolerance (m²/s²) of that check."""

_EVEN, _HAIR = 0.1, 1e-6
"""Precision (m/s²) of the braking that is the same before the end and after, and rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivingCost:
    """The cost of a trajectory.

    ``acceleration``: 0.25 per m/s² of the greatest one, along or across, and 4 more per m/s² above
    4. ``jerk``: 0.25 per m/s³ of its mean. ``speed``: 0.1 per m/s of the mean difference from ego's
    initial speed, and 0.1 per m/s of the difference at the end, which has to be made up for.
    ``lane``: 0.2 per metre from the middle of a lane, as the mean over the layers, and 0.1 per m/s
    across the road at the end. ``goal``: 0.5 times the part of the horizon until ego is in the
    goal.
    """

    acceleration: float
    jerk: float
    speed: float
    lane: float
    goal: float

    @property
    def total(self) -> float:
        """The sum of all parts."""
        return self.acceleration + self.jerk + self.speed + self.lane + self.goal


@dataclass(frozen=True, slots=True)
class WitnessTrajectory:
    """States (time, s, speed along, d, speed across) at the ends of pieces, in s, m and m/s.

    Accelerations are constant in between.
    """

    states: tuple[tuple[float, float, float, float, float], ...]
    greatest_acceleration: float
    greatest_braking: float
    cost: DrivingCost

    def at(self, times_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """The motion at some times (s): a row each of s, speed along, d, speed across (m, m/s)."""
        knots = np.array(self.states)
        begin = np.clip(knots[:, 0].searchsorted(times_s, "right") - 1, 0, len(knots) - 2)
        before, after = knots[begin], knots[begin + 1]
        gone, piece = times_s - before[:, 0], after[:, 0] - before[:, 0]
        gained = (after[:, (2, 4)] - before[:, (2, 4)]) / piece[:, None]
        speeds = before[:, (2, 4)] + gained * gone[:, None]
        places = before[:, (1, 3)] + (before[:, (2, 4)] + speeds) / 2 * gone[:, None]
        return np.stack((places, speeds), axis=2).reshape(len(times_s), 4)


@dataclass(frozen=True, slots=True, eq=False)
class _Attempt:
    """A path's trajectory if one was found; otherwise the rows that were added last.

    ``was_eased``: whether ego had to be slower at the end because of an obstacle ahead.
    """

    trajectory: WitnessTrajectory | None
    was_eased: bool
    cuts: Sequence[Cut]


class WitnessSearch:
    """Trajectories of ego through the cells of a graph with bounds."""

    def __init__(self, graph: NavigationGraph, bounds: MotionBounds) -> None:
        self._graph = graph
        self._motion = MotionProgram(graph, bounds)
        self._others = OthersBeside(self._motion)

    @cached_property
    def bounds(self) -> WayBounds:
        """Lower bounds on the cost of paths' beginnings."""
        return WayBounds(self._motion, self._others)

    @cached_property
    def braking_bounds(self) -> WayBounds:
        """Lower bounds on ego's hardest braking (m/s²) on paths' beginnings."""
        return WayBounds(self._motion, self._others, braking_only=True)

    def of(self, path: Sequence[int], enough: float = inf) -> WitnessTrajectory | None:
        """The trajectory of least cost found for a path; None if none was found.

        If possible, its final speed lets ego slow down to the speed of the obstacle ahead. One that
        costs no more than ``enough`` ends the search.
        """
        best: WitnessTrajectory | None = None
        tries: list[Collection[Side]] = [*_PREFERRED]
        for eased in (EASED, inf):
            again = []
            for preferred in tries:
                attempt = self._attempt(path, preferred, eased=eased)
                found = attempt.trajectory
                if found is not None and (best is None or found.cost.total < best.cost.total):
                    best = found
                    if found.cost.total <= enough:
                        return found
                if attempt.was_eased:
                    again.append(preferred)
            if best is not None:
                return best
            tries = again
        return None

    def evened(self, path: Sequence[int], known: WitnessTrajectory) -> WitnessTrajectory:
        """A trajectory of a path that brakes as hard as it has to after its end, if possible.

        ``known`` brakes harder than ``EASED``. Here what an obstacle ahead drives on while ego
        becomes as slow counts as room.
        """
        best, low, high, level = known, EASED, known.greatest_braking, EASED
        while high - low > _EVEN:
            tries = [
                self._attempt(path, sides, eased=level, meanwhile=True) for sides in _PREFERRED
            ]
            found = [one.trajectory for one in tries if one.trajectory is not None]
            fit = [one for one in found if one.greatest_braking <= level + _HAIR]
            if fit:
                best, high = min(fit, key=lambda one: one.cost.total), level
            else:
                low = level
            level = (low + high) / 2
        return best

    def by_sides(self, path: Sequence[int], below: float = inf) -> WitnessTrajectory | None:
        """A trajectory by a search over the sides of obstacles, which takes longer.

        Its cost without the goal is ``below`` this one. None if none was found.
        """
        cells = [layer.cells[i] for layer, i in zip(self._graph.layers, path, strict=True)]
        program, own = self._motion.program(), self._motion.in_cells(cells)
        program.add(own.rows, own.low, own.high)

        def further(solution: Solution) -> list[Cut]:
            return [*self._beside_cells(solution, cells), *self._too_fast(solution, path)]

        solution = least_by_sides(program, self._others, path, further, below)
        return None if solution is None else self._trajectory(solution, cells, path)

    @property
    def others(self) -> OthersBeside:
        """The obstacles during the layers, and ego's body among them."""
        return self._others

    def in_way(self, path: Sequence[int]) -> tuple[str, ...]:
        """The obstacles in ego's way along a path without a trajectory, the earliest first.

        Empty if ego's bounds alone prevent it from passing through the cells.
        """
        hits: list[tuple[int, str]] = []
        for cut in self._attempt(path, (), eased=inf).cuts:
            match cut.name:
                case (str(name), _, int(moment)):
                    hits.append((moment, name))
        return tuple(dict.fromkeys([name for _, name in sorted(hits)]))

    def _attempt(
        self,
        path: Sequence[int],
        preferred: Collection[Side],
        *,
        eased: float,
        meanwhile: bool = False,
    ) -> _Attempt:
        """A trajectory after which ego need not brake harder than ``eased`` (m/s²)."""
        cells = [layer.cells[i] for layer, i in zip(self._graph.layers, path, strict=True)]
        program, own = self._motion.program(), self._motion.in_cells(cells)
        program.add(own.rows, own.low, own.high)
        known: set[tuple[object, ...]] = set()
        cuts: list[Cut] = []
        was_eased = False
        for _ in range(MOST_ROUNDS):
            solution = program.solved()
            if solution is None:
                break
            cuts = [
                cut
                for cut in self._broken(solution, cells, path, preferred)
                if cut.name not in known
            ]
            if eased < inf and not cuts:
                cuts = list(self._too_fast(solution, path, eased, meanwhile=meanwhile))
                was_eased |= bool(cuts)
            if not cuts:
                return _Attempt(self._trajectory(solution, cells, path), was_eased, ())
            known.update(cut.name for cut in cuts)
            program.add(
                np.array([cut.row for cut in cuts]),
                np.array([cut.low for cut in cuts]),
                np.array([cut.high for cut in cuts]),
            )
        return _Attempt(None, was_eased, cuts)

    def _too_fast(
        self,
        solution: Solution,
        path: Sequence[int],
        eased: float = EASED,
        *,
        meanwhile: bool = False,
    ) -> Iterator[Cut]:
        """Rows that keep ego from being too fast at the end for an obstacle ahead of it.

        A speed v is not too fast at a distance ``way`` behind an obstacle of speed u if v² - u² <=
        2 eased way, so that ego is as slow where the obstacle is now; with ``meanwhile`` the
        obstacle's own way counts, too: (v - u)² <= 2 eased way. The row is a tangent of that.
        """
        others, times = self._others, self._others.times
        ends = times[-1:]
        along, speeds = self._motion.along(ends), self._motion.speeds(0)
        (s,), (d,) = along.of(solution), self._motion.across(ends).of(solution)
        v = float(speeds.of(solution)[-1])
        length, width = others.body
        for name, (there, boxes) in others.boxes.items():
            if not there[-2:].all() or "behind" not in others.sides(name, float(ends[0]), path):
                continue
            rear, _, right, left = boxes[-1].tolist()
            speed = others.speed_at_end(name)
            in_way = right - width < d < left + width
            # Of v² for one that is where it is, of (v - u)² for one that drives on
            moved = speed if meanwhile else 0.0
            most = speed**2 - moved**2 + 2 * eased * (rear - length)
            over = v - moved
            if in_way and v > speed and over**2 + 2 * eased * s > most + _EASED_ENOUGH:
                row = 2 * over * speeds.rows[-1] + 2 * eased * along.rows[0]
                fixed = float(2 * over * speeds.fixed[-1] + 2 * eased * along.fixed[0])
                high = most - over**2 + 2 * over * v - fixed
                yield Cut((name, "end", round(v, 2)), row, -np.inf, high)

    def _broken(
        self,
        solution: Solution,
        cells: Sequence[Cell],
        path: Sequence[int],
        preferred: Collection[Side] = (),
    ) -> Iterator[Cut]:
        """Rows that a solution violates."""
        yield from self._beside_cells(solution, cells)
        until = float(self._motion.layers_s[-1])
        yield from self._others.overlaps(solution, path, until, preferred=preferred)

    def _beside_cells(self, solution: Solution, cells: Sequence[Cell]) -> Iterator[Cut]:
        """Rows that keep ego in the nearest rectangle of cells that have several."""
        times = self._motion.layers_s
        along, across = self._motion.along(times), self._motion.across(times)
        goal, last = self._graph.scenario.goal, len(cells) - 1
        for p, (s, d) in enumerate(zip(along.of(solution), across.of(solution), strict=True)):
            boxes = cells[p].boxes
            if goal is not None and p == last and len(boxes) > 1:
                boxes = tuple([box.common(goal) for box in boxes if box.overlaps(goal)]) or boxes
            if len(cells[p].boxes) > 1 and not any(_away(box, s, d) <= 1e-6 for box in boxes):
                box = min(boxes, key=lambda box: _away(box, s, d))
                for axis, places, low, high in (
                    ("s", along, box.s_min, box.s_max),
                    ("d", across, box.d_min, box.d_max),
                ):
                    fixed = float(places.fixed[p])
                    yield Cut((axis, p), places.rows[p], low - fixed, high - fixed)

    def _trajectory(
        self, solution: Solution, cells: Sequence[Cell], path: Sequence[int]
    ) -> WitnessTrajectory | None:
        """The solution as a trajectory, checked once more; None if it violates a row."""
        if next(self._broken(solution, cells, path), None) is not None:
            return None
        motion, at = self._motion, self._motion.at
        times: Row = np.asarray(np.arange(motion.count + 1) * motion.piece, dtype=np.float64)
        ego = self._graph.scenario.ego
        speeds = np.concatenate(([solution.values[-1]], motion.speeds(0).of(solution)))
        sideways = np.concatenate(([ego.lateral_speed], motion.speeds(1).of(solution)))
        columns = (
            times,
            motion.along(times).of(solution),
            speeds,
            motion.across(times).of(solution),
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
                acceleration=cost_of(PER_ACCELERATION, 2, 3)
                + PER_HARD * float(solution.values[at[3] - 1]),
                jerk=cost_of(PER_JERK / (motion.count * motion.piece), 3, 5),
                speed=cost_of(PER_SPEED / motion.count, 5, 6)
                + PER_END * float(solution.values[at[6] - 1]),
                lane=cost_of(PER_LANE / max(len(cells) - 1, 1), 6, 7) + cost_of(PER_END, 7, 8),
                goal=PER_GOAL * float(in_goal / times[-1]),
            ),
        )


def _away(box: Box, s: float, d: float) -> float:
    """The distance (m, the larger of both axes) of a place from a rectangle; 0 inside."""
    return max(box.s_min - s, s - box.s_max, box.d_min - d, d - box.d_max, 0.0)

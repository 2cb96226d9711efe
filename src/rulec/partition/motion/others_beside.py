"""On which sides of the obstacles ego is along a path, and where a motion overlaps them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rulec.partition.motion.linear_program import LinearProgram, Row, Solution
from rulec.partition.motion.motion_program import MotionProgram, PlaceRows
from rulec.scenario import Box
from rulec.scenario.geometry import centred
from rulec.scenario.motion import swept

CHECK_S = 0.05
"""Overlaps are checked at every multiple of this (s), and twice in a piece."""

GAP_M = 0.01
"""The gap (m) that ego keeps from obstacles, for the solver's rounding."""

_HAIR_M, _FAR_M = 1e-6, 1e7

Side = str
"""Where ego is relative to an obstacle: behind, in_front, right, left."""

ALONG: Sequence[Side] = ("behind", "in_front")
ACROSS: Sequence[Side] = ("right", "left")

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


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """A row that keeps ego between bounds; cuts with equal ``name`` are the same."""

    name: tuple[object, ...]
    row: Row
    low: float
    high: float


Cuts = Mapping[tuple[object, ...], Cut]
"""Rows by their names."""


class _Closed(NamedTuple):
    """Where a part of ego, half as long and wide as these (m), must not be at the checked times.

    ``there``: at which of them. ``boxes``: s_min, s_max, d_min, d_max, a row for each time.
    """

    there: NDArray[np.bool_]
    boxes: NDArray[np.float64]
    length: float
    width: float

    def clearances(
        self, at: int | slice, along: tuple[Any, Any], across: tuple[Any, Any]
    ) -> dict[Side, Any]:
        """The greatest clearance (m) on each side, from places between bounds, at some times."""
        s_min, s_max, d_min, d_max = self.boxes[at].T
        return {
            "behind": s_min - self.length - along[0],
            "in_front": along[1] - s_max - self.length,
            "right": d_min - self.width - across[0],
            "left": across[1] - d_max - self.width,
        }


class OthersBeside:
    """The obstacles during a graph's layers, and where ego would overlap them."""

    def __init__(self, motion: MotionProgram) -> None:
        self._motion, self._graph = motion, motion.graph

    @cached_property
    def times(self) -> Row:
        """Times (s) of the checks: ends and middles of pieces, and multiples of 0.05 s."""
        count, piece = self._motion.count, self._motion.piece
        own = np.arange(2 * count + 1) * piece / 2
        every = np.arange(int(count * piece / CHECK_S + 1e-9) + 1) * CHECK_S
        return np.unique(np.concatenate((own, every)).round(9))

    @cached_property
    def along(self) -> PlaceRows:
        """Ego's place along the road at these times."""
        return self._motion.along(self.times)

    @cached_property
    def across(self) -> PlaceRows:
        """Ego's place across the road at these times."""
        return self._motion.across(self.times)

    @cached_property
    def boxes(self) -> dict[str, tuple[NDArray[np.bool_], NDArray[np.float64]]]:
        """Per obstacle: whether it is present at these times, and s_min, s_max, d_min, d_max."""
        result = {}
        for obstacle in self._graph.scenario.obstacles:
            boxes = [swept(obstacle, time, time) for time in self.times.tolist()]
            there = np.array([box is not None for box in boxes])
            if there.any():
                rows = [(b.s_min, b.s_max, b.d_min, b.d_max) if b else (0.0,) * 4 for b in boxes]
                result[obstacle.id] = there, np.array(rows)
        return result

    def speed_at_end(self, name: str) -> float:
        """An obstacle's speed (m/s) along the road at the end; 0 if it comes towards ego.

        Before one that does, ego has to be able to stop, at least.
        """
        _, boxes = self.boxes[name]
        driven = float(boxes[-1, 0] - boxes[-2, 0]) / float(self.times[-1] - self.times[-2])
        return max(driven, 0.0)

    @cached_property
    def _closed(self) -> dict[str | int, _Closed]:
        """Obstacles by id, for ego's body; what is no lane by number, for its middle."""
        length, width = self.body
        closed: dict[str | int, _Closed] = {
            name: _Closed(*own, length, width) for name, own in self.boxes.items()
        }
        scenario, count = self._graph.scenario, len(self.times)
        right, left = scenario.road.lanes[0], scenario.road.lanes[-1]
        verges = (Box(-_FAR_M, _FAR_M, right - _FAR_M, right), Box(-_FAR_M, _FAR_M, left, _FAR_M))
        for number, hole in enumerate((*scenario.road.holes(), *verges)):
            # A recorded ego may be on a lane that the map ends before
            if not hole.covers(scenario.ego.s, scenario.ego.d):
                rows = np.tile((hole.s_min, hole.s_max, hole.d_min, hole.d_max), (count, 1))
                closed[number] = _Closed(np.ones(count, dtype=bool), rows, 0.0, 0.0)
        return closed

    @cached_property
    def body(self) -> tuple[float, float]:
        """Half of ego's length and width, or its bounds' unless that body starts in an obstacle."""
        ego, bounds = self._graph.scenario.ego, self._motion.bounds
        length, width = ego.length or bounds.length, ego.width or bounds.width
        body = centred(ego.s, ego.d, length, width)
        for there, boxes in self.boxes.values():
            if there[0] and Box(*boxes[0].tolist()).overlaps(body):
                return ego.length / 2, ego.width / 2
        return length / 2, width / 2

    def overlaps(
        self,
        solution: Solution,
        path: Sequence[int],
        until: float,
        *,
        sure: bool = False,
        preferred: Collection[Side] = (),
    ) -> Iterator[Cut]:
        """Rows to add where a solution overlaps obstacles, or is beside all lanes, up to a time.

        Ego stays on a side on which the path's cells are; of several on a ``preferred`` one, then
        on the nearest. With ``sure``, only rows that every motion along the path keeps that
        overlaps nobody, because ego can get to no other side.
        """
        last = int(np.searchsorted(self.times, until + 1e-9))
        for name, beyond, hit in self._clearances(solution, last):
            there = self._closed[name].there
            for k in np.flatnonzero(hit).tolist():
                if sure:
                    possible = self.possible_sides(name, k, path)
                    if len(possible) <= 1:
                        side = max(possible or beyond, key=lambda side: beyond[side][k])
                        yield self.cut(name, side, k, gap=0.0)
                    continue
                sides = self.sides(name, float(self.times[k]), path)
                side = max(
                    sides or set(beyond), key=lambda side: (side in preferred, beyond[side][k])
                )
                # Add rows just before and after as well: the next solution will be close there too.
                for j in range(max(k - 1, 1), min(k + 2, last)):
                    if there[j]:
                        yield self.cut(name, side, j)

    def are_clear(self, s: Row, d: Row) -> NDArray[np.bool_]:
        """Which of some motions, a row of places at ``times`` each, overlap nothing."""
        clear = np.ones(len(s), dtype=bool)
        for closed in self._closed.values():
            beyond = closed.clearances(slice(None), (s, s), (d, d))
            hit = closed.there & (np.maximum.reduce(list(beyond.values())) < -_HAIR_M)
            clear &= ~hit.any(axis=1)
        return clear

    def hits(self, solution: Solution) -> Iterator[tuple[str | int, list[int]]]:
        """What a solution overlaps, obstacles or places without a lane, and the times' numbers."""
        for name, _, hit in self._clearances(solution, len(self.times)):
            numbers = np.flatnonzero(hit).tolist()
            if numbers:
                yield name, numbers

    def _clearances(
        self, solution: Solution, last: int
    ) -> Iterator[tuple[str | int, dict[Side, Row], NDArray[np.bool_]]]:
        """Ego's clearance (m) on each side of obstacles at the first ``last`` times.

        And whether none is enough, so that ego overlaps the obstacle.
        """
        along, across = self.along, self.across
        s = along.rows[:last] @ solution.values + along.fixed[:last]
        d = across.rows[:last] @ solution.values + across.fixed[:last]
        for name, closed in self._closed.items():
            beyond = closed.clearances(slice(last), (s, s), (d, d))
            hit = closed.there[:last] & (np.maximum.reduce(list(beyond.values())) < -_HAIR_M)
            yield name, beyond, hit

    def cut(self, name: str | int, side: Side, k: int, gap: float = GAP_M) -> Cut:
        """The row that keeps ego on one side of an obstacle at time number ``k``."""
        _, boxes, length, width = self._closed[name]
        places = self.along if side in ALONG else self.across
        low, high = {
            "behind": (-np.inf, boxes[k, 0] - length - gap),
            "in_front": (boxes[k, 1] + length + gap, np.inf),
            "right": (-np.inf, boxes[k, 2] - width - gap),
            "left": (boxes[k, 3] + width + gap, np.inf),
        }[side]
        fixed = float(places.fixed[k])
        return Cut((name, side, k), places.rows[k], float(low) - fixed, float(high) - fixed)

    def possible_sides(self, name: str | int, k: int, path: Sequence[int]) -> list[Side]:
        """The sides of an obstacle where ego's body may be at time number ``k``.

        Cells say where ego's middle is: ego may be behind an obstacle, and already beside it with
        its front.
        """
        along, across = self._motion.place_at(float(self.times[k]), path)
        most = self._closed[name].clearances(k, along, across)
        return [side for side, clearance in most.items() if clearance >= -_HAIR_M]

    def sides(self, name: str | int, time: float, path: Sequence[int]) -> set[Side]:
        """The sides of an obstacle on which the path's cells are around a time."""
        layer = min(int(time / self._graph.step_s + 1e-9), len(path) - 1)
        sides: set[Side] = set()
        for p in {layer, min(layer + 1, len(path) - 1)}:
            for own, relation in self._graph.layers[p].cells[path[p]].signature.items():
                if self._graph.objects[own].id == name:
                    words = (relation,) if isinstance(relation, str) else relation
                    sides.update(_SIDES[word] for word in words if word in _SIDES)
        return sides


class CutRows:
    """Rows of a program about obstacles that are switched on and off, each added once."""

    def __init__(self, program: LinearProgram) -> None:
        self._program = program
        self._rows: dict[tuple[object, ...], tuple[int, Cut]] = {}

    def switch(self, cuts: Cuts) -> None:
        """Switch these rows on, and all others off."""
        new = [cut for name, cut in cuts.items() if name not in self._rows]
        if new:
            rows = np.array([cut.row for cut in new])
            low, high = (np.array([getattr(cut, end) for cut in new]) for end in ("low", "high"))
            first = self._program.add(rows, low, high)
            self._rows |= {cut.name: (first + k, cut) for k, cut in enumerate(new)}
        if self._rows:
            own = list(self._rows.items())
            numbers = np.array([number for _, (number, _) in own])
            low = np.array([cut.low if name in cuts else -np.inf for name, (_, cut) in own])
            high = np.array([cut.high if name in cuts else np.inf for name, (_, cut) in own])
            self._program.change(numbers, low, high)

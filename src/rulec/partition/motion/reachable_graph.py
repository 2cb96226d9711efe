"""The part of a navigation graph that ego can drive.

For every cell the set of positions and speeds that ego may have there at the beginning of its layer
is computed: forward from ego's start, backward from the goals (within the scenario's goal area, if
it has one), and forward again within the remaining sets. An edge is removed if no motion leads from
one set to the other, a cell if it has no edge left. Motion along and across the road is treated
separately, joined only by ego's steering limit, and a cell is replaced by its bounding rectangle:
more may be kept than can be driven, never less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Cell, Layer, Reach
from rulec.partition.motion import reachable_sets as sets
from rulec.partition.motion.least_costs import least_costs
from rulec.partition.motion.reachable_sets import ROUNDING, AxisMotion, Sets
from rulec.scenario import Box, MotionBounds
from rulec.scenario.scenario_model import Ego

MOST_MOMENTS = 40
"""The most moments for which sets have directions; they are spread over the layers."""

_NEAR_M = 0.01
"""Cells this near to where ego may be are within its reach, more than rounding can hide."""

_Pair = tuple[Sets, Sets]
"""A pair of sets: along and across the road."""


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    """The edges from one layer to the next, by the cells at their ends."""

    origins: NDArray[np.intp]
    targets: NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class EgoMotion:
    """Motion along and across the road; ``slope`` is the greatest ratio of across to along."""

    along: AxisMotion
    across: AxisMotion
    slope: float


def ego_motion(ego: Ego, bounds: MotionBounds, step: float, layers: int) -> EgoMotion:
    """Ego's motion in layers of ``step`` (s). Bounds are widened to include its initial speeds."""
    speed, sideways = ego.speed or 0.0, abs(ego.lateral_speed)
    numbers = np.unique(np.linspace(0, layers - 1, min(layers, MOST_MOMENTS)).round())
    moments = numbers * step
    most, most_sideways = max(bounds.speed, speed), max(bounds.lateral_speed, sideways)
    lateral = bounds.lateral_acceleration
    return EgoMotion(
        AxisMotion((0.0, most), (-bounds.braking, bounds.acceleration), moments, step),
        AxisMotion((-most_sideways, most_sideways), (-lateral, lateral), moments, step),
        max(1.0, sideways / speed) if speed else 1.0 + (sideways > 0) * most_sideways,
    )


def reachable(graph: NavigationGraph, bounds: MotionBounds) -> NavigationGraph:
    """The graph without what ego, within bounds, cannot reach, or cannot leave towards a goal.

    If ego cannot be in the scenario's goal area at the end, only what it cannot reach is removed,
    and the graph has no goals.
    """
    ego, step = graph.scenario.ego, float(graph.step)
    motion = ego_motion(ego, bounds, step, len(graph.layers))
    edges = [
        _Edges(
            np.repeat(np.arange(len(rows)), list(map(len, rows))),
            np.array([target for row in rows for target in row], dtype=np.intp),
        )
        for rows in graph.successors
    ]
    times = [step * p for p in range(len(graph.layers))]
    areas = [_areas(layer.cells) for layer in graph.layers]
    own = (
        motion.along.at(ego.s, _initial_speeds(ego, motion), 0.0),
        motion.across.at(ego.d, (ego.lateral_speed, ego.lateral_speed), 0.0),
    )
    first = _alone(own, graph.start, len(graph.layers[0].cells))
    course = _Course(edges, areas, times, motion)
    forward = _forward(course, first, None)
    within = _backward(course, forward, graph.goals, graph.scenario.goal)
    final = _forward(course, first, within)
    keep = _kept(graph, edges, final)
    if not all(used.any() for used in keep):
        # Cells of goals may be reached, but not the goal area within them
        final, keep, graph = forward, forward.driven, replace(graph, goals=())
    return _without(graph, bounds, keep, final)


def cells_within_reach(
    layers: Sequence[Layer], ego: Ego, bounds: MotionBounds, step: float
) -> list[list[int]]:
    """The cells of each layer that ego, within bounds, might reach if nobody were in its way.

    This is a quick estimate, with layers of ``step`` (s): every cell that ``reachable`` keeps is
    among them.
    """
    motion = ego_motion(ego, bounds, step, len(layers))
    sideways = (ego.lateral_speed, ego.lateral_speed)
    near = []
    for p, layer in enumerate(layers):
        along = motion.along.forward((ego.s, ego.s), _initial_speeds(ego, motion), step * p)
        across = motion.across.forward((ego.d, ego.d), sideways, step * p)
        areas = _areas(layer.cells)
        beside = (areas[:, 0] <= along[1] + _NEAR_M) & (areas[:, 1] >= along[0] - _NEAR_M)
        beside &= (areas[:, 2] <= across[1] + _NEAR_M) & (areas[:, 3] >= across[0] - _NEAR_M)
        near.append(beside.nonzero()[0].tolist())
    return near


def _initial_speeds(ego: Ego, motion: EgoMotion) -> tuple[float, float]:
    return (0.0, motion.along.speeds[1]) if ego.speed is None else (ego.speed, ego.speed)


_Nodes = tuple[_Pair, NDArray[np.bool_]]
"""The sets of all cells of a layer, and which of them are not empty."""


def _areas(cells: Sequence[Cell]) -> NDArray[np.float64]:
    """Rows of s_min, s_max, d_min, d_max of the cells' bounding rectangles, slightly widened."""
    return _widened([cell.bounds for cell in cells])


def _widened(boxes: Sequence[Box]) -> NDArray[np.float64]:
    rows = [(box.s_min, box.s_max, box.d_min, box.d_max) for box in boxes]
    around = np.array(rows).reshape(-1, 4)
    return np.asarray(around + np.array([-1, 1, -1, 1]) * ROUNDING)


def _alone(own: _Pair, start: int, count: int) -> _Nodes:
    return _united(own, np.array([start]), count)


def _united(pair: _Pair, cells: NDArray[np.intp], count: int) -> _Nodes:
    """For each of ``count`` cells the hull of the sets in it."""
    along, across = (sets.together(own, cells, count) for own in pair)
    return (along, across), np.bincount(cells, minlength=count) > 0


def _common(first: _Pair, second: _Pair) -> _Pair:
    return sets.common(first[0], second[0]), sets.common(first[1], second[1])


def _rows(pair: _Pair, chosen: NDArray[np.intp] | NDArray[np.bool_]) -> _Pair:
    (s_low, s_high), (d_low, d_high) = pair
    return (s_low[chosen], s_high[chosen]), (d_low[chosen], d_high[chosen])


def _clipped(pair: _Pair, area: NDArray[np.float64], motion: EgoMotion, now: float) -> _Pair:
    """The sets intersected with areas, row by row."""
    along, across = pair
    along[0][:, 0] = np.maximum(along[0][:, 0], area[:, 0])
    along[1][:, 0] = np.minimum(along[1][:, 0], area[:, 1])
    across[0][:, 0] = np.maximum(across[0][:, 0], area[:, 2])
    across[1][:, 0] = np.minimum(across[1][:, 0], area[:, 3])
    along = motion.along.tightened(along, now)
    fastest = motion.slope * np.maximum(along[1][:, 1], 0.0) + ROUNDING
    across[0][:, 1] = np.maximum(across[0][:, 1], -fastest)
    across[1][:, 1] = np.minimum(across[1][:, 1], fastest)
    return along, motion.across.tightened(across, now)


def _stepped(pair: _Pair, motion: EgoMotion, now: float) -> _Pair:
    """The sets one step later."""
    along = motion.along.after(pair[0], now)
    across = motion.across.after(pair[1], now)
    way = motion.slope * np.maximum(along[1][:, 0] - pair[0][0][:, 0], 0.0)
    across[0][:, 0] = np.maximum(across[0][:, 0], pair[1][0][:, 0] - way)
    across[1][:, 0] = np.minimum(across[1][:, 0], pair[1][1][:, 0] + way)
    return along, across


def _something(pair: _Pair) -> NDArray[np.bool_]:
    return sets.anything_in(pair[0]) & sets.anything_in(pair[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """The sets of each layer, and which edges some motion takes."""

    nodes: list[_Nodes]
    driven: list[NDArray[np.bool_]]


@dataclass(frozen=True, slots=True, eq=False)
class _Course:
    """Common data: edges, bounding rectangles of cells, times of layers, and ego's motion."""

    edges: Sequence[_Edges]
    areas: Sequence[NDArray[np.float64]]
    times: Sequence[float]
    motion: EgoMotion


def _forward(course: _Course, first: _Nodes, within: Sequence[_Nodes] | None) -> _Way:
    edges, areas, times, motion = course.edges, course.areas, course.times, course.motion
    nodes, driven = [first], []
    for p, row in enumerate(edges):
        pair, there = nodes[-1]
        used = there[row.origins]
        if within is not None:
            used &= within[p + 1][1][row.targets]
        chosen = np.flatnonzero(used)
        origins, targets = row.origins[chosen], row.targets[chosen]
        # One step for each cell, not for each of its edges.
        cells, of_cell = np.unique(origins, return_inverse=True)
        stepped = _rows(_stepped(_rows(pair, cells), motion, times[p]), of_cell)
        reached = _clipped(stepped, areas[p + 1][targets], motion, times[p + 1])
        if within is not None:
            reached = _common(reached, _rows(within[p + 1][0], targets))
        some = _something(reached)
        taken = np.zeros(len(row.origins), dtype=bool)
        taken[chosen[some]] = True
        driven.append(taken)
        nodes.append(_united(_rows(reached, some), targets[some], len(areas[p + 1])))
    return _Way(nodes, driven)


def _backward(
    course: _Course, forward: _Way, goals: Sequence[int], within: Box | None
) -> list[_Nodes]:
    """The subsets from which a goal can be reached, ``within`` an area if there is one."""
    edges, times, motion = course.edges, course.times, course.motion
    pair, there = forward.nodes[-1]
    goal = np.zeros(len(there), dtype=bool)
    goal[list(goals)] = True
    goal &= there
    if within is not None:
        cells = np.flatnonzero(goal)
        clipped = _clipped(_rows(pair, cells), _widened([within]), motion, times[-1])
        some = _something(clipped)
        pair, goal = _united(_rows(clipped, some), cells[some], len(goal))
    result = [(pair, goal)]
    for p in reversed(range(len(edges))):
        row, (ahead, alive) = edges[p], result[-1]
        chosen = np.flatnonzero(forward.driven[p] & alive[row.targets])
        origins, targets = row.origins[chosen], row.targets[chosen]
        cells, of_cell = np.unique(targets, return_inverse=True)
        later = _rows(ahead, cells)
        earlier = motion.along.before(later[0], times[p]), motion.across.before(later[1], times[p])
        both = _common(_rows(earlier, of_cell), _rows(forward.nodes[p][0], origins))
        some = _something(both)
        count = len(forward.nodes[p][1])
        result.append(_united(_rows(both, some), origins[some], count))
    return result[::-1]


def _kept(graph: NavigationGraph, edges: Sequence[_Edges], final: _Way) -> list[NDArray[np.bool_]]:
    """Masks, layer by layer, of the edges on a path of driven edges from the start to a goal."""
    alive = np.zeros(len(graph.layers[-1].cells), dtype=bool)
    alive[list(graph.goals)] = True
    alive &= final.nodes[-1][1]
    kept = []
    for row, driven, (_, there) in zip(
        edges[::-1], final.driven[::-1], final.nodes[-2::-1], strict=True
    ):
        edge = driven & alive[row.targets]
        kept.append(edge)
        alive = there & (np.bincount(row.origins[edge], minlength=len(there)) > 0)
    return kept[::-1]


def _without(
    graph: NavigationGraph,
    bounds: MotionBounds,
    kept: Sequence[NDArray[np.bool_]],
    final: _Way,
) -> NavigationGraph:
    """The graph with only these edges and the cells at their ends."""
    edge_rows = [_by_origin(rows, keep) for rows, keep in zip(graph.successors, kept, strict=True)]
    ends: list[set[int]] = [{graph.start}]
    for rows, used in zip(graph.successors, edge_rows, strict=True):
        ends.append({j for row, use in zip(rows, used, strict=True) for j in compress(row, use)})
    numbers = [{old: new for new, old in enumerate(sorted(here))} for here in ends]
    layers = tuple(
        _only(layer, number) for layer, number in zip(graph.layers, numbers, strict=True)
    )
    successors, margins = [], []
    for p, used in enumerate(edge_rows):
        onward = numbers[p + 1]
        successors.append(
            tuple(
                tuple(onward[j] for j in compress(graph.successors[p][i], used[i]))
                for i in numbers[p]
            )
        )
        margins.append(tuple(tuple(compress(graph.margins[p][i], used[i])) for i in numbers[p]))
    reach = tuple(
        tuple(_reach(pair, i) if there[i] else None for i in number)
        for number, (pair, there) in zip(numbers, final.nodes, strict=True)
    )
    return replace(
        graph,
        bounds=bounds,
        reach=reach,
        driving=least_costs(graph.scenario.ego, reach, graph.step_s),
        layers=layers,
        successors=tuple(successors),
        margins=tuple(margins),
        start=numbers[0][graph.start],
        goals=tuple(numbers[-1][goal] for goal in graph.goals if goal in numbers[-1]),
    )


def _by_origin(rows: Sequence[Sequence[int]], kept: NDArray[np.bool_]) -> list[list[bool]]:
    used = iter(kept.tolist())
    return [[next(used) for _ in row] for row in rows]


def _only(layer: Layer, number: dict[int, int]) -> Layer:
    return replace(
        layer,
        cells=tuple(layer.cells[i] for i in number),
        neighbours=tuple(
            tuple(number[j] for j in layer.neighbours[i] if j in number) for i in number
        ),
    )


def _reach(pair: _Pair, i: int) -> Reach:
    (s_low, s_high), (d_low, d_high) = pair
    along, across = (
        [(float(low[i, k]), float(high[i, k])) for k in (0, 1)]
        for low, high in ((s_low, s_high), (d_low, d_high))
    )
    return Reach(along[0], across[0], along[1], across[1])

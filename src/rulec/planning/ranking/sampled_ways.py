"""Paths along which a sampled motion of ego goes, the cheapest first.

Where those that cost least by their cells cannot be driven, as close behind one that cuts in, it
takes long to come by one that can. So motions are sampled: a few accelerations along the road in
each layer, towards the middles of lanes beside each other, as long as ego overlaps nobody and is in
cells of the product. Of those alike only the cheapest go on. What is found is no proof yet.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Generic

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.partition.motion.least_costs import PER_ACCELERATION, PER_SPEED
from rulec.planning.product.graph_product import Memory, Product, ProductNode
from rulec.planning.ranking.cheapest import Maneuver, costs_to_come, maneuver

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph
    from rulec.partition.motion.witness_trajectory import WitnessSearch
    from rulec.scenario import MotionBounds

Floats = NDArray[float64]

_ACCELERATIONS = (-1.0, -0.75, -0.5, -0.35, -0.2, -0.1, 0.0, 0.1, 0.25, 0.5)
"""Parts of the greatest braking and acceleration."""

_PIECE_S, _TURNS_S = 0.05, 0.8
"""Others are looked at so often; ego would be in the middle of a lane after so long."""

_ALIKE_MPS, _ALIKE_M = 1.5, 1.5
_MOST_ALIKE, _MOST = 2, 160


@dataclass(frozen=True, slots=True, eq=False)
class _Motions(Generic[Memory]):
    """Motions up to a layer, a row each: s, v, d, w, the greatest acceleration, and the cost."""

    rows: Floats
    paths: list[tuple[int, ...]]
    nodes: list[ProductNode[Memory]]
    spent: list[int]


def sampled_ways(
    product: Product[Memory], graph: NavigationGraph, search: WitnessSearch
) -> Iterator[Maneuver]:
    """Accepted paths with a motion along them, each once, as they cost by their motions."""
    to_come = costs_to_come(product)
    ego, bounds = graph.scenario.ego, graph.bounds
    starts = [node for node in product.counts[0] if node in to_come[0]]
    if bounds is None or not starts or not product.ends:
        return
    row = (ego.s, ego.speed or 0.0, ego.d, ego.lateral_speed, 0.0, 0.0)
    motions = _Motions(np.array([row]), [(starts[0][0],)], [starts[0]], [0])
    for p in range(len(graph.layers) - 1):
        followed = _followed(motions, p, graph, bounds, search)
        motions = _kept(followed, motions, p, graph, product, alive=to_come[p + 1])
        if not len(motions.rows):
            return
    known = set[tuple[int, ...]]()
    unit = float(product.graph.cost_unit)
    total = motions.rows[:, 5] + np.array(motions.spent) * unit
    for number in np.argsort(total, kind="stable").tolist():
        path = motions.paths[number]
        if motions.nodes[number] in product.ends and path not in known:
            known.add(path)
            yield maneuver(product.graph, path, motions.spent[number])


def _followed(
    motions: _Motions[Memory],
    p: int,
    graph: NavigationGraph,
    bounds: MotionBounds,
    search: WitnessSearch,
) -> tuple[Floats, NDArray[np.intp]]:
    """Each motion one layer on, in all ways that overlap nobody, with the numbers of origins."""
    parts = np.array(_ACCELERATIONS)
    gains = np.where(parts < 0, parts * bounds.braking, parts * bounds.acceleration)
    middles = np.array([(low + high) / 2 for low, high in pairwise(graph.scenario.road.lanes)])
    count = len(motions.rows)
    nearest = np.abs(motions.rows[:, 2, None] - middles).argmin(axis=1)
    aims = np.clip(nearest[:, None] + np.array([0, -1, 1]), 0, len(middles) - 1)
    origin = np.repeat(np.arange(count), len(gains) * 3)
    a = np.tile(np.repeat(gains, 3), count)
    aim = middles[np.repeat(aims[:, None], len(gains), axis=1).ravel()]
    s, v, d, w, most, cost = motions.rows[origin].T
    pieces = max(1, round(graph.step_s / _PIECE_S))
    dt = graph.step_s / pieces
    free = np.ones(len(s), dtype=bool)
    start, speed = graph.layers[p].start_s, graph.scenario.ego.speed or 0.0
    slope = np.zeros(len(s))
    top = max(bounds.speed, speed)
    for k in range(pieces):
        ahead = np.clip(a, -v / dt, (top - v) / dt)
        s, v = s + v * dt + ahead * dt**2 / 2, np.maximum(v + ahead * dt, 0.0)
        side = np.minimum(bounds.lateral_speed, v)
        wanted = np.clip((aim - d) / _TURNS_S, -side, side)
        b = np.clip((wanted - w) / dt, -bounds.lateral_acceleration, bounds.lateral_acceleration)
        d, w = d + w * dt + b * dt**2 / 2, w + b * dt
        slope = np.maximum(slope, np.abs(ahead))
        free &= search.is_free(start + (k + 1) * dt, s, d)
    most = np.maximum(most, slope)
    share = 1.0 / max(len(graph.layers) - 1, 1)
    cost = cost + PER_SPEED * np.abs(v - speed) * share
    rows = np.column_stack((s, v, d, w, most, cost))
    return rows[free], origin[free]


def _kept(
    followed: tuple[Floats, NDArray[np.intp]],
    before: _Motions[Memory],
    p: int,
    graph: NavigationGraph,
    product: Product[Memory],
    *,
    alive: dict[ProductNode[Memory], int],
) -> _Motions[Memory]:
    """Those in a cell that follows, of those alike the cheapest."""
    rows, origins = followed
    order = np.argsort(rows[:, 5] + PER_ACCELERATION * rows[:, 4], kind="stable")
    layer, reach = graph.layers[p + 1], graph.reach[p + 1]
    alike: dict[object, int] = {}
    found: _Motions[Memory] = _Motions(np.zeros((0, 6)), [], [], [])
    kept = []
    for number in order.tolist():
        s, v, d = rows[number, :3].tolist()
        origin = int(origins[number])
        for step, cost in product.steps[p][before.nodes[origin]]:
            own = reach[step[0]]
            if step not in alive or own is None:
                continue
            if not own.s[0] <= s <= own.s[1] or not own.speed[0] <= v <= own.speed[1]:
                continue
            boxes = layer.cells[step[0]].boxes
            if not any(b.s_min <= s <= b.s_max and b.d_min <= d <= b.d_max for b in boxes):
                continue
            key = step, round(v / _ALIKE_MPS), round(s / _ALIKE_M), round(d / _ALIKE_M)
            if alike.setdefault(key, 0) >= _MOST_ALIKE:
                continue
            alike[key] += 1
            kept.append(number)
            found.paths.append((*before.paths[origin], step[0]))
            found.nodes.append(step)
            found.spent.append(before.spent[origin] + cost)
    chosen = _spread(rows[kept], _MOST)
    return _Motions(
        rows[kept][chosen],
        [found.paths[k] for k in chosen],
        [found.nodes[k] for k in chosen],
        [found.spent[k] for k in chosen],
    )


def _spread(rows: Floats, most: int) -> list[int]:
    """So many rows, in turns of different speeds and places across, each time the cheapest."""
    turns: dict[tuple[int, int], int] = {}
    ranked = []
    for number, (_, v, d, *_) in enumerate(rows.tolist()):
        key = round(v / _ALIKE_MPS), round(d / _ALIKE_M)
        turns[key] = turns.get(key, 0) + 1
        ranked.append((turns[key], number))
    return [number for _, number in sorted(ranked)[:most]]

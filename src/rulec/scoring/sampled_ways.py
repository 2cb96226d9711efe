"""Ways that ego may drive in a recorded scene, each with the maneuver that it belongs to.

What it was recorded to do, and steady accelerations, for as long as the scene goes on or for a
short while, in ego's place across the road, or to the middle of its lane or of a lane beside it.
These are within ego's bounds of motion, overlap no obstacle, and pass through the graph's cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, inf

import numpy as np

from rulec.array_types import Floats
from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.motion.others_beside import OthersBeside
from rulec.scenario.recorded.scene_origin import SceneOrigin

_ACCELERATIONS_MPS2 = (0.0, -0.5, 0.5, -1.0, 1.0, -2.0, -3.0, -5.0)
_FOR_S = (inf, 2.0)
"""How long ego accelerates or brakes."""

_TO_OWN_S, _TO_NEXT_S = 3.0, 4.0
"""How long (s) ego takes to the middle of its lane, and of the next one."""

_KNOT_S = 0.05
"""Between times this far apart motions are interpolated."""

_GREATEST_LATERAL = 10 / 3**0.5
"""The greatest acceleration of a way aside with a smooth beginning and end, for 1 m in 1 s."""

_HAIR_M = 1e-6

_AROUND_M = 20.0
"""Recorded places are looked for this near (m) to how far ego has driven along the road."""


@dataclass(frozen=True, slots=True, eq=False)
class SampledWay:
    """A motion (a row a time: s, speed along, d, speed across; in m, m/s) and its maneuver."""

    times_s: Floats
    motion: Floats
    nodes: tuple[int, ...]

    def at(self, times_s: Floats) -> Floats:
        """The motion at some times (s)."""
        return np.stack([np.interp(times_s, self.times_s, own) for own in self.motion.T], axis=1)

    def rows_at(self, times_s: Sequence[float]) -> list[list[float]]:
        """Each time with the motion, to a millimetre (per second)."""
        rows: list[list[float]] = self.at(np.array(times_s)).round(3).tolist()
        return [[time_s, *row] for time_s, row in zip(times_s, rows, strict=True)]


def sampled_ways(graph: NavigationGraph, others: OthersBeside) -> list[SampledWay]:
    """The ways through a graph with bounds of motion, the gentlest first."""
    horizon_s = (len(graph.layers) - 1) * graph.step_s
    times_s = np.linspace(0.0, horizon_s, ceil(horizon_s / _KNOT_S) + 1)
    motions = _motions(graph, times_s)
    if not motions:
        return []
    ways = np.array(motions)
    s, d = (np.array([np.interp(others.times, times_s, way[:, k]) for way in ways]) for k in (0, 2))
    clear = ways[others.are_clear(s, d)]
    layers_s = [layer.start_s for layer in graph.layers]
    found = []
    for motion in clear:
        places = [np.interp(layers_s, times_s, motion[:, k]) for k in (0, 2)]
        nodes = _nodes(graph, *places)
        if nodes is not None:
            found.append(SampledWay(times_s, motion, nodes))
    return found


def recorded_way(graph: NavigationGraph, origin: SceneOrigin) -> SampledWay | None:
    """What ego was recorded to do until the horizon; None if it is not, or not in the cells."""
    recording, start, line = origin.recording, origin.start, origin.line
    layers_s = np.array([layer.start_s for layer in graph.layers])
    last = start.step + ceil(layers_s[-1] / recording.step_s - _HAIR_M)
    wanted = range(start.step, last + 1)
    body = next((own for own in recording.participants if own.id == start.participant), None)
    if body is None or not all(step in body.states for step in wanted):
        return None
    states = [body.states[step] for step in wanted]
    places = np.array([(state.x, state.y) for state in states])
    driven = np.append(0.0, np.hypot(*np.diff(places, axis=0).T).cumsum())
    near = np.full(len(places), _AROUND_M)
    along = line.coordinates_near(places, origin.ego_s + driven, near)
    if np.isnan(along).any():
        return None
    s, (d,) = along[:, 0] - origin.ego_s, origin.lanes.straightened(along).T
    times_s: Floats = np.arange(len(places), dtype=np.float64) * recording.step_s
    motion = np.stack((s, np.gradient(s, times_s), d, np.gradient(d, times_s)), axis=1)
    nodes = _nodes(graph, *(np.interp(layers_s, times_s, own) for own in (s, d)))
    return None if nodes is None else SampledWay(times_s, motion, nodes)


def _motions(graph: NavigationGraph, times_s: Floats) -> list[Floats]:
    """Motions within ego's bounds, a row a time, the gentlest first."""
    ego, bounds = graph.scenario.ego, graph.bounds
    if bounds is None or ego.speed is None:
        return []
    lanes = np.array(graph.scenario.road.lanes)
    middles = (lanes[1:] + lanes[:-1]) / 2
    own = int(np.clip(lanes.searchsorted(ego.d, "right") - 1, 0, len(middles) - 1))
    targets = [(ego.d, _TO_OWN_S), (float(middles[own]), _TO_OWN_S)]
    targets += [
        (float(middles[k]), _TO_NEXT_S) for k in (own - 1, own + 1) if k in range(len(middles))
    ]
    step_s, found = times_s[1] - times_s[0], []
    for (place_m, to_s), gains, for_s in product(targets, _ACCELERATIONS_MPS2, _FOR_S):
        aside_m = place_m - ego.d
        too_hard = not -bounds.braking <= gains <= bounds.acceleration
        too_hard |= abs(aside_m) * _GREATEST_LATERAL / to_s**2 > bounds.lateral_acceleration
        if too_hard or (gains == 0 and for_s < inf):
            continue
        speed = np.clip(ego.speed + gains * np.minimum(times_s, for_s), 0.0, bounds.speed)
        part = np.clip(times_s / to_s, 0.0, 1.0)
        across = aside_m / to_s * 30 * part**2 * (1 - part) ** 2
        # Ego goes on aside, as it began, until it has become steady
        across += ego.lateral_speed * np.clip(1 - times_s, 0.0, 1.0)
        if (np.abs(across) > np.minimum(speed, bounds.lateral_speed) + _HAIR_M).any():
            continue
        s, d = (
            begin + np.append(0.0, ((own[1:] + own[:-1]) / 2 * step_s).cumsum())
            for begin, own in ((ego.s, speed), (ego.d, across))
        )
        found.append(np.stack((s, speed, d, across), axis=1))
    return sorted(found, key=_effort)


def _effort(motion: Floats) -> float:
    """How much ego changes its speed, along and across the road (m/s)."""
    return float(np.abs(np.diff(motion[:, (1, 3)], axis=0)).sum())


def _nodes(graph: NavigationGraph, s: Floats, d: Floats) -> tuple[int, ...] | None:
    """The path of cells with a place in each layer; None if there is none to a goal."""
    paths: dict[int, tuple[int, ...]] = {graph.start: (graph.start,)}
    for layer, rows, *place in zip(
        graph.layers[1:], graph.successors, s[1:].tolist(), d[1:].tolist(), strict=True
    ):
        after: dict[int, tuple[int, ...]] = {}
        for cell, path in paths.items():
            for number in rows[cell]:
                boxes = layer.cells[number].boxes
                if number not in after and any(box.covers(*place) for box in boxes):
                    after[number] = (*path, number)
        paths = after
    return next((path for cell, path in paths.items() if cell in graph.goals), None)

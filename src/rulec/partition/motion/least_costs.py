"""What driving into a cell costs at least, whatever trajectory leads there."""

from __future__ import annotations

from fractions import Fraction

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_model import Reach
from rulec.scenario.scenario_model import Ego

PER_ACCELERATION = 0.25
"""What a greatest acceleration of 1 m/s² costs."""

PER_SPEED = 0.1
"""What a mean distance of 1 m/s from ego's speed costs."""


def least_costs(graph: NavigationGraph, unit: Fraction) -> list[list[int]]:
    """For each cell of each layer a share of the least cost of trajectories there, in units.

    Who is away from where ego gets at its speed after t seconds, by x m, has accelerated by
    2 x / t² at some time and was faster or slower by x / t in the mean. A path costs at least what
    each of its cells tells, and so their mean, of which each has its share.
    """
    last = len(graph.layers) - 1
    horizon = last * graph.step_s
    share = 1 / (last * float(unit)) if last else 0.0
    return [
        [
            int(share * _least(graph.scenario.ego, reach, layer.start_s, horizon))
            for reach in reaches
        ]
        for layer, reaches in zip(graph.layers, graph.reach, strict=True)
    ]


def _least(ego: Ego, reach: Reach | None, time: float, horizon: float) -> float:
    if reach is None or not time:
        return 0.0
    across = _outside(ego.d + ego.lateral_speed * time, reach.d)
    along = 0.0 if ego.speed is None else _outside(ego.s + ego.speed * time, reach.s)
    acceleration = 2 * max(along, across) / time**2
    return PER_ACCELERATION * acceleration + PER_SPEED * along / horizon


def _outside(place: float, interval: tuple[float, float]) -> float:
    return max(interval[0] - place, place - interval[1], 0.0)

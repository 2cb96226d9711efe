"""Lower bounds on the cost of driving into a cell."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.partition.cells.cell_model import Reach
from rulec.scenario.scenario_model import Ego

PER_ACCELERATION = 0.25
"""What a greatest acceleration of 1 m/s² costs."""

PER_SPEED = 0.1
"""What a mean distance of 1 m/s from ego's speed costs."""


def least_costs(
    ego: Ego, reach: Sequence[Sequence[Reach | None]], step: float
) -> tuple[tuple[float, ...], ...]:
    """For each cell of each layer a share of the least cost of trajectories there.

    Who is away from where ego gets at its speed after t seconds, by x m, has accelerated by
    2 x / t² at some time and was faster or slower by x / t in the mean. A path costs at least what
    each of its cells tells, and so their mean, of which each has its share.
    """
    last = max(len(reach) - 1, 1)
    return tuple(
        tuple(_least(ego, own, p * step, last * step) / last for own in row)
        for p, row in enumerate(reach)
    )


def _least(ego: Ego, reach: Reach | None, time: float, horizon: float) -> float:
    if reach is None or not time:
        return 0.0
    across = _outside(ego.d + ego.lateral_speed * time, reach.d)
    along = 0.0 if ego.speed is None else _outside(ego.s + ego.speed * time, reach.s)
    acceleration = 2 * max(along, across) / time**2
    return PER_ACCELERATION * acceleration + PER_SPEED * along / horizon


def _outside(place: float, interval: tuple[float, float]) -> float:
    return max(interval[0] - place, place - interval[1], 0.0)

"""Lower bounds on the cost of driving into a cell."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.partition.cells.cell_model import Reach
from rulec.scenario.scenario_model import Ego

PER_ACCELERATION = 0.25
"""Cost per m/s² of the greatest acceleration."""

PER_SPEED = 0.1
"""Cost per m/s of the mean difference from ego's initial speed."""


def least_costs(
    ego: Ego, reach: Sequence[Sequence[Reach | None]], step: float
) -> tuple[tuple[float, ...], ...]:
    """Shares, per layer and cell, of lower bounds on the cost of trajectories through the cell.

    A trajectory that after t seconds is x m away from where ego's initial speed leads has
    accelerated by at least 2 x / t² at some time, and its mean speed differs by x / t. A path costs
    at least the bound of each of its cells, hence at least their mean; a cell's share is its bound
    divided by the number of steps.
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

"""Motions of ego within bounds, sampled: double integrators along and across the road."""

import random
from dataclasses import replace
from itertools import pairwise

STEPS = 10
"""Accelerations change so many times in a layer."""


class Limits:
    """What ego can do within bounds, whatever is asked for."""

    def __init__(self, ego, bounds):
        speed = ego.speed or 0.0
        self._bounds = bounds
        self._slope = max(1.0, abs(ego.lateral_speed) / speed if speed else 1.0)
        self._top, self._side = (
            max(bounds.speed, speed),
            max(bounds.lateral_speed, abs(ego.lateral_speed)),
        )

    def after(self, state, along, across, dt):
        """Place and speed (s, v, d, w) after a piece of these accelerations, as far as may be."""
        (s, v, d, w), bounds = state, self._bounds
        along = min(max(along, -bounds.braking), bounds.acceleration)
        ahead = min(max(along, -v / dt), (self._top - v) / dt)
        # Sideways no faster than ahead, at the end of the piece as at its beginning.
        most = min(self._side, self._slope * (v + ahead * dt))
        least = max(-bounds.lateral_acceleration, (-most - w) / dt)
        greatest = min(bounds.lateral_acceleration, (most - w) / dt)
        if least > greatest:
            # Too slow to straighten: brake less, as it may.
            ahead, least, greatest = 0.0, 0.0, 0.0
        sideways = min(max(across, least), greatest)
        s, v = s + v * dt + ahead * dt * dt / 2, v + ahead * dt
        return s, v, d + w * dt + sideways * dt * dt / 2, w + sideways * dt


def driven(ego, bounds, step, layers, chance: random.Random, pieces=STEPS):
    """Places and speeds (s, v, d, w) when layers begin; whatever is asked for, within bounds.

    In so many pieces a layer.
    """
    speed = chance.uniform(0, bounds.speed) if ego.speed is None else ego.speed
    limits = Limits(replace(ego, speed=speed), bounds)
    state = ego.s, speed, ego.d, ego.lateral_speed
    states = [state]
    # Motions that keep to something for long reach the bounds, those that change do not.
    hold = chance.choice([1, 3, STEPS, 4 * STEPS])
    a = b = 0.0
    for k in range((layers - 1) * pieces):
        if k % hold == 0:
            pick = chance.choice([chance.uniform, lambda low, high: chance.choice([low, high, 0])])
            a = pick(-bounds.braking, bounds.acceleration)
            b = pick(-bounds.lateral_acceleration, bounds.lateral_acceleration)
        state = limits.after(state, a, b, step / pieces)
        if (k + 1) % pieces == 0:
            states.append(state)
    return states


def cells_of(layer, s, d):
    """The cells of a layer whose closure holds a place."""
    return {
        i
        for i, cell in enumerate(layer.cells)
        if any(b.s_min <= s <= b.s_max and b.d_min <= d <= b.d_max for b in cell.boxes)
    }


def is_free(graph, k, pieces, s, d):
    """Whether a place is in a cell after ``k`` pieces, of which a layer has ``pieces``.

    At the end of a layer it has to be in a cell of that one, too.
    """
    ends = (k // pieces, (k - 1) // pieces) if k else (0,)
    return all(cells_of(graph.layers[p], s, d) for p in {*ends})


def paths_of(graph, states):
    """Cells, layer by layer, on paths of the graph on which a motion is when layers begin.

    None if it leaves them, or does not end in the scenario's goal.
    """
    here = [{graph.start}]
    for p, (s, _, d, _) in enumerate(states[1:], 1):
        there = cells_of(graph.layers[p], s, d)
        here.append({j for i in here[-1] for j in graph.successors[p - 1][i] if j in there})
        if not here[-1]:
            return None
    (s, _, d, _), goal = states[-1], graph.scenario.goal
    if goal is not None and not goal.covers(s, d):
        return None
    here[-1] &= set(graph.goals)
    for p, (before, after) in reversed(list(enumerate(pairwise(here)))):
        before &= {i for i in before if after & set(graph.successors[p][i])}
    return here if here[0] else None

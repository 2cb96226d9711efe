"""Motions of ego within bounds, sampled: double integrators along and across the road."""

import random
from itertools import pairwise

STEPS = 10
"""Accelerations change so many times in a layer."""


def driven(ego, bounds, step, layers, chance: random.Random, pieces=STEPS):
    """Places and speeds (s, v, d, w) when layers begin; whatever is asked for, within bounds.

    In so many pieces a layer.
    """
    speed = chance.uniform(0, bounds.speed) if ego.speed is None else ego.speed
    s, v, d, w = ego.s, speed, ego.d, ego.lateral_speed
    slope = max(1.0, abs(w) / v if v else 1.0)
    top, side = max(bounds.speed, v), max(bounds.lateral_speed, abs(w))
    states = [(s, v, d, w)]
    dt = step / pieces
    # Motions that keep to something for long reach the bounds, those that change do not.
    hold = chance.choice([1, 3, STEPS, 4 * STEPS])
    a = b = 0.0
    for k in range((layers - 1) * pieces):
        if k % hold == 0:
            pick = chance.choice([chance.uniform, lambda low, high: chance.choice([low, high, 0])])
            a = pick(-bounds.braking, bounds.acceleration)
            b = pick(-bounds.lateral_acceleration, bounds.lateral_acceleration)
        ahead = min(max(a, -v / dt), (top - v) / dt)
        # Sideways no faster than ahead, at the end of the piece as at its beginning.
        most = min(side, slope * (v + ahead * dt))
        least = max(-bounds.lateral_acceleration, (-most - w) / dt)
        greatest = min(bounds.lateral_acceleration, (most - w) / dt)
        if least > greatest:
            # Too slow to straighten: brake less, as it may.
            ahead, least, greatest = 0.0, 0.0, 0.0
        sideways = min(max(b, least), greatest)
        s, v = s + v * dt + ahead * dt * dt / 2, v + ahead * dt
        d, w = d + w * dt + sideways * dt * dt / 2, w + sideways * dt
        if (k + 1) % pieces == 0:
            states.append((s, v, d, w))
    return states


def cells_of(layer, s, d):
    """The cells of a layer whose closure holds a place."""
    return {
        i
        for i, cell in enumerate(layer.cells)
        if any(b.s_min <= s <= b.s_max and b.d_min <= d <= b.d_max for b in cell.boxes)
    }


def paths_of(graph, states):
    """Cells, layer by layer, on paths of the graph on which a motion is when layers begin."""
    here = [{graph.start}]
    for p, (s, _, d, _) in enumerate(states[1:], 1):
        there = cells_of(graph.layers[p], s, d)
        here.append({j for i in here[-1] for j in graph.successors[p - 1][i] if j in there})
        if not here[-1]:
            return None
    here[-1] &= set(graph.goals)
    for p, (before, after) in reversed(list(enumerate(pairwise(here)))):
        before &= {i for i in before if after & set(graph.successors[p][i])}
    return here if here[0] else None

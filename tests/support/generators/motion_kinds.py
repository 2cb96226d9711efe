"""Motions of ego as drivers drive: lanes changed and given up, stops, weaving, following close."""

import random
from itertools import pairwise
from math import sin, tau

from rulec.scenario.motion import swept
from support.generators.driven_motions import Limits, driven

KINDS = (
    "at its bounds",
    "changes lane",
    "gives a change up",
    "weaves",
    "brakes hard",
    "stops",
    "creeps",
    "follows",
    "stays beside",
    "swerves",
)

_PIECES = 2
_GAIN = 1.5


def of_a_kind(kind, scenario, bounds, step, layers, chance: random.Random):
    """Places and speeds (s, v, d, w) when layers begin, of a motion within bounds."""
    ego = scenario.ego
    if kind == "at its bounds":
        return driven(ego, bounds, step, layers, chance, _PIECES)
    along, across = _wanted(kind, scenario, bounds, step * (layers - 1), chance)
    limits, state = Limits(ego, bounds), (ego.s, ego.speed or 0.0, ego.d, ego.lateral_speed)
    states, dt = [state], step / _PIECES
    for k in range((layers - 1) * _PIECES):
        s, v, d, w = state
        state = limits.after(state, along(k * dt, s, v), across(k * dt, d, w), dt)
        if (k + 1) % _PIECES == 0:
            states.append(state)
    return states


def _wanted(kind, scenario, bounds, horizon, chance):
    """The accelerations along and across the road that are asked for at a time, place and speed."""
    ego, lanes = scenario.ego, scenario.road.lanes
    own, quick = ego.speed or 0.0, chance.choice([0.5, 1.0, 1.5, 2.5])
    begin, lasts = chance.uniform(0.0, horizon), chance.uniform(0.3, 3.0)
    speed = max(own + chance.choice([0.0, 0.0, chance.uniform(-4.0, 4.0)]), 0.0)
    aside = chance.choice([0.0, chance.uniform(-0.6, 0.6)])

    def keeps(_, __, v):
        return _GAIN * (speed - v)

    def to(place):
        return lambda t, d, w: quick**2 * (place(t) - d) - 2 * quick * w

    def during(t):
        return begin <= t < begin + lasts

    def along(t, s, v):
        return -chance.uniform(4.0, bounds.braking) if during(t) else _GAIN * (own - v)

    middle = chance.choice([(low + high) / 2 for low, high in pairwise(lanes)])
    stays = to(lambda _: ego.d + aside)
    if kind == "changes lane":
        return keeps, to(lambda t: ego.d if t < begin else middle + aside)
    if kind == "gives a change up":
        return keeps, to(lambda t: middle if during(t) else ego.d)
    if kind == "weaves":
        line, wide = chance.choice(lanes), chance.uniform(0.1, 1.8)
        period = chance.uniform(0.8, 5.0)
        return keeps, to(lambda t: line + wide * sin(tau * (begin + t) / period))
    if kind == "brakes hard":
        return along, stays
    if kind == "swerves":
        return along, to(lambda t: ego.d + 4 * aside if during(t) else ego.d)
    if kind == "creeps":
        slow = chance.uniform(0.05, 3.0)
        return (lambda _, __, v: _GAIN * (slow - v)), stays
    boxes = [(other, swept(other, 0.0, 0.0)) for other in scenario.obstacles]
    there = [(other, box) for other, box in boxes if box is not None]
    if kind == "stops" or not there:
        ahead = [box.s_min - chance.uniform(2.3, 8.0) for _, box in there]
        goal = chance.choice([*(s for s in ahead if s > ego.s), ego.s + chance.uniform(1.0, 80.0)])
        return (
            lambda _, s, v: -(v**2) / 2 / max(goal - s, 0.1) if s + 2 * v > goal else 0.3
        ), stays
    (other, _), gap = chance.choice(there), chance.choice([0.5, 2.0, 4.0, 10.0, -8.0])
    shift = chance.uniform(-6.0, 6.0) if kind == "stays beside" else -gap - ego.length / 2

    def with_it(t, s, v):
        now, soon = swept(other, t, t), swept(other, t + 0.1, t + 0.1)
        if now is None or soon is None:
            return 0.0
        return 0.8 * (now.s_min + shift - s) + _GAIN * ((soon.s_min - now.s_min) / 0.1 - v)

    return with_it, stays

"""Traffic on a straight street: two lanes to the east, one to the west, driven by formulas.

Nobody looks at anybody: some tailgate, speed, overtake on the right, or cross the solid line.
"""

from dataclasses import dataclass
from random import Random

import numpy as np

STEP_S = 0.1
LENGTH, WIDTH = 4.6, 1.9
LANE_M = 3.5
LIMIT_KMH = 50.0
BEGINS, ENDS = -200.0, 600.0
RIGHT, LEFT, BACK = -1.5 * LANE_M, -0.5 * LANE_M, 0.5 * LANE_M
"""The middles of the lanes by y."""

_SPEEDS = (0.0, 6.0, 9.0, 11.0, 12.5, 15.5, 17.0, 20.0)
"""None is near the limit of 13.89 m/s, so that it matters to no verdict how files round it."""


@dataclass(frozen=True)
class Car:
    """A car by moment: middle, heading (rad) and speed along it."""

    number: int
    x: np.ndarray
    y: np.ndarray
    heading: np.ndarray
    speed: np.ndarray

    @property
    def velocity(self):
        return self.speed * np.cos(self.heading), self.speed * np.sin(self.heading)


def cars(seed, count=8, moments=80):
    """The cars of a world."""
    pick = Random(seed)
    return [_car(pick, number, moments) for number in range(count)]


def _car(pick, number, moments):
    t = np.arange(moments) * STEP_S
    way = -1.0 if number % 4 == 3 else 1.0
    lane = BACK if way < 0 else pick.choice((RIGHT, LEFT))
    speed = np.full(moments, pick.choice(_SPEEDS))
    if pick.random() < 0.4:
        # Brakes or speeds up for three seconds, by one of these
        rate, begin = pick.choice((-3.0, -1.0, 1.0)), pick.uniform(1, 4)
        speed = np.maximum(speed + rate * np.clip(t - begin, 0, 3), 0.0)
    start = pick.uniform(0, 90) + (200 if way < 0 else 0)
    x = start + way * np.append(0.0, ((speed[1:] + speed[:-1]) / 2 * STEP_S).cumsum())
    y = np.full(moments, lane)
    if pick.random() < 0.5 and speed.min() > 3:
        target = pick.choice([other for other in (RIGHT, LEFT, BACK) if other != lane])
        begin = pick.uniform(0.5, 4)
        share = np.clip((t - begin) / 3.5, 0, 1)
        y = lane + (target - lane) * (1 - np.cos(np.pi * share)) / 2
    dx, dy = np.gradient(x), np.gradient(y)
    moves = np.hypot(dx, dy) > 1e-9
    straight = 0.0 if way > 0 else np.pi
    heading = np.where(moves, np.arctan2(dy, dx), straight)
    return Car(number, x, y, heading, np.where(moves, np.hypot(dx, dy) / STEP_S, 0.0))

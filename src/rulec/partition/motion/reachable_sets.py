"""Sets of positions and speeds that contain everything ego can reach, along or across the road.

A motion is a double integrator with bounds on speed and acceleration. A set is given by its bounds
in some directions: position, speed, and the position ego would have at each of some moments if it
kept its speed. A step of the motion maps each of these directions to another one of them, so the
bounds after a step are exact except for the bounds on speed, and no set leaves out anything that
can be reached.

Arrays have one row per set and one column per direction: position (m), speed (m/s), then the
positions at the moments (m).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Bounds = NDArray[np.float64]
"""One row per set, one column per direction."""

Interval = tuple[float, float]

Sets = tuple[Bounds, Bounds]
"""Lower and upper bounds."""

ROUNDING = 1e-6
"""Sets are widened by this (m, m/s), so that rounding excludes nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class AxisMotion:
    """Motion along one axis: least and greatest speed and acceleration.

    ``moments`` (s) are those of the directions, and multiples of ``step`` (s), the layers' length.
    """

    speeds: tuple[float, float]
    accelerations: tuple[float, float]
    moments: NDArray[np.float64]
    step: float

    def at(self, place: float, speeds: tuple[float, float], now: float) -> Sets:
        """One set: a position with speeds between bounds."""
        low, high = np.array([[place, speeds[0]]]), np.array([[place, speeds[1]]])
        return self._filled(low, high, now)

    def forward(self, places: Interval, speeds: Interval, seconds: float) -> Interval:
        """Bounds of the places some time after places and speeds between bounds."""
        low, high = self._driven(speeds, self.accelerations, seconds)
        return places[0] + low, places[1] + high

    def backward(self, places: Interval, speeds: Interval, seconds: float) -> Interval:
        """Bounds of the places some time before."""
        braking, gaining = self.accelerations
        low, high = self._driven(speeds, (-gaining, -braking), seconds)
        return places[0] - high, places[1] - low

    def _driven(self, speeds: Interval, gains: Interval, seconds: float) -> Interval:
        gained = seconds**2 / 2
        least = max(speeds[0] * seconds + gains[0] * gained, self.speeds[0] * seconds)
        most = min(speeds[1] * seconds + gains[1] * gained, self.speeds[1] * seconds)
        return least, most

    def _filled(self, least: Bounds, most: Bounds, now: float) -> Sets:
        low = np.full((len(least), 2 + len(self.moments)), -np.inf)
        high = -low
        low[:, :2], high[:, :2] = least, most
        return self.tightened((low, high), now)

    def after(self, sets: Sets, now: float) -> Sets:
        """The sets one step later; ``now`` is the time before the step."""
        return self._moved(sets, now, forward=True)

    def before(self, sets: Sets, now: float) -> Sets:
        """The sets one step earlier; ``now`` is the time before the step."""
        return self._moved(sets, now, forward=False)

    def _moved(self, sets: Sets, now: float, *, forward: bool) -> Sets:
        (low, high), (least, most) = sets, self.accelerations
        # Back in time, the greatest acceleration leads to the lowest speed.
        slower, faster = (least, most) if forward else (-most, -least)
        new_low, new_high = np.empty_like(low), np.empty_like(high)
        way_low = self._way(low[:, 1], slower)
        way_high = self._way(high[:, 1], faster)
        if forward:
            new_low[:, 0], new_high[:, 0] = low[:, 0] + way_low, high[:, 0] + way_high
        else:
            new_low[:, 0], new_high[:, 0] = low[:, 0] - way_high, high[:, 0] - way_low
        new_low[:, 1] = np.maximum(low[:, 1] + slower * self.step, self.speeds[0])
        new_high[:, 1] = np.minimum(high[:, 1] + faster * self.step, self.speeds[1])
        ahead = self.moments - now
        gain = ahead * self.step - self.step**2 / 2
        gains = np.stack((gain * least, gain * most))
        change = (gains.min(axis=0), gains.max(axis=0))
        if not forward:
            change = (-change[1], -change[0])
        new_low[:, 2:], new_high[:, 2:] = low[:, 2:] + change[0], high[:, 2:] + change[1]
        return self.tightened((new_low, new_high), now + self.step if forward else now)

    def _way(self, speeds: Bounds, acceleration: float) -> Bounds:
        """The distance covered in a step at constant acceleration, within the bounds of speed."""
        end = self.speeds[1] if acceleration > 0 else self.speeds[0]
        for_s = np.clip((end - speeds) / acceleration, 0.0, self.step)
        reached = speeds + acceleration * for_s
        return np.asarray((speeds + reached) / 2 * for_s + reached * (self.step - for_s))

    def tightened(self, sets: Sets, now: float) -> Sets:
        """The same sets with each bound tightened by what the other bounds imply."""
        low, high = sets
        ahead = self.moments - now
        other = ahead != 0
        apart = ahead[other]
        # Position, speed and each moment's position: each is implied by the two others.
        for _ in range(2):
            ends = (ahead * low[:, 1:2], ahead * high[:, 1:2])
            away_low, away_high = np.minimum(*ends), np.maximum(*ends)
            low[:, 2:] = np.maximum(low[:, 2:], low[:, :1] + away_low)
            high[:, 2:] = np.minimum(high[:, 2:], high[:, :1] + away_high)
            low[:, 0] = np.maximum(low[:, 0], (low[:, 2:] - away_high).max(axis=1))
            high[:, 0] = np.minimum(high[:, 0], (high[:, 2:] - away_low).min(axis=1))
            least = (low[:, 2:][:, other] - high[:, :1]) / apart
            most = (high[:, 2:][:, other] - low[:, :1]) / apart
            low[:, 1] = np.maximum(low[:, 1], np.where(apart > 0, least, most).max(axis=1))
            high[:, 1] = np.minimum(high[:, 1], np.where(apart > 0, most, least).min(axis=1))
        return low, high


def common(first: Sets, second: Sets) -> Sets:
    """The intersections, row by row."""
    return np.maximum(first[0], second[0]), np.minimum(first[1], second[1])


def anything_in(sets: Sets) -> NDArray[np.bool_]:
    """Mask of the sets that are not empty."""
    return np.asarray((sets[0] <= sets[1] + ROUNDING).all(axis=1))


def together(sets: Sets, groups: NDArray[np.intp], count: int) -> Sets:
    """For each of ``count`` groups the hull of its sets; an empty set for an empty group."""
    low = np.full((count, sets[0].shape[1]), np.inf)
    high = -low
    np.minimum.at(low, groups, sets[0])
    np.maximum.at(high, groups, sets[1])
    return low, high

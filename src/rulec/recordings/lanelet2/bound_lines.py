"""The bounds of lanelets by Lanelet2's rules: their direction, and the centre line between them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.polylines import paired
from rulec.recordings.recording import Points

_CLOSEST_M = 1e-6
_FEWEST_POINTS = 2


class Aligned(NamedTuple):
    """Bounds in the direction of travel, and whether each is reversed compared with the file."""

    left: Points
    right: Points
    left_turned: bool
    right_turned: bool


def aligned(left: Points, right: Points) -> Aligned:
    """Two lines as the bounds of a lanelet, by Lanelet2's rule (``geometry::align``).

    The left bound gets the direction in which the middle of the right one lies to its right; then
    the right bound gets the direction in which the middle of the left one lies to its left.
    """
    left_turned = bool(_left_of(left, _middle(right)) >= 0)
    left = left[::-1] if left_turned else left
    right_turned = bool(_left_of(right, _middle(left)) <= 0)
    return Aligned(left, right[::-1] if right_turned else right, left_turned, right_turned)


def _middle(line: Points) -> NDArray[float64]:
    middle: NDArray[float64] = line[len(line) // 2]
    return middle if len(line) > _FEWEST_POINTS else line[[0, -1]].mean(axis=0)


def _left_of(line: Points, place: NDArray[float64]) -> float:
    """The signed distance of a place from a line, positive on its left.

    Where a corner is nearest, both segments at the corner count equally.
    """
    steps = np.diff(line, axis=0)
    squared = np.maximum((steps**2).sum(axis=1), _CLOSEST_M**2)
    part = np.clip(((place - line[:-1]) * steps).sum(axis=1) / squared, 0.0, 1.0)
    to = place - (line[:-1] + part[:, None] * steps)
    distance = np.hypot(*to.T)
    nearest = int(distance.argmin())
    ahead = steps[nearest] / np.sqrt(squared[nearest])
    if part[nearest] == 1.0 and nearest + 1 < len(steps):
        ahead = ahead + steps[nearest + 1] / np.sqrt(squared[nearest + 1])
    elif part[nearest] == 0.0 and nearest > 0:
        ahead = ahead + steps[nearest - 1] / np.sqrt(squared[nearest - 1])
    return float(ahead[0] * to[nearest, 1] - ahead[1] * to[nearest, 0])


def distinct(line: Points) -> Points | None:
    """A line without repeated points; None if fewer than two points remain."""
    if len(line) < _FEWEST_POINTS:
        return None
    kept = line[np.append(True, np.hypot(*np.diff(line, axis=0).T) > _CLOSEST_M)]
    return kept if len(kept) >= _FEWEST_POINTS else None


def middle_line(left: Points, right: Points) -> Points:
    """The line halfway between two bounds.

    It has a point at each fraction of the length at which either bound has one.
    """
    both = paired(left, right)
    line = distinct((both[0] + both[1]) / 2)
    # Bounds in opposite directions with the same ends have no centre line
    return left if line is None else line

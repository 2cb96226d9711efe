"""The borders of a lane, of which SUMO has the middle."""

from __future__ import annotations

import numpy as np

from rulec.scenario.recorded.recording import Points

_CLOSEST_M = 0.01
_SHARPEST = 0.5
"""Where the line turns back on itself its border would run away; so far it may, at most."""


def without_repeats(points: Points) -> Points:
    """The points that differ from the one before them."""
    kept = [points[0]]
    for point in points[1:]:
        if np.hypot(*(point - kept[-1])) > _CLOSEST_M:
            kept.append(point)
    return np.array(kept)


def parallel_line(points: Points, offset: float) -> Points:
    """The parallel of a line at a distance to the left.

    The line has at least two points, all different.
    """
    ahead = np.diff(points, axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    across = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)
    before = np.concatenate((across[:1], across))
    after = np.concatenate((across, across[-1:]))
    # Both pieces' parallels meet on the line that halves the angle between them
    room = np.maximum(1.0 + (before * after).sum(axis=1), _SHARPEST)
    line: Points = points + offset * (before + after) / room[:, None]
    return line

"""Lines through points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rulec.recordings.recording import Points


def without_repeats(points: Points, closest_m: float) -> Points:
    """The points that are not too close to the one before them."""
    kept = [points[0]]
    for point in points[1:]:
        if np.hypot(*(point - kept[-1])) > closest_m:
            kept.append(point)
    return np.array(kept)


def densified(points: Points, every_m: float) -> Points:
    """A polyline with further points, none farther apart than a limit."""
    parts = [points[:1]]
    for start, end in pairwise(points):
        count = max(1, int(np.ceil(np.hypot(*(end - start)) / every_m)))
        parts.append(start + (end - start) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(parts)

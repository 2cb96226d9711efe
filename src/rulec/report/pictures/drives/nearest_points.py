"""The nearest points of two bodies by state."""

from __future__ import annotations

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import Points
from rulec.report.pictures.drives.drive_scene import Body

_AS_NEAR_M = 0.25
"""Points farther by less (m) count as equally near: for parallel sides the middle is taken."""


def nearest_points(ego: Body, other: Body | None, states: int) -> NDArray[float64]:
    """The nearest points (x, y, x, y) by state, NaN where one body is absent."""
    links = np.full((states, 4), np.nan)
    for state in range(states) if other else ():
        own, theirs = ego.outline(state), other.outline(state) if other else None
        if own is not None and theirs is not None:
            links[state] = _nearest(own, theirs)
    return links


def _nearest(own: Points, theirs: Points) -> NDArray[float64]:
    """The middle of all point pairs that are about as near as the nearest one.

    For overlapping bodies, a point that both cover, twice.
    """
    common = np.concatenate([own[_inside(own, theirs)], theirs[_inside(theirs, own)]])
    if len(common):
        return np.tile(common.mean(axis=0), 2)
    feet, corners = _feet(own, theirs), _feet(theirs, own)
    pairs = np.concatenate([np.hstack(feet[:2]), np.hstack(corners[1::-1])])
    distances = np.concatenate([feet[2], corners[2]])
    nearest: NDArray[float64] = pairs[distances <= distances.min() + _AS_NEAR_M]
    low, high = nearest.min(axis=0), nearest.max(axis=0)
    middle: NDArray[float64] = (low + high) / 2 if len(nearest) > 1 else nearest[0]
    return middle


def _feet(corners: Points, ring: Points) -> tuple[Points, Points, NDArray[float64]]:
    """The corners, the nearest point on a ring for each, and their distances."""
    start, along = ring, np.roll(ring, -1, axis=0) - ring
    length = np.maximum((along**2).sum(axis=1), 1e-12)
    part = np.clip(((corners[:, None] - start) * along).sum(axis=2) / length, 0, 1)
    feet = start + part[..., None] * along
    distances = np.hypot(*np.moveaxis(corners[:, None] - feet, 2, 0))
    nearest = distances.argmin(axis=1)
    rows = np.arange(len(corners))
    return corners, feet[rows, nearest], distances[rows, nearest]


def _inside(points: Points, ring: Points) -> NDArray[np.bool_]:
    """Mask of the points inside a convex ring."""
    along = np.roll(ring, -1, axis=0) - ring
    to = points[:, None] - ring
    across = along[:, 0] * to[..., 1] - along[:, 1] * to[..., 0]
    inside: NDArray[np.bool_] = np.abs(np.sign(across).sum(axis=1)) == len(ring)
    return inside

"""Headings, speeds and accelerations that a table does not state, from places."""

from __future__ import annotations

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Points

FLICKER_M = 1.0
"""A direction is that of so much way: trackers place somebody who stands a little here, there."""

Floats = NDArray[float64]


def headings_of(places: Points) -> Floats | None:
    """The direction (rad) at each place of a track: where it leads to, over a metre or more.

    Before somebody sets off and after stopping it is that of the way next to it. None for who does
    not move as far.
    """
    anchors = _anchors(places)
    if len(anchors) < 2:
        return None
    ahead = np.diff(places[anchors], axis=0)
    directions = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    middles = (anchors[:-1] + anchors[1:]) / 2
    return wrapped(np.interp(np.arange(len(places)), middles, directions))


def _anchors(places: Points) -> NDArray[np.intp]:
    """The first place, and each that is far enough from the one before."""
    kept, (x, y) = [0], places[0].tolist()
    for number, (own_x, own_y) in enumerate(places.tolist()):
        if (own_x - x) ** 2 + (own_y - y) ** 2 >= FLICKER_M**2:
            kept.append(number)
            x, y = own_x, own_y
    return np.array(kept)


def velocities_of(places: Points, times: Floats | float) -> Points:
    """Velocities (m/s) at places, from those before and after; 0 for one alone.

    ``times`` (s) are those of the places, or the step from each to the next.
    """
    if len(places) < 2:
        return np.zeros_like(places)
    velocities: Points = np.gradient(places, times, axis=0)
    return velocities


def along(velocities: Points, headings: Floats) -> Floats:
    """The part of velocities or accelerations along headings."""
    part: Floats = velocities[:, 0] * np.cos(headings) + velocities[:, 1] * np.sin(headings)
    return part


def accelerations_of(speeds: Floats, times: Floats | float) -> Floats:
    """Accelerations (m/s²) of speeds (m/s) along the last axis; 0 for one alone.

    ``times`` (s) are those of the speeds, or the step from each to the next.
    """
    if speeds.shape[-1] < 2:
        return np.zeros_like(speeds)
    result: Floats = np.gradient(speeds, times, axis=-1)
    return result

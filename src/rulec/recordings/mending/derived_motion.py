"""Headings, speeds and accelerations that a table does not state, from places."""

from __future__ import annotations

from math import ceil

import numpy as np

from rulec.array_types import Floats
from rulec.recordings.polylines import far_apart, noise_of, wrapped
from rulec.recordings.recording import Points

FLICKER_M = 1.0
"""A direction is that of so much way: trackers place somebody who stands a little here, there."""

_STEADY = 10.0
"""The direction of a way of so many times the noise of places is off by 8°."""

_NOISES = 6.0
"""The difference of two places is off by less than so many times their noise."""


def headings_of(places: Points) -> Floats | None:
    """The direction (rad) at each place of a track: where it leads to, over a metre or more.

    If places are noisy, it is that over so much more that noise hardly turns it.

    Before somebody sets off and after stopping it is that of the way next to it. None for who does
    not move as far.
    """
    anchors = far_apart(places, max(FLICKER_M, _STEADY * noise_of(places)))
    if len(anchors) < 2:
        return None
    ahead = np.diff(places[anchors], axis=0)
    directions = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    middles = (anchors[:-1] + anchors[1:]) / 2
    return wrapped(np.interp(np.arange(len(places)), middles, directions))


def velocities_of(places: Points, times: Floats | float) -> Points:
    """Velocities (m/s) at places, from those before and after; 0 for one alone.

    ``times`` (s) are those of the places, or the step from each to the next.
    """
    if len(places) < 2:
        return np.zeros_like(places)
    velocities: Points = np.gradient(places, times, axis=0)
    return velocities


def steady_velocities(places: Points, times: Floats, known_to_mps: float) -> Points:
    """Velocities (m/s) at two or more places, over so long that noise is no faster than that.

    The times (s) ascend. Each place is in the middle of its own time, except at a track's ends.
    """
    step_s = float(np.diff(times).min())
    reach = max(1, ceil(_NOISES * noise_of(places) / known_to_mps / step_s / 2))
    most = len(places) - 1
    first = (np.arange(len(places)) - reach).clip(0, max(most - 2 * reach, 0))
    last = np.minimum(first + 2 * reach, most)
    velocities: Points = (places[last] - places[first]) / (times[last] - times[first])[:, None]
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

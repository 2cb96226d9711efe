"""Ways of tracks that are long compared with the noise of their places."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.recordings.polylines import far_apart, noise_of
from rulec.recordings.recording import Points
from rulec.recordings.track import Track

_NOISES = 10.0
"""A way of so many times the noise is off in its direction by 8°, and hardly in its length."""


class LongWays(NamedTuple):
    """The ways of a track (m), and the rows at which they begin and end."""

    track: Track
    rows: NDArray[intp]
    ways: Points


def long_ways(track: Track) -> LongWays:
    """The ways of a track from one place to the next that is beyond noise; there may be none.

    From step to step, noise makes slow bodies fast, and their directions random.
    """
    places = track.rows[:, :2]
    ways: Points = np.diff(places, axis=0)
    rows: NDArray[intp] = np.arange(len(places))
    least = _NOISES * noise_of(places)
    if least > float(np.median(np.hypot(*ways.T))):
        rows = far_apart(places, least)
        ways = np.diff(places[rows], axis=0)
    return LongWays(track, rows, ways)

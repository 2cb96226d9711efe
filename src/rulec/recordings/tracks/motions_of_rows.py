"""How the bodies of a table move, by its rows."""

from __future__ import annotations

from math import ceil
from typing import NamedTuple

import numpy as np
from numpy import int64, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.polylines import noise_by_thirds
from rulec.recordings.tracks.even_times import EvenTimes

MOVING_MPS = 2.0

_SAMPLE = 10_000


class Motions(NamedTuple):
    """Velocities (m/s) of bodies, and the row in the middle of the time of each."""

    middle: NDArray[intp]
    dx: Floats
    dy: Floats


class PlacesOfRows(NamedTuple):
    """The rows of a table: the code of each one's track, its time and place (m)."""

    codes: NDArray[int64]
    times: EvenTimes
    x: Floats
    y: Floats


def motions_of(rows: PlacesOfRows, noises: float) -> Motions:
    """The velocities from each row of a track to the next, or if places are noisy to a later one.

    A body at ``MOVING_MPS`` gets by ``noises`` times the noise there. No velocity is one across
    missing rows.
    """
    codes, times, x, y = rows
    order = np.lexsort((times.steps, codes))
    own, steps, x, y = codes[order], times.steps[order], x[order], y[order]
    window = max(1, ceil(noises * _noise(own, steps, x, y) / MOVING_MPS / times.step_s))
    begin, end = slice(None, -window), slice(window, None)
    on = (own[begin] == own[end]) & (steps[end] - steps[begin] == window)
    first = on.nonzero()[0]
    took = window * times.step_s
    dx, dy = ((place[first + window] - place[first]) / took for place in (x, y))
    return Motions(order[first + window // 2], dx, dy)


def _noise(codes: NDArray[int64], steps: NDArray[int64], x: Floats, y: Floats) -> float:
    """The noise (m) of the places of rows by track and time, from some of them."""
    first = np.arange(0, len(codes) - 3, max(1, len(codes) // _SAMPLE))
    on = (codes[first] == codes[first + 3]) & (steps[first + 3] - steps[first] == 3)
    first = first[on]
    thirds = [own[first + 3] - own[first] - 3 * (own[first + 2] - own[first + 1]) for own in (x, y)]
    return noise_by_thirds(np.concatenate(thirds))

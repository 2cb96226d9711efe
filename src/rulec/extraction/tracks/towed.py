"""Bodies that another one tows: nobody drives them."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Flags, Tracks

_DRAWBAR_M = 1.5
"""What is towed is no farther behind who tows it."""

_STEADY_M = 0.4
"""Nor is its distance spread by more: nobody who drives keeps so close to another so evenly."""

_ASIDE_M = 2.0
"""Nor is who tows it ever farther aside of the line that it heads along."""

_HAIR_M = 1e-6

_FAST_MPS, _LEAST_S = 8.0, 2.0
"""Only who gets so fast, and is there for so long, is known to be towed: queues creep alike."""


def towed_by(tracks: Tracks, row: int, step_s: float) -> str | None:
    """The id of who tows a participant, None if it drives of itself.

    All the time it is there the other one is, too, so close ahead of it as a drawbar is long, and
    always as far away, of whatever speed they are.
    """
    columns = tracks.present[row].nonzero()[0]
    if tracks.fastest[row] < _FAST_MPS or len(columns) * step_s < _LEAST_S:
        return None
    others = _near_enough(tracks, row, columns)
    others = others[tracks.present[np.ix_(others, columns)].all(axis=1)]
    if not len(others):
        return None
    x, y = (
        places[np.ix_(others, columns)] - places[row, columns] for places in (tracks.x, tracks.y)
    )
    away = np.hypot(x, y)
    heading = tracks.heading[row, columns]
    ahead = (x * np.cos(heading) + y * np.sin(heading)).mean(axis=1)
    reach = (tracks.lengths[others] + tracks.lengths[row]) / 2
    close = (ahead > reach / 2) & (away.mean(axis=1) < reach + _DRAWBAR_M)
    close &= away.std(axis=1) <= _STEADY_M
    aside = np.abs(y * np.cos(heading) - x * np.sin(heading)).max(axis=1, initial=0.0)
    close &= aside <= _ASIDE_M
    found = others[close]
    return tracks.participants[found[0]].id if len(found) else None


def _near_enough(tracks: Tracks, row: int, columns: NDArray[intp]) -> NDArray[intp]:
    """The rows of other vehicles that may be near a participant all the time, by where it begins.

    No number is farther from the mean of some than their standard deviation times the root of
    their count.
    """
    first, last = columns[0], columns[-1]
    x, y = tracks.x[:, first], tracks.y[:, first]
    most = (tracks.lengths + tracks.lengths[row]) / 2 + _DRAWBAR_M
    most += _STEADY_M * np.sqrt(len(columns)) + _HAIR_M
    near: Flags = np.hypot(x - x[row], y - y[row]) < most
    near &= tracks.present[:, last] & tracks.of_type("vehicle")
    near[row] = False
    return near.nonzero()[0]

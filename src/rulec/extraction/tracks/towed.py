"""Bodies that a vehicle tows, and that therefore have no driver."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.tracks.tracks import Tracks

_DRAWBAR_M = 1.5
"""A towed body is no farther (m) behind the vehicle that tows it."""

_STEADY_M = 0.4
"""Greatest standard deviation (m) of their distance: no driver follows another so evenly."""

_ASIDE_M = 2.0
"""The towing vehicle is never farther (m) aside of the line along the towed body's heading."""

_HAIR_M = 1e-6

_FAST_MPS, _LEAST_S = 8.0, 2.0
"""Slower or shorter tracks cannot be told from queues, whose vehicles creep at equal distances."""


def towed_by(tracks: Tracks, row: int, step_s: float) -> str | None:
    """The id of the vehicle that tows a participant; None if it drives by itself.

    As long as the participant is present, the other vehicle is too, no farther ahead than a drawbar
    is long, and always equally far away, whatever their speed.
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

    No number is farther from a mean than the standard deviation times the root of the count. At
    both ends of its track they are not aside of it.
    """
    first, last = columns[0], columns[-1]
    x, y = tracks.x[:, first], tracks.y[:, first]
    most = (tracks.lengths + tracks.lengths[row]) / 2 + _DRAWBAR_M
    most += _STEADY_M * np.sqrt(len(columns)) + _HAIR_M
    near: Flags = np.hypot(x - x[row], y - y[row]) < most
    near &= tracks.present[:, last] & tracks.of_type("vehicle")
    near[row] = False
    others = near.nonzero()[0]
    for column in (first, last) if len(others) else ():
        heading = tracks.heading[row, column]
        dx, dy = (places[others, column] - places[row, column] for places in (tracks.x, tracks.y))
        aside = np.abs(dy * np.cos(heading) - dx * np.sin(heading))
        others = others[~(aside > _ASIDE_M + _HAIR_M)]
    return others

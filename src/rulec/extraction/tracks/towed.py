"""Bodies that another one tows: nobody drives them."""

from __future__ import annotations

import numpy as np

from rulec.extraction.tracks.tracks import Tracks

_DRAWBAR_M = 1.5
"""What is towed is no farther behind who tows it."""

_STEADY_M = 0.4
"""Nor is its distance spread by more: nobody who drives keeps so close to another so evenly."""

_ASIDE_M = 2.0
"""Nor is who tows it ever farther aside of the line that it heads along."""

_FAST_MPS, _LEAST_S = 8.0, 2.0
"""Only who gets so fast, and is there for so long, is known to be towed: queues creep alike."""


def towed_by(tracks: Tracks, row: int, step_s: float) -> str | None:
    """The id of who tows a participant, None if it drives of itself.

    All the time it is there the other one is, too, so close ahead of it as a drawbar is long, and
    always as far away, of whatever speed they are.
    """
    columns = np.flatnonzero(tracks.present[row])
    if tracks.fastest[row] < _FAST_MPS or len(columns) * step_s < _LEAST_S:
        return None
    others = np.flatnonzero(tracks.present[:, columns].all(axis=1) & tracks.of_type("vehicle"))
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
    found = others[close & (others != row)]
    return tracks.participants[found[0]].id if len(found) else None

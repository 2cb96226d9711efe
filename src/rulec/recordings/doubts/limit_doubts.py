"""Implausible speed limits, which may be in the wrong unit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.polylines import places_in
from rulec.recordings.recording import Lanelet, Recording, is_lane
from rulec.recordings.track import Track
from rulec.trace.plain_arrays import median, quantile

_HIGHEST_KMH = 162.0
"""The highest plausible limit: 160 km/h is the highest of any country's roads."""

_FEWEST_FAST, _FEWEST_SLOW = 5, 10
_TOO_FAST = 1.5
"""The ratio of speed to limit above which limits are doubted.

A mile is 1.609 km. In recordings without doubtful limits, the median ratio is 1.35.
"""

_TOO_SLOW = 0.55
"""The ratio of speed to limit below which limits are doubted.

27 m/s are 60 mph, and 60 m/s are 2.2 times as much. Queues may be as slow, so limits are doubted
only if they are multiples of 5 m/s, as limits in km/h and mph taken for m/s are.
"""

_EVERY_S = 1.0
"""The interval at which vehicles are sampled."""

_ROUND_MPS = 5.0
_ALMOST_MPS = 0.005
_FAST = 0.9
"""A vehicle counts as fast from this quantile of its own speeds on."""

_RAILS = frozenset({"rail", "tram"})


def limit_doubts(recording: Recording, tracks: Sequence[Track]) -> Iterator[str]:
    """Remarks on a recording's limits; ``tracks`` are those of moving vehicles."""
    lanes = [lanelet for lanelet in recording.lanelets.values() if _has_limit(lanelet)]
    if not lanes:
        return
    limits = np.array([lanelet.limit_mps for lanelet in lanes], dtype=float)
    highest = float(limits.max()) * KMH_PER_MPS
    if highest > _HIGHEST_KMH:
        yield f"limits are up to {highest:.0f} km/h: they may be in another unit than m/s"
        return
    if len(tracks) < _FEWEST_FAST:
        return
    most, least = _shares(tracks, recording.step_s, lanes, limits)
    if len(most) >= _FEWEST_FAST and (usual := median(np.array(most))) > _TOO_FAST:
        yield (
            f"half of the vehicles drive {usual:.2g} times the limit or faster: limits "
            "may be in another unit, such as mph or m/s in the place of km/h"
        )
    is_round = (np.abs(limits - np.round(limits / _ROUND_MPS) * _ROUND_MPS) < _ALMOST_MPS).all()
    fast = quantile(np.array(least), _FAST) if least else np.inf
    if is_round and len(least) >= _FEWEST_SLOW and fast < _TOO_SLOW:
        yield (
            f"nine in ten vehicles drive {fast:.2g} times the limit or slower, "
            "and limits are whole numbers of m/s: they may be in km/h or mph"
        )


def _has_limit(lanelet: Lanelet) -> bool:
    limit = lanelet.limit_mps
    is_road = is_lane(lanelet) and not lanelet.types & _RAILS
    return is_road and limit is not None and isfinite(limit) and limit > 0


def _shares(
    tracks: Sequence[Track], step_s: float, lanes: Sequence[Lanelet], limits: NDArray[float64]
) -> tuple[list[float], list[float]]:
    """The ratio of each vehicle's speed to the limit where it is fast.

    Where lanes overlap, once by the highest of their limits and once by the lowest.
    """
    outlines = [
        shapely.Polygon(np.vstack((lanelet.left, lanelet.right[::-1]))) for lanelet in lanes
    ]
    usual = max(1, round(_EVERY_S / step_s))
    shares: tuple[list[float], list[float]] = ([], [])
    for track in tracks:
        every = min(usual, len(track.steps) - 1)
        places = track.rows[::every, :2]
        # Over so long, noise does not make anybody fast
        ways = np.hypot(*np.diff(places, axis=0).T)
        speeds = ways / (np.diff(track.steps[::every]) * step_s)
        rows, lane = places_in(outlines, *places[:-1].T)
        if not len(rows):
            continue
        highest, lowest = np.zeros(len(speeds)), np.full(len(speeds), np.inf)
        np.maximum.at(highest, rows, limits[lane])
        np.minimum.at(lowest, rows, limits[lane])
        on = highest > 0
        for share, limit in zip(shares, (highest, lowest), strict=True):
            share.append(quantile(speeds[on] / limit[on], _FAST))
    return shares

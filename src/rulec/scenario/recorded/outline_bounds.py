"""Outlines in a road's Frenet coordinates: bounds of bodies, pedestrian crossings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.scenario.recorded.lane_coordinates import Lanes
from rulec.scenario.recorded.recording import Points, Recording
from rulec.scenario.recorded.reference_line import ReferenceLine, densified

_REACH_FACTOR, _REACH_MORE_M = 2.0, 3.0
_NARROWEST_M = 0.1
_EVERY_M = 0.5


def outline_bounds(
    outlines: Sequence[Points], line: ReferenceLine, lanes: Lanes
) -> tuple[NDArray[float64], NDArray[float64]]:
    """The least and the greatest coordinates of each outline, a row each.

    Columns: ``s``, ``d`` (m from the line), ``w`` (m, ``d`` between the lanes' straight bounds).
    NaN for outlines that are not beside the line. Corners are projected near the foot of their
    middle, so that no body is torn apart where a road meets itself.
    """
    if not outlines:
        return np.empty((0, 3)), np.empty((0, 3))
    counts = np.array([len(outline) for outline in outlines])
    starts = np.append(0, np.cumsum(counts)[:-1])
    corners = np.concatenate(outlines)
    middles = np.add.reduceat(corners, starts) / counts[:, None]
    away = np.hypot(*(corners - np.repeat(middles, counts, axis=0)).T)
    reach = np.maximum.reduceat(away, starts) * _REACH_FACTOR + _REACH_MORE_M
    around = np.repeat(line.coordinates(middles)[:, 0], counts)
    feet = line.coordinates_near(corners, around, np.repeat(reach, counts))
    feet[np.isnan(around)] = np.nan
    coordinates = np.column_stack((feet, lanes.straightened(feet)[:, 1]))
    return np.minimum.reduceat(coordinates, starts), np.maximum.reduceat(coordinates, starts)


def crossings_along(
    recording: Recording, line: ReferenceLine, lanes: Lanes, start: float, end: float
) -> Iterator[tuple[float, float]]:
    """The stretches (``s``) that crosswalks take up on the lanes, within ``start`` and ``end``."""
    for lanelet in recording.lanelets.values():
        if "crosswalk" not in lanelet.types:
            continue
        outline = np.concatenate((lanelet.right, lanelet.left[::-1], lanelet.right[:1]))
        places = lanes.straightened(line.coordinates(densified(outline, _EVERY_M)))
        d = places[:, 1]
        on_road = places[(d > lanes.straight[0]) & (d < lanes.straight[-1]), 0]
        if len(on_road):
            low, high = max(float(on_road.min()), start), min(float(on_road.max()), end)
            if high - low >= _NARROWEST_M:
                yield low, high

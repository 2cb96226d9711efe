"""Map matching, first step: candidate lanelets of a vehicle's states.

A state matches the lanelets within ``NEAR_M`` that lead its way; each match has a cost. The second
step, ``driven_route``, takes the cheapest chain of them, as matching by hidden Markov models does
(Newson, Krumm, "Hidden Markov map matching through noise and sparseness", GIS 2009).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from math import pi

import numpy as np
import shapely

from rulec.extraction.tracks.tracks import Tracks
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.recorded.route import directions_beside, is_lane, lanelet_area

NEAR_M = 3.0
"""The farthest that a vehicle may be beside a lanelet that it is matched to."""

_BESIDE_COST = 1.0
_LARGEST_ANGLE = pi / 2

MatchedLanelets = Mapping[int, Mapping[str, float]]
"""Column -> lanelet -> cost: 0 on it and along it, up to 1 for its angle, 1 to 2 more beside it."""


def match_to_map(recording: Recording, tracks: Tracks) -> dict[int, MatchedLanelets]:
    """The matches of each moving participant, by row and column.

    Columns without a match are left out.
    """
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    moving = np.array([not body.standing for body in tracks.participants], dtype=bool)
    rows, columns = np.nonzero(tracks.present & moving[:, None])
    if not lanes or not len(rows):
        return {}
    points = shapely.points(tracks.x[rows, columns], tracks.y[rows, columns])
    areas = [lanelet_area(lanelet) for lanelet in lanes]
    near, near_lanes = shapely.STRtree(areas).query(points, predicate="dwithin", distance=NEAR_M)
    matches: dict[int, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    for lane in np.unique(near_lanes):
        chosen = near[near_lanes == lane]
        directions = directions_beside(lanes[lane], points[chosen])
        headings = tracks.heading[rows[chosen], columns[chosen]]
        angle = np.abs((headings - directions + pi) % (2 * pi) - pi)
        outside = shapely.distance(areas[lane], points[chosen]) / NEAR_M
        costs = angle / _LARGEST_ANGLE + np.where(outside > 0, _BESIDE_COST + outside, 0.0)
        along = angle < _LARGEST_ANGLE
        for index, cost in zip(chosen[along], costs[along].tolist(), strict=True):
            matches[int(rows[index])][int(columns[index])][lanes[lane].id] = cost
    return {row: dict(sorted(by_column.items())) for row, by_column in matches.items()}

"""Which lanelets everybody is on at every moment, as far as the lanelets lead their way."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from math import pi

import numpy as np
import shapely
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Floats, Tracks
from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.route import is_lane

NEAR_M = 3.0
"""Who is on no lane is on one that is so near."""

_BESIDE_COST = 1.0
_AGAINST = pi / 2

MatchedLanelets = Mapping[int, Mapping[str, float]]
"""Column -> lanelet -> how badly it fits: 0 on it and along it, 1 nearly across it or beside it."""


def match_to_map(recording: Recording, people: Tracks) -> dict[int, MatchedLanelets]:
    """For the rows of those who move: where they are, but for columns without a fitting lane."""
    lanes = [one for one in recording.lanelets.values() if is_lane(one)]
    moving = np.array([not one.standing for one in people.participants], dtype=bool)
    rows, columns = np.nonzero(people.there & moving[:, None])
    if not lanes or not len(rows):
        return {}
    points = shapely.points(people.x[rows, columns], people.y[rows, columns])
    areas = [
        shapely.make_valid(shapely.Polygon(np.concatenate((x.right, x.left[::-1])))) for x in lanes
    ]
    who, which = shapely.STRtree(areas).query(points, predicate="dwithin", distance=NEAR_M)
    found: dict[int, dict[int, dict[str, float]]] = defaultdict(lambda: defaultdict(dict))
    for number in np.unique(which):
        some = who[which == number]
        headings = _directions(lanes[number], points[some])
        error = np.abs((people.heading[rows[some], columns[some]] - headings + pi) % (2 * pi) - pi)
        outside = shapely.distance(areas[number], points[some]) / NEAR_M
        cost = error / _AGAINST + np.where(outside > 0, _BESIDE_COST + outside, 0.0)
        for at, one in zip(some[error < _AGAINST], cost[error < _AGAINST].tolist(), strict=True):
            found[int(rows[at])][int(columns[at])][lanes[number].id] = one
    return {row: dict(sorted(moments.items())) for row, moments in found.items()}


def _directions(lanelet: Lanelet, points: NDArray[np.object_]) -> Floats:
    """The lanelet's direction at the piece of its centre line nearest to each place."""
    steps = np.diff(lanelet.centre, axis=0)
    reached = np.concatenate(([0.0], np.cumsum(np.hypot(*steps.T))))
    along = shapely.line_locate_point(shapely.LineString(lanelet.centre), points)
    piece = np.clip(np.searchsorted(reached, along, "right") - 1, 0, len(steps) - 1)
    directions: Floats = np.arctan2(steps[piece, 1], steps[piece, 0])
    return directions

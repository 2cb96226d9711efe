"""What people on foot and on cycles are on: lanes, pedestrian crossings, or neither."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import shapely

from rulec.extraction.tracks.tracks import Flags, Tracks
from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.route import is_lane


def on_lanes(recording: Recording, people: Tracks) -> Flags:
    """Whose middle is on a lane of any direction when? Nobody's but vulnerable road users'."""
    return _on(recording, people, is_lane)


def on_crosswalks(recording: Recording, people: Tracks) -> Flags:
    """The same for pedestrian crossings."""
    return _on(recording, people, lambda one: "crosswalk" in one.types)


def _on(recording: Recording, people: Tracks, wanted: Callable[[Lanelet], bool]) -> Flags:
    found = np.zeros(people.there.shape, dtype=bool)
    rows, columns = np.nonzero(people.there & people.of_kind("vulnerable_user")[:, None])
    areas = [
        shapely.make_valid(shapely.Polygon(np.concatenate((one.right, one.left[::-1]))))
        for one in recording.lanelets.values()
        if wanted(one)
    ]
    if areas and len(rows):
        points = shapely.points(people.x[rows, columns], people.y[rows, columns])
        inside, _ = shapely.STRtree(areas).query(points, predicate="intersects")
        found[rows[inside], columns[inside]] = True
    return found
